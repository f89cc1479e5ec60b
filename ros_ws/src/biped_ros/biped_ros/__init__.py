"""What the nodes share on ROS: node base, parameters, messages as bytes, processes."""
