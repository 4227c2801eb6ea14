"""The check of the square: a busy computer is no mistake of the learner's."""

from __future__ import annotations

import math

import pytest

from labkit.exercises import Fail
from labkit.lessons.turtlebot.drive import Drive
from labkit.lessons.turtlebot.square import _judge_drive
from labkit.sim.kinematics import Motion, Pose, Twist2

SIDE, TURN, REST = Twist2(0.2, 0.0), Twist2(0.0, math.pi / 2), Twist2(0.0, 0.0)


def driven(third_side: int, held_up: float) -> Drive:
    """Return a drive round a square.

    Args:
        third_side: How many commands the third side has; 20 are right.
        held_up: How much longer than 0.1 s the last of them was obeyed, s.
    """
    found = Drive(poses=[(0.0, Pose(0.0, 0.0, 0.0))])
    time, pose = 0.0, Pose(0.0, 0.0, 0.0)
    for side in range(4):
        steps = [SIDE] * (third_side if side == 2 else 20) + [TURN] * 10
        for number, twist in enumerate([*steps, REST] if side == 3 else steps):
            late = held_up if side == 2 and number == third_side - 1 else 0.0
            found.commands.append((time, twist))
            found.sent.append(time)
            for _ in range(10):
                pose = Motion(pose, twist).pose_at((0.1 + late) / 10)
                time += (0.1 + late) / 10
                found.poses.append((time, pose))
    return found


def test_drive_that_a_busy_computer_has_spoilt_passes():
    _judge_drive(driven(third_side=20, held_up=0.75))


def test_same_drive_fails_where_the_commands_ask_for_it():
    with pytest.raises(Fail, match='corner 4'):
        _judge_drive(driven(third_side=27, held_up=0.05))


def test_drive_far_off_fails_whatever_was_commanded():
    with pytest.raises(Fail):
        _judge_drive(driven(third_side=20, held_up=1.5))
