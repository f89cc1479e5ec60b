"""`ros2`: the verbs that users of ROS 2 know by heart, on rclpy's graph.

No wheels of ros2cli exist. These verbs take the options of Jazzy's and print what
they print; where a real `ros2` is installed it is started instead (`real_ros2`).

Commands are entry points of the group `ros2.commands`, the verbs of one of them those
of `ros2.<command>_verbs`, such as `ros2.topic_verbs`; any package may add to both. The
object is a module. The first line of its docstring is the help; it has two functions,
`add_arguments(parser)` and `main(args) -> int`, the exit status. A command with verbs
is the package of the folder where they stand, and needs neither; with them, it can be
called without a verb, too, as `ros2 doctor`. A verb is
imported only when it was chosen, a command also for the help of `ros2` alone: what it
takes long to import, it imports in `main`.

What several commands need stands in `graph` and `messages`. A verb meets the graph
through `graph.node`. It ends with an error by raising `VerbError`; Ctrl-C and a reader
that has gone away are taken care of by `main`.
"""
