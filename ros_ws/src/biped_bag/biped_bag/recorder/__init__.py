"""The recorder: every topic of the graph into a bag."""
