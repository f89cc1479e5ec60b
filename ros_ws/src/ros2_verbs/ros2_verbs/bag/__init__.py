"""`ros2 bag`: one module per verb, thin shells over biped_bringup's bags."""
