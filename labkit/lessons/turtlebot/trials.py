"""How a check drives: it puts the robot somewhere, gives the sign to start, and looks on.

The robot and the node under test step together, in virtual time: see `labkit.exercises.life`. So a
drive takes a fraction of its time, and is the same on a busy machine. A node that keeps a time of
its own, such as a thread with `time.sleep()`, is noticed and drives in real time.
"""

from __future__ import annotations

import contextlib
import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from labkit.exercises import Fail, Probe, expect
from labkit.exercises.clauses import Evidence
from labkit.exercises.life import Life, Stimulus, live
from labkit.lessons.turtlebot.drive import (
    ODOMETRY,
    SCAN,
    TWIST,
    Command,
    Drive,
    EndOfDrive,
    Trial,
)
from labkit.lessons.turtlebot.real_time import (
    BEGIN_SEC,
    FEW_SEC,
    LONGER_SEC,
    POLL_SEC,
    RealTime,
    refuse_flood,
)
from labkit.lessons.turtlebot.robot import OtherDrivers, place, short_sighted, walls_near

if TYPE_CHECKING:
    from labkit.exercises.virtual_time import VirtualTime
    from labkit.exercises.watch import Lived, Watch
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['Trials']

# The sign is given when time has passed for so long, s; no timer of a node ticks just then.
SIGN_SEC = 0.25
# How long nothing may be commanded before the first sign, s of virtual time.
QUIET_SEC = 2.0
# How often nodes of other processes are told the time, s: at first so often that their rate is
# known, and then once a command, to be quicker.
TICK_SEC, FINE_SEC, LATER_TICK_SEC = 0.05, 3.5, 0.1
# Commands of nodes whose time is not exact are known to so much, s.
REMOTE_MARGIN_SEC = 0.11
# After so much time no further drive is begun in real time, s.
ENOUGH_SEC = 6.0
# How long it is looked whether commands come while time stands still, s of real time.
STILL_SEC = 0.6


