"""Two robots, each as two independent libraries see it."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pinocchio as pin
import pybullet
import pytest
from tests.robots import SHIPPED, TALL

from biped_description.robot import Robot


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


@pytest.fixture(scope="session", params=[SHIPPED, TALL], ids=["shipped", "tall"])
def robot(request: pytest.FixtureRequest) -> Robot:
    return request.param


@pytest.fixture(scope="session")
def urdf_file(robot: Robot, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("urdf") / "biped.urdf"
    file.write_text(robot.urdf, encoding="utf-8")
    return file


@pytest.fixture(scope="session")
def bullet_robot(urdf_file: Path) -> Iterator[BulletRobot]:
    client = pybullet.connect(pybullet.DIRECT)
    flags = pybullet.URDF_USE_INERTIA_FROM_FILE
    body = pybullet.loadURDF(str(urdf_file), flags=flags, physicsClientId=client)
    yield BulletRobot(client, body)
    pybullet.disconnect(client)


@pytest.fixture(scope="session")
def pin_model(robot: Robot) -> pin.Model:
    return pin.buildModelFromXML(robot.urdf, pin.JointModelFreeFlyer())
