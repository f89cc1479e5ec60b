"""`ros2 param`: one module per verb."""
