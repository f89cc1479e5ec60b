"""Templates of what is published to be looked at: markers and the torso's pose."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from visualization_msgs.msg import Marker

from biped_ros.cdr import MessageTemplate
from biped_ros.messages import WORLD_FRAME

_NO_ROTATION = (0.0, 0.0, 0.0, 1.0)  # quaternion x, y, z, w


class MarkerForm(NamedTuple):
    """What does not change about a marker; its name space holds only this one."""

    ns: str
    shape: int
    """A type of visualization_msgs/Marker, such as LINE_STRIP."""
    scale: tuple[float, float, float]
    """[m]; what it means depends on the shape."""
    rgba: tuple[float, float, float, float]
    points: int = 0
    action: int = Marker.ADD


CLEAR = MarkerForm(
    "", 0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0), action=Marker.DELETEALL
)
"""Takes all markers away."""


def marker_array_template(forms: Sequence[MarkerForm]) -> MessageTemplate:
    """Return a MarkerArray in the world frame.

    Its values are, marker by marker, the (3,) position and the (points, 3) points [m].
    """
    template = MessageTemplate(stamped=False).integer(len(forms))
    for form in forms:
        _add_marker(template, form)
    return template.finished()


def torso_pose_template(torso_frame: str) -> MessageTemplate:
    """Return a TransformStamped from the world to the torso: (x, y, z), quaternion."""
    template = MessageTemplate(stamped=True).text(WORLD_FRAME).text(torso_frame)
    for _ in range(3 + 4):
        template.value()
    return template.finished()


def _add_marker(template: MessageTemplate, form: MarkerForm) -> None:
    # In the order of visualization_msgs/Marker.
    template.stamp().text(WORLD_FRAME)
    template.text(form.ns).integer(0).integer(form.shape).integer(form.action)
    template.value().value().value()
    for component in _NO_ROTATION:
        template.constant(component)
    for size in form.scale:
        template.constant(size)
    for share in form.rgba:
        template.single(share)
    template.integer(0).integer(0)  # lifetime: until it is replaced
    template.octet(False)  # frame_locked
    template.integer(form.points)
    for _ in range(form.points):
        template.value().value().value()
    template.integer(0)  # colors
    template.text("")  # texture_resource
    template.integer(0).integer(0).text("").text("").integer(0)  # texture
    template.integer(0)  # uv_coordinates
    template.text("").text("")  # text, mesh_resource
    template.text("").integer(0)  # mesh_file
    template.octet(False)  # mesh_use_embedded_materials
