"""`ros2 service`: one module per verb."""
