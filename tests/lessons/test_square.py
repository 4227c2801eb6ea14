"""The square as the check sees it: sides, turns and corners, and what a busy computer spoils."""

from __future__ import annotations

import math

import pytest

from labkit.exercises import Fail
from labkit.lessons.turtlebot.clauses import DriveClause
from labkit.lessons.turtlebot.drive import Command, Drive
from labkit.lessons.turtlebot.square import square
from labkit.sim.kinematics import Motion, Pose, Twist2

SIDE, TURN, REST = Twist2(0.2, 0.0), Twist2(0.0, math.pi / 2), Twist2(0.0, 0.0)

# Usual time between two commands, how much later than told a thread woke up, s, and the verdict.
LATE = [(0.21, 0.11, True), (0.21, 0.0, False), (0.31, 0.11, False), (0.15, 0.11, False)]


def driven(
    third_side: int = 20,
    held_up: float = 0.0,
    *,
    exact: bool = False,
    usual: float = 0.1,
    late_by: float = 0.0,
) -> Drive:
    """Return a drive round a square.

    Args:
        third_side: How many commands the third side has; 20 are right.
        held_up: How much longer than 0.1 s the last of them was obeyed, s.
        exact: Whether time was virtual, so that nothing can be held up.
        usual: How long a command is obeyed, s,
        late_by: and two of three for so much longer.
    """
    found = Drive(poses=[(0.0, Pose(0.0, 0.0, 0.0))], exact=exact, margin=0.25)
    time, pose = 0.0, Pose(0.0, 0.0, 0.0)
    for side in range(4):
        steps = [SIDE] * (third_side if side == 2 else 20) + [TURN] * 10
        for number, twist in enumerate([*steps, REST] if side == 3 else steps):
            late = held_up if side == 2 and number == third_side - 1 else 0.0
            late += usual - 0.1 + (late_by if number % 3 else 0.0)
            found.commands.append(Command(time, (twist.v, 0.0, 0.0, 0.0, 0.0, twist.w)))
            for _ in range(10):
                pose = Motion(pose, twist).pose_at((0.1 + late) / 10)
                time += (0.1 + late) / 10
                found.poses.append((time, pose))
    return found


def judge(found: Drive) -> None:
    for clause in square.clauses:
        assert isinstance(clause, DriveClause)
        clause.look(found)


def test_drive_that_a_busy_computer_has_spoilt_passes() -> None:
    judge(driven(third_side=20, held_up=0.75))


def test_same_drive_fails_where_time_was_exact() -> None:
    with pytest.raises(Fail, match='corner 4'):
        judge(driven(third_side=20, held_up=0.75, exact=True))


def test_same_drive_fails_where_the_commands_ask_for_it() -> None:
    with pytest.raises(Fail, match='corner 4'):
        judge(driven(third_side=27, held_up=0.05))


def test_drive_far_off_fails_whatever_was_commanded() -> None:
    with pytest.raises(Fail):
        judge(driven(third_side=20, held_up=1.5))


def test_commands_that_a_busy_computer_holds_up_all_the_time_count_as_they_were_meant() -> None:
    judge(driven(late_by=0.03))


@pytest.mark.parametrize('usual', [0.115, 0.085])
def test_a_thread_that_sleeps_too_long_fails_though_its_commands_are_those_of_a_square(
    usual: float,
) -> None:
    with pytest.raises(Fail, match=r'corner|ends where it began'):
        judge(driven(usual=usual))


@pytest.mark.parametrize(('usual', 'late', 'is_right'), LATE)
def test_what_the_computer_made_late_is_taken_off_the_time_between_commands(
    usual: float, late: float, is_right: bool
) -> None:
    found = driven(usual=usual)
    found.slowness, found.late = 1 + late / 0.1, late
    if is_right:
        judge(found)
        return
    with pytest.raises(Fail, match=f'every {usual:g} s'):
        judge(found)


def test_drive_that_was_cut_is_not_judged_as_if_it_had_ended() -> None:
    found = driven(third_side=20, held_up=0.0, exact=True)
    found.margin = 1e-6
    del found.commands[-12:]
    found.cut = True
    with pytest.raises(Fail, match='It does not end'):
        judge(found)
