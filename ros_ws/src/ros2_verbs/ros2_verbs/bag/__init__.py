"""Various rosbag related commands."""
