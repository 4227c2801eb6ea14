"""What is shown of the drives that a check has watched."""

from __future__ import annotations

import math
from typing import cast

from labkit.exercises.clauses import Evidence
from labkit.lessons.turtlebot.drawing import FRAME, _scene, _words
from labkit.lessons.turtlebot.drive import Drive
from labkit.sim.kinematics import Pose
from labkit.views.arena_picture import to_svg

SCRIPT = """
from labkit.lessons.turtlebot.drawing import observed
from labkit.lessons.turtlebot.drive import Drive
from labkit.sim.kinematics import Pose

with observed() as drives:
    drives += [Drive(None, poses=[(0.0, Pose(0.0, 0.0, 0.0)), (2.0, Pose(0.4, 0.0, 0.0))])]
"""


def test_a_script_gets_the_drive_in_words(script):
    told = (
        'Drive from x = 0.00 m, y = 0.00 m to x = 0.40 m, y = 0.00 m: 0.40 m in 2.0 s, 0 commands.'
    )
    assert script(SCRIPT).stdout == f'{told}\n'


def test_picture_has_the_coordinates_of_the_verdict():
    # One way, told as the odometry has it, and as the robot saw it from its start.
    poses = [(0.0, Pose(1.0, 0.5, math.pi / 2)), (2.0, Pose(1.0, 0.9, math.pi))]
    walls = [(1.0, 1.5), None]
    nothing = cast(Evidence, None)
    plain = Drive(nothing, poses=poses, walls=walls, goals=[(1.0, 0.9)])
    seen = Drive(nothing, poses=poses, walls=walls, goals=[(0.4, 0.0)], from_start=True)
    scene = _scene(plain)
    assert (scene.pose, scene.trail, scene.scan) == (poses[1][1], [(1.0, 0.5), (1.0, 0.9)], walls)
    assert FRAME not in to_svg(scene)
    scene = _scene(seen)
    numbers = [*scene.pose, *scene.trail[0], *scene.trail[1], *scene.scan[0]]
    wanted = [0.4, 0.0, math.pi / 2, 0.0, 0.0, 0.4, 0.0, 1.0, 0.0]
    assert all(abs(a - b) < 1e-9 for a, b in zip(numbers, wanted, strict=True))
    # Where the robot should come by is where it came: the same frame for both.
    assert math.dist(scene.goals[0], scene.trail[-1]) < 1e-9 and scene.scan[1] is None
    assert f'>{FRAME}<' in to_svg(scene)
    assert _words(seen).startswith(
        'Drive, seen from the start: from x = 0.00 m, y = 0.00 m to x = 0.40 m, y = 0.00 m: '
    )