@dataclass
class Trials:
    """The drives of one check.

    Attributes:
        probe: The probe of the check.
        robot: The robot.
        source: The publisher of the node under test.
        sign: The topic on which it hears the sign to start, and the type there.
        seconds: How long a drive may take, s.
        real: Whether the node keeps a time of its own.
    """

    probe: Probe
    robot: Any
    source: Endpoint
    sign: tuple[str, str]
    seconds: float
    real: bool = False

    def __post_init__(self) -> None:
        self._others = OtherDrivers(self.probe, self.source)
        self._real_time = RealTime(
            self.probe, self.robot, self.source, self.sign, self.seconds, self._others
        )
        self._began = 0.0
        self._name = self.robot.get_fully_qualified_name()
        self._topics = {'/cmd_vel': TWIST, '/odom': ODOMETRY, self.sign[0]: self.sign[1]}

    def run(
        self, trials: Sequence[Trial], judge: Callable[[Drive], None], drives: list[Drive]
    ) -> None:
        """Make the drives, one after the other, and judge each of them.

        Args:
            trials: What is to be driven.
            judge: Raises Fail if a drive is not what the task asks for.
            drives: Gets the drives.

        Raises:
            Fail: One is not, or another node drives.
            LearnerError: A callback has raised.
        """
        self._began = time.monotonic()
        for trial in trials:
            if self.real and time.monotonic() - self._began > ENOUGH_SEC:
                return
            with short_sighted(self.robot) if trial.short_sighted else contextlib.nullcontext():
                self._make(trial, judge, drives)

    def _make(self, trial: Trial, judge: Callable[[Drive], None], drives: list[Drive]) -> None:
        if not self.real:
            found = self._in_virtual_time(trial)
            try:
                if not self.real:
                    self._note(found, drives)
                    judge(found)
                    return
            except Fail:
                began = time.monotonic()
                again = self._again_in_real_time(trial, found)
                if again is None:
                    raise
                drives.pop()
                self.real, self._began = True, began
                self._note(again, drives)
                judge(again)
                return
        real = self._drive_in_real_time(trial)
        self._note(real, drives)
        judge(real)

    def _note(self, found: Drive, drives: list[Drive]) -> None:
        found.number = len(drives)
        if not found.commands:
            # Of another process this is not asked before: an answer that is lost proves nothing.
            expect.spun(self.probe, self.source)
        if found.poses:
            found.walls = walls_near(self.robot, found.end)
        drives.append(found)

    # -- virtual time ---------------------------------------------------------------------------

    def wait_until_quiet(self) -> None:
        """Let time pass until nothing is commanded: an earlier drive may not be over.

        Raises:
            Fail: It goes on and on.
        """
        seen, last = 0, 0.0

        def quiet(now: float, watches: Mapping[str, Watch]) -> bool:
            nonlocal seen, last
            if len(watches['/cmd_vel']) > seen:
                seen, last = len(watches['/cmd_vel']), now
            return now > last + QUIET_SEC

        self._others.look()
        with self._others.counted():
            limit = self.seconds + LONGER_SEC + QUIET_SEC
            life = self._live(limit, (), until=quiet)
        commands = life.on('/cmd_vel')
        if life.seconds >= limit:
            found = Drive()
            found.take((), commands)
            still = ', all of them stop commands' if not found.moving else ''
            raise Fail(
                'a robot that nobody drives, before the sign to start is given',
                f'{len(commands)} commands on /cmd_vel in {life.seconds:.0f} s{still}',
                why=f'{self.source.node} publishes without being asked to, and does not end.',
                todo=f'Begin when a message comes on {self.sign[0]}, and return in the timer as '
                'long as there is nothing to do.',
            )

    def _in_virtual_time(self, trial: Trial) -> Drive:
        stimulus = Stimulus(SIGN_SEC, *self.sign, trial.fields, ('/cmd_vel',))
        with self._others.counted():
            life = self._live(
                SIGN_SEC + self.seconds + LONGER_SEC,
                (stimulus,),
                until=EndOfDrive(SIGN_SEC),
                start=trial.start,
            )
        found = Drive(sign=SIGN_SEC, goals=trial.goals, from_start=trial.from_start)
        if life.remote:
            found.margin = REMOTE_MARGIN_SEC
        found.take(life.on('/odom'), life.on('/cmd_vel'), life.on('/scan'))
        found.cut = life.seconds >= SIGN_SEC + self.seconds + LONGER_SEC
        return found

    def _live(
        self,
        seconds: float,
        stimuli: Sequence[Stimulus],
        *,
        until: Callable[[float, Mapping[str, Watch]], bool],
        start: tuple[float, float, float] | None = None,
    ) -> Life:
        """Let time pass for the robot and the node under test.

        Raises:
            Fail: Another node drives, a callback does not return, or there is no end of them.
            LearnerError: A callback has raised.
        """

        def begin(passing: VirtualTime) -> None:
            if start is not None:
                place(self.robot, start)
            passing.restart_timers()

        life = live(
            self.probe,
            self._topics,
            seconds,
            stimuli=stimuli,
            also={'/scan': SCAN},
            nodes={self._name, self.source.node},
            tick=TICK_SEC,
            fine_sec=FINE_SEC,
            rest=LATER_TICK_SEC,
            hurry=False,
            before=begin,
            until=until,
        )
        self._others.refuse(life.on('/cmd_vel'))
        refuse_flood(len(life.on('/cmd_vel')), life.seconds)
        evidence = Evidence(self.probe)
        evidence.life = life
        evidence.refuse_trouble(())
        if not self.probe.in_this_process(self.source) and not life.remote:
            self.real = True
        return life

    # -- a time of its own ----------------------------------------------------------------------

    def _again_in_real_time(self, trial: Trial, found: Drive) -> Drive | None:
        """Drive once more, in real time, if the node does not follow the time of ROS.

        Args:
            trial: What is to be driven.
            found: What it drove in virtual time, which is not right.

        Returns:
            The drive; None if the node follows.
        """
        if found.is_even or not found.commands:
            return None
        few = sum(command.at < found.commands[0].at + FEW_SEC for command in found.commands)
        with self._others.counted():
            again = self._real_time.drive(trial, unless=few)
        if again is None and self._looks_at_another_clock(trial, found):
            again = self._drive_in_real_time(trial)
        return again

    def _drive_in_real_time(self, trial: Trial) -> Drive:
        with self._others.counted():
            found = self._real_time.drive(trial)
        assert found is not None
        return found

    def _looks_at_another_clock(self, trial: Trial, found: Drive) -> bool:
        """Tell whether it matters to the node that the time of ROS stands still for a while.

        It does if commands come meanwhile, or if they come at other times after it. A node that
        follows the time of ROS notices nothing, and commands as it did before.
        """
        began, count = math.inf, 0

        def stand_still(now: float, watches: Mapping[str, Watch]) -> bool:
            nonlocal began, count
            commands = watches['/cmd_vel']
            if now >= SIGN_SEC and len(commands) and began == math.inf:
                began, before = now, len(commands)
                end = time.monotonic() + STILL_SEC
                while count < 2 and time.monotonic() < end:
                    time.sleep(POLL_SEC)
                    commands.pump()
                    count = len(commands) - before
            return count > 1 or now > min(began, SIGN_SEC + BEGIN_SEC) + FEW_SEC

        stimulus = Stimulus(SIGN_SEC, *self.sign, trial.fields)
        limit = SIGN_SEC + BEGIN_SEC + FEW_SEC
        with self._others.counted():
            life = self._live(limit, (stimulus,), until=stand_still, start=trial.start)
        if count > 1 or began == math.inf:
            return count > 1
        return not life.remote and _few_times(life.on('/cmd_vel')) != _few_times(found.commands)


def _few_times(commands: Sequence[Lived] | Sequence[Command]) -> list[int]:
    """Return when the first few commands came, ms from the first one on."""
    times = [round((each.at - commands[0].at) * 1e3) for each in commands]
    return [ms for ms in times if ms < FEW_SEC * 1e3]
