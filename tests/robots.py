"""Two robots: what holds for the shipped one must hold for another one, too."""

from pathlib import Path

from biped_bringup.run_settings import RunSettings, load_settings
from biped_description.robot import Robot

EXAMPLES = Path(__file__).parents[1] / "examples"

SHIPPED_RUN: RunSettings = load_settings("paper")
SHIPPED = Robot(SHIPPED_RUN.robot)
TALL_RUN: RunSettings = load_settings("paper", EXAMPLES / "tall_robot.yaml")
TALL = Robot(TALL_RUN.robot)
