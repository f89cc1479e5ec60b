"""`ros2 node`: one module per verb."""
