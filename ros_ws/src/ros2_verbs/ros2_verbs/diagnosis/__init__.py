"""What `ros2 doctor` looks at: the host, the installation, and the graph."""
