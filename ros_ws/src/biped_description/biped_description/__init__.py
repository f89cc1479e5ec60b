"""The biped: its dimensions, joints, links, kinematics and URDF.

World frame: x forward, y left, z up, origin on the floor midway between the feet at
the start. The *waist* is the midpoint of the line through the hip joints. A *foot* is
the point of the sole's plane under the ankle, so that its height is zero on the floor.

Import from the modules, each of which holds one concept::

    dimensions   lengths and masses of the robot, the constant ``BIPED``
    joints       names, position limits and torque limits of the twelve joints
    links        names, masses, mass centres and inertias of the thirteen links
    kinematics   inverse kinematics, forward kinematics, centre of mass
    urdf         the URDF file, generated from the tables above
    errors       what the functions raise
"""
