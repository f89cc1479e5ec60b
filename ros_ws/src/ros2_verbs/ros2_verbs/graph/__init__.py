"""The ROS graph, as the verbs meet it: a node of one's own, names, and QoS."""
