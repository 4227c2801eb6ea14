"""The square as the check sees it: sides, turns and corners."""

from __future__ import annotations

import math
from typing import cast

import pytest

from labkit.exercises import Fail
from labkit.exercises.clauses import Evidence
from labkit.lessons.turtlebot.drive import Command, Drive
from labkit.lessons.turtlebot.square import exercise as square
from labkit.sim.kinematics import Motion, Pose, Twist2

SIDE, TURN, REST = Twist2(0.2, 0.0), Twist2(0.0, math.pi / 2), Twist2(0.0, 0.0)


def driven(third_side: int = 20, every: float = 0.1, without_last: int = 0) -> Drive:
    """Return a drive round a square.

    Args:
        third_side: How many commands the third side has; 20 are right.
        every: How long a command is obeyed, s.
        without_last: How many commands at its end were not seen.
    """
    poses, commands = [(0.0, Pose(0.0, 0.0, 0.0))], []
    time, pose = 0.0, Pose(0.0, 0.0, 0.0)
    for side in range(4):
        steps = [SIDE] * (third_side if side == 2 else 20) + [TURN] * 10
        for twist in [*steps, REST] if side == 3 else steps:
            commands.append(Command(time, (twist.v, 0.0, 0.0, 0.0, 0.0, twist.w)))
            for _ in range(10):
                pose = Motion(pose, twist).pose_at(every / 10)
                time += every / 10
                poses.append((time, pose))
    commands = commands[: len(commands) - without_last]
    # Its clauses look at the drive alone.
    nothing = cast(Evidence, None)
    return Drive(nothing, poses=poses, commands=commands, cut=without_last > 0)


def judge(drive: Drive) -> None:
    for clause in square.clauses:
        clause.judge(drive)


def test_a_square_passes() -> None:
    judge(driven())


def test_a_side_that_is_too_long_fails() -> None:
    with pytest.raises(Fail, match='corner 4'):
        judge(driven(third_side=27))


@pytest.mark.parametrize('every', [0.115, 0.085])
def test_another_rate_fails_though_its_commands_are_those_of_a_square(every: float) -> None:
    with pytest.raises(Fail, match='10 Hz'):
        judge(driven(every=every))


def test_drive_that_was_cut_is_not_judged_as_if_it_had_ended() -> None:
    with pytest.raises(Fail, match='It does not end'):
        judge(driven(without_last=12))
