"""Reads the points of markers without building Python objects.

Messages of one length are alike but for their numbers. The first is read by rclpy, in
about a millisecond; a template made of its forms reads the others.
"""

from __future__ import annotations

from typing import Final

from rclpy.serialization import deserialize_message
from visualization_msgs.msg import Marker, MarkerArray

from biped_ros.cdr import MessageTemplate
from biped_ros.markers import MarkerForm, marker_array_template
from biped_view.live.moment import Array

_MOST_LENGTHS: Final = 16  # a stranger may send any
_LIMIT: Final = "zmp_limit"


class MarkerReader:
    """Reads what the robot's node draws; of anything else, nothing."""

    def __init__(self) -> None:
        """Know no message yet."""
        self._known: dict[int, tuple[MessageTemplate, list[MarkerForm]]] = {}
        self.limit_m: float | None = None
        """Radius of the ZMP's limit in the last message."""

    def read(self, message: bytes) -> dict[str, Array]:
        """Return the points (n, 3) of every marker, by name.

        Of a marker without points it is its place; of a message that is not the
        robot's, nothing.
        """
        known = self._known.get(len(message)) or self._learn(message)
        values = None if known is None else known[0].read(message)
        if known is None or values is None:
            self._known.pop(len(message), None)
            return {}
        rows, drawn, first = values[0].reshape(-1, 3), {}, 0
        for form in known[1]:
            points = rows[first + 1 : first + 1 + form.points]
            if form.action == Marker.ADD:
                drawn[form.ns] = points if form.points else rows[first : first + 1]
            if form.ns == _LIMIT:
                self.limit_m = form.scale[0] / 2.0
            first += 1 + form.points
        return drawn

    def _learn(self, message: bytes) -> tuple[MessageTemplate, list[MarkerForm]] | None:
        try:
            markers = deserialize_message(message, MarkerArray).markers
        except Exception:  # rclpy raises what the bytes make it raise
            return None
        forms = [
            MarkerForm(
                marker.ns,
                marker.type,
                (marker.scale.x, marker.scale.y, marker.scale.z),
                (marker.color.r, marker.color.g, marker.color.b, marker.color.a),
                len(marker.points),
                marker.action,
            )
            for marker in markers
        ]
        if len(self._known) >= _MOST_LENGTHS:
            self._known.clear()
        self._known[len(message)] = marker_array_template(forms), forms
        return self._known[len(message)]
