"""Bags on the disk: rosbag2's folders of MCAP files, written and read."""
