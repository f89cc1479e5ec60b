"""Bags: recordings of the graph as MCAP files in the layout of rosbag2."""
