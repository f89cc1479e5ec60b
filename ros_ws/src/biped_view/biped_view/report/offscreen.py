"""The robot rendered without a screen, by the renderer that comes with PyBullet."""

from __future__ import annotations

from tempfile import NamedTemporaryFile
from types import TracebackType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from biped_description.joints import JOINT_NAMES
from biped_description.robot import Robot
from sim_node.quiet import engine_chatter_dropped

with engine_chatter_dropped():
    import pybullet

_NEAR_M, _FAR_M = 0.1, 20.0
_LIGHT_FROM = (1.0, -1.5, 2.5)


class Camera(NamedTuple):
    """Where a picture is taken from, world frame."""

    eye_m: tuple[float, float, float]
    target_m: tuple[float, float, float]
    height_angle_deg: float
    """Of what is seen, from top to bottom."""
    size_px: tuple[int, int]
    """Width and height."""

    def project(self, points_m: ArrayLike) -> NDArray[np.float64]:
        """Return where points are seen, (n, 2) pixels from the upper left corner.

        Args:
            points_m: (n, 3) in front of the camera.
        """
        points = np.asarray(points_m, dtype=np.float64).reshape(-1, 3)
        view, projection = (np.reshape(matrix, (4, 4)).T for matrix in self.matrices())
        seen = np.column_stack((points, np.ones(len(points)))) @ (projection @ view).T
        width, height = self.size_px
        x, y = (seen[:, :2] / seen[:, 3:]).T
        return np.column_stack(((1 + x) / 2 * width, (1 - y) / 2 * height))

    def matrices(self) -> tuple[Any, Any]:
        """Return view and projection, 16 numbers each, column by column."""
        width, height = self.size_px
        return (
            pybullet.computeViewMatrix(self.eye_m, self.target_m, (0.0, 0.0, 1.0)),
            pybullet.computeProjectionMatrixFOV(
                self.height_angle_deg, width / height, _NEAR_M, _FAR_M
            ),
        )


class OffscreenRobot:
    """A robot that is looked at, in a world of its own without physics."""

    def __init__(self, robot: Robot, camera: Camera) -> None:
        """Load the robot's URDF."""
        self._camera = camera
        self._com_m = robot.links[0].com
        self._client = pybullet.connect(pybullet.DIRECT)
        with NamedTemporaryFile(mode="w", suffix=".urdf", encoding="utf-8") as file:
            file.write(robot.urdf)
            file.flush()
            self._body = pybullet.loadURDF(
                file.name, useFixedBase=True, physicsClientId=self._client
            )
        numbers = {
            pybullet.getJointInfo(self._body, j, physicsClientId=self._client)[
                1
            ].decode(): j
            for j in range(len(JOINT_NAMES))
        }
        self._joints = [numbers[name] for name in JOINT_NAMES]

    def picture(
        self,
        torso_position_m: ArrayLike,
        torso_quaternion_wxyz: ArrayLike,
        joint_position_rad: ArrayLike,
    ) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
        """Return (height, width, 3) pixels, and which of them show the robot.

        Args:
            torso_position_m: (3,) origin of the torso link in the world frame.
            torso_quaternion_wxyz: (4,) its orientation.
            joint_position_rad: (12,) in the order of `JOINT_NAMES`.
        """
        w, x, y, z = np.asarray(torso_quaternion_wxyz, dtype=np.float64).tolist()
        # Bullet places a body by its CoM.
        at, turned = pybullet.multiplyTransforms(
            np.asarray(torso_position_m, dtype=np.float64).tolist(),
            (x, y, z, w),
            self._com_m,
            (0.0, 0.0, 0.0, 1.0),
        )
        pybullet.resetBasePositionAndOrientation(
            self._body, at, turned, physicsClientId=self._client
        )
        angles = np.asarray(joint_position_rad, dtype=np.float64).tolist()
        for joint, angle in zip(self._joints, angles, strict=True):
            pybullet.resetJointState(
                self._body, joint, angle, physicsClientId=self._client
            )
        width, height = self._camera.size_px
        view, projection = self._camera.matrices()
        _, _, rgba, _, bodies = pybullet.getCameraImage(
            width,
            height,
            view,
            projection,
            lightDirection=_LIGHT_FROM,
            shadow=0,
            renderer=pybullet.ER_TINY_RENDERER,
            physicsClientId=self._client,
        )
        pixels = np.reshape(rgba, (height, width, 4))[:, :, :3].astype(np.uint8)
        return pixels, np.reshape(bodies, (height, width)) == self._body

    def __enter__(self) -> OffscreenRobot:
        """Return the robot."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End its world."""
        pybullet.disconnect(self._client)
