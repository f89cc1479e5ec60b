"""`ros2`: the verbs that users of ROS 2 know by heart, on rclpy's graph.

No wheels of ros2cli exist. These verbs take the options of Jazzy's and print what
they print; where a real `ros2` is installed it is started instead (`real_ros2`).

How to add a verb: put a module into the folder of its command, `topic/hz.py` for
`ros2 topic hz`. The first line of its docstring is its help; it has two functions,
`add_arguments(parser)` and `main(args) -> int`, the exit status. It is imported only
when it was chosen. Whatever helps several verbs stands in this folder, not among them.

How to add a command: name it in `main.COMMANDS`. It is a folder of verbs, or, without
verbs, a module with these two functions.

A verb meets the graph through `graph_node`. It ends with an error by raising
`VerbError`; Ctrl-C and a reader that has gone away are taken care of by `main`.
"""
