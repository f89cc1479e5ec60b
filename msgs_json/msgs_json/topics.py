"""Names, types and quality of service of everything on the graph, in one place."""

from __future__ import annotations

from dataclasses import dataclass

# The nodes know each other by name: a walk begins when all three are connected.
SIM_NODE = "sim_node"
TRAJECTORY_NODE = "trajectory_node"
LEARNER_NODE = "learner_node"
RECORDER_NODE = "recorder_node"


@dataclass(frozen=True)
class Topic:
    """One topic of the graph."""

    name: str
    type_name: str
    """As ROS writes it, package/msg/Type."""
    depth: int = 1000
    """History kept for slow subscribers; 1,000 lose nothing at 500 Hz for 2 s."""
    latched: bool = False
    """Transient local: who comes later gets the last message."""
    owner: str | None = None
    """The one node that may publish it, where walks or learning follow from it."""
    meaning: str = ""
    """What it carries, with units and frame."""


CLOCK = Topic(
    "/clock",
    "rosgraph_msgs/msg/Clock",
    meaning="simulated time, one control tick apart",
)
JOINT_STATES = Topic(
    "/joint_states",
    "sensor_msgs/msg/JointState",
    meaning="12 joints: position [rad], velocity [rad/s], effort [N m]",
)
JOINT_REFERENCES = Topic(
    "/biped/joint_references",
    "sensor_msgs/msg/JointState",
    meaning="12 joints: position asked for [rad]",
)
ZMP = Topic(
    "/biped/zmp",
    "geometry_msgs/msg/PointStamped",
    meaning="measured ZMP, world frame [m]",
)
ZMP_REFERENCE = Topic(
    "/biped/zmp_reference",
    "geometry_msgs/msg/PointStamped",
    meaning="planned ZMP, world frame [m]",
)
PHASE = Topic("/biped/phase", "std_msgs/msg/String", meaning="StampedPhase, JSON")
OBSERVATION = Topic(
    "/biped/observation",
    "std_msgs/msg/String",
    depth=100,
    owner=SIM_NODE,
    meaning="Observation, JSON",
)
CORRECTION = Topic(
    "/biped/correction",
    "geometry_msgs/msg/Vector3Stamped",
    depth=100,
    owner=LEARNER_NODE,
    meaning="waist correction (dx, dy), world frame [m], stamped as the observation "
    "it answers",
)
WAIST_REFERENCE = Topic(
    "/biped/waist_reference",
    "trajectory_msgs/msg/MultiDOFJointTrajectory",
    depth=100,
    owner=TRAJECTORY_NODE,
    meaning="waist, feet and reference ZMP per control tick, world frame [m], stamped "
    "as the observation from which on they hold",
)
PLAN = Topic(
    "/biped/plan",
    "std_msgs/msg/String",
    depth=1,
    latched=True,
    owner=TRAJECTORY_NODE,
    meaning="WalkPlan, JSON",
)
EPISODE = Topic(
    "/biped/episode",
    "std_msgs/msg/String",
    depth=100,
    owner=LEARNER_NODE,
    meaning="EpisodeResult, JSON",
)
LEARNER_STATUS = Topic(
    "/biped/learner",
    "std_msgs/msg/String",
    depth=1,
    latched=True,
    owner=LEARNER_NODE,
    meaning="LearnerStatus, JSON",
)
MARKERS = Topic(
    "/biped/markers",
    "visualization_msgs/msg/MarkerArray",
    depth=100,
    meaning="support polygon, ZMPs, limit, waist paths: to look at, world frame [m]",
)
TORSO_POSE = Topic(
    "/biped/torso_pose",
    "geometry_msgs/msg/TransformStamped",
    depth=100,
    meaning="where the torso is in the world frame [m]: places the robot in a view",
)
ROBOT_DESCRIPTION = Topic(
    "/robot_description",
    "std_msgs/msg/String",
    depth=1,
    latched=True,
    meaning="URDF",
)
DIAGNOSTICS = Topic(
    "/diagnostics",
    "diagnostic_msgs/msg/DiagnosticArray",
    depth=10,
    meaning="rates, lateness, deadlines missed, messages dropped and refused",
)
# A real robot's motors and sensors, as ros2_control's broadcasters and controllers name
# theirs. Joint states with `use_local_topics`, since /joint_states is the walk's.
HARDWARE_JOINTS = Topic(
    "/joint_state_broadcaster/joint_states",
    "sensor_msgs/msg/JointState",
    meaning="12 joints: position [rad], velocity [rad/s], effort [N m]",
)
HARDWARE_IMU = Topic(
    "/imu_sensor_broadcaster/imu",
    "sensor_msgs/msg/Imu",
    meaning="torso: orientation, specific force [m/s^2]",
)
HARDWARE_SOLES = tuple(
    Topic(
        f"/{side}_foot_force_torque_broadcaster/wrench",
        "geometry_msgs/msg/WrenchStamped",
        meaning=f"floor on the {side} sole at the point under the ankle [N], [N m]",
    )
    for side in ("left", "right")
)
HARDWARE_COMMANDS = Topic(
    "/joint_trajectory_controller/joint_trajectory",
    "trajectory_msgs/msg/JointTrajectory",
    meaning="12 joint positions [rad] at the coming control ticks, look-ahead included",
)
EMERGENCY_STOP = Topic(
    "/emergency_stop",
    "std_msgs/msg/Bool",
    meaning="true: the robot must not be driven",
)

CONTROL = (
    OBSERVATION,
    CORRECTION,
    WAIST_REFERENCE,
    PLAN,
    EPISODE,
    LEARNER_STATUS,
)
"""What walks and learning follow from; each has an owner."""
