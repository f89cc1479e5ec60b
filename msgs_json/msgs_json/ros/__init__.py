"""What the nodes share on ROS; the only part of this package that imports rclpy."""
