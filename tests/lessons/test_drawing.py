"""What is shown of the drives that a check has watched."""

from __future__ import annotations

SCRIPT = """
from labkit.lessons.turtlebot.drawing import observed
from labkit.lessons.turtlebot.drive import Drive
from labkit.sim.kinematics import Pose

with observed() as drives:
    drives += [Drive(poses=[(0.0, Pose(0.0, 0.0, 0.0)), (2.0, Pose(0.4, 0.0, 0.0))])]
"""


def test_a_script_gets_the_drive_in_words(script):
    told = (
        'Drive from x = 0.00 m, y = 0.00 m to x = 0.40 m, y = 0.00 m: 0.40 m in 2.0 s, 0 commands.'
    )
    assert script(SCRIPT).stdout == f'{told}\n'
