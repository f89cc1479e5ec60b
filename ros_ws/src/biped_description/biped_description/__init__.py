"""The biped: its table of dimensions, and the kinematics and URDF that follow from it.

World frame: x forward, y left, z up, origin on the floor midway between the feet at
the start. The *waist* is the midpoint of the line through the hip joints. A *foot* is
the point of the sole's plane under the ankle, so that its height is zero on the floor.

The kinematic structure is fixed: a torso on two legs of six joints. All else is a
table, ``settings.RobotSettings``; the ``robot.Robot`` made of it is passed to whoever
needs it. Import from the modules, each of which holds one concept::

    settings     the table of a robot: dimensions, masses, limits
    robot        the robot that a table makes: limits, masses, kinematics, URDF
    joints       names, order and axes of the twelve joints
    links        names of the thirteen links; their mass properties by the table
    urdf         the URDF by the table
    errors       what the functions raise
"""
