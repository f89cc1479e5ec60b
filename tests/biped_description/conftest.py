"""The robot as two independent libraries see it."""

from collections.abc import Iterator
from dataclasses import dataclass

import pinocchio as pin
import pybullet
import pytest

from biped_description.urdf import urdf_path


@dataclass
class BulletRobot:
    """The URDF in a PyBullet world without gravity, at zero joint positions."""

    client: int
    body: int

    @property
    def joints(self) -> range:
        return range(pybullet.getNumJoints(self.body, physicsClientId=self.client))

    def joint_info(self, joint: int) -> tuple:
        return pybullet.getJointInfo(self.body, joint, physicsClientId=self.client)

    def mass(self, link: int) -> float:
        return pybullet.getDynamicsInfo(self.body, link, physicsClientId=self.client)[0]

    def collision_shapes(self, link: int) -> tuple:
        return pybullet.getCollisionShapeData(
            self.body, link, physicsClientId=self.client
        )


@pytest.fixture(scope="session")
def bullet_robot() -> Iterator[BulletRobot]:
    client = pybullet.connect(pybullet.DIRECT)
    flags = pybullet.URDF_USE_INERTIA_FROM_FILE
    body = pybullet.loadURDF(str(urdf_path()), flags=flags, physicsClientId=client)
    yield BulletRobot(client, body)
    pybullet.disconnect(client)


@pytest.fixture(scope="session")
def pin_model() -> pin.Model:
    return pin.buildModelFromUrdf(str(urdf_path()), pin.JointModelFreeFlyer())
