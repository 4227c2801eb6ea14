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
from typing import TYPE_CHECKING, Any, NoReturn

from labkit.exercises import Fail, Probe, expect
from labkit.exercises.clauses import Evidence
from labkit.exercises.life import Life, Stimulus, live
from labkit.exercises.naps import Naps
from labkit.lessons.turtlebot.drive import (
    ODOMETRY,
    SCAN,
    TWIST,
    Command,
    Drive,
    EndOfDrive,
    Trial,
)
from labkit.lessons.turtlebot.robot import OtherDrivers, place, short_sighted, walls_near

if TYPE_CHECKING:
    from labkit.exercises.virtual_time import VirtualTime
    from labkit.exercises.watch import Sample, Watch
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
REAL_MARGIN_SEC = 0.25
# In real time: how long nothing may be commanded before a drive, and after it, s. A square may
# have pauses of 1 s, which last longer on a busy machine.
REAL_QUIET_SEC = 0.4
REAL_TAIL_SEC = 1.6
# How long a drive may take longer than the task allows, until it is cut, s.
LONGER_SEC = 1.0
# After so much time no further drive is begun in real time, s.
ENOUGH_SEC = 6.0
# How long it is looked whether commands come while time stands still, s of real time.
STILL_SEC = 0.6
# A node that keeps its own time sends more commands within so long a time, s, in real time than in
# virtual time; more by this share at least.
FEW_SEC, SAME = 0.8, 0.3
# In real time the first command comes within this time, s.
BEGIN_SEC = 1.0
# More commands a second than this are a loop without a pause.
FLOOD_HZ = 200.0
POLL_SEC = 0.005


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
        self._refuse_flood(len(life.on('/cmd_vel')), life.seconds)
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
            again = self._in_real_time(trial, unless=few)
        if again is None and self._looks_at_another_clock(trial, found):
            again = self._drive_in_real_time(trial)
        return again

    def _drive_in_real_time(self, trial: Trial) -> Drive:
        with self._others.counted():
            found = self._in_real_time(trial)
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
                began, before = commands.samples[0].at, len(commands)
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

    # -- real time ------------------------------------------------------------------------------

    def _in_real_time(self, trial: Trial, *, unless: int | None = None) -> Drive | None:
        """Let the robot and the node run, as they do without a check.

        Args:
            trial: What is to be driven.
            unless: If not many more commands than these come within `FEW_SEC`, give it up: the
                node is no quicker in real time than in virtual time.

        Returns:
            What was seen; None if it was given up.
        """
        from labkit.background.patience import answer_sec

        probe, topics = self.probe, {**self._topics, '/scan': SCAN}
        watches = {topic: probe.watch(topic, msg_type) for topic, msg_type in topics.items()}
        try:
            self._expect_quiet(watches['/cmd_vel'])
            send = probe.sender(*self.sign)
            place(self.robot, trial.start)
            placed = time.time()
            for watch in watches.values():
                watch.pump()
                watch.clear()
            # When the second one of the new place is here, the node has had the first one.
            odometry = watches['/odom']
            probe.wait(
                lambda: len(odometry) > 1 and odometry.samples[-2].at > placed, answer_sec(1.0)
            )
            found = Drive(goals=trial.goals, from_start=trial.from_start, exact=False)
            found.margin = REAL_MARGIN_SEC
            with Naps() as naps:
                found.sign = send(trial.fields)
                if not self._looked_on(found.sign, watches, naps, unless):
                    return None
            found.slowness = naps.slowness
            found.late = naps.late if probe.in_this_process(self.source) else 0.0
            found.cut = naps.seconds >= self.seconds + LONGER_SEC
            found.take(*(watches[topic].samples for topic in ('/odom', '/cmd_vel', '/scan')))
            return found
        finally:
            for watch in watches.values():
                watch.close()
            probe.forget(watches.values())

    def _looked_on(
        self, sign: float, watches: Mapping[str, Watch], naps: Naps, unless: int | None
    ) -> bool:
        """Take what comes until the drive is over, or too long; see `_in_real_time`.

        It waits by a clock that is held up as the threads of the node are: on a busy machine a
        pause of the node takes longer, and is not the end.
        """
        ended, commands = EndOfDrive(0.0, REAL_TAIL_SEC), watches['/cmd_vel']
        first = math.inf
        while (now := naps.seconds) < self.seconds + LONGER_SEC and not ended(now, watches):
            time.sleep(POLL_SEC)
            for watch in watches.values():
                watch.pump()
            self.probe.look(now)
            self._others.refuse(commands.samples)
            first = min(first, now) if len(commands) else first
            if unless is not None and now > min(first, BEGIN_SEC) + FEW_SEC:
                if len(commands) < (1 + SAME) * unless + 2:
                    return False
                unless = None
            self._refuse_flood(len(commands), time.time() - sign)
        return True

    def _expect_quiet(self, commands: Watch) -> None:
        """Wait until nothing is commanded; raise Fail if it goes on and on."""
        seen, last = 0, 0.0
        with Naps() as naps:
            while (now := naps.seconds) < last + REAL_QUIET_SEC:
                time.sleep(POLL_SEC)
                commands.pump()
                self.probe.look(0.0)
                self._others.refuse(commands.samples)
                if len(commands) > seen:
                    seen, last = len(commands), now
                if now > self.seconds + LONGER_SEC:
                    self._refuse_never_quiet(len(commands))

    def _refuse_never_quiet(self, count: int) -> NoReturn:
        raise Fail(
            'a robot that nobody drives, before the sign to start is given',
            f'{count} commands on /cmd_vel',
            why=f'{self.source.node} publishes without being asked to.',
            todo=f'Begin when a message comes on {self.sign[0]}.',
        )

    def _refuse_flood(self, count: int, seconds: float) -> None:
        if count > FLOOD_HZ * (seconds + 1.0):
            raise Fail(
                'ten commands a second, or about so',
                f'{count} commands on /cmd_vel in {seconds:.1f} s',
                why='A loop publishes without a pause.',
                todo='Publish in a timer of 0.1 s, one command each time.',
            )


def _few_times(commands: Sequence[Sample] | Sequence[Command]) -> list[int]:
    """Return when the first few commands came, ms from the first one on."""
    times = [round((each.at - commands[0].at) * 1e3) for each in commands]
    return [ms for ms in times if ms < FEW_SEC * 1e3]
