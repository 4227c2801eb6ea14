"""How a check drives a node that keeps a time of its own, such as a thread with `time.sleep()`.

The robot and the node run as they do without a check, and a check waits: until the node is at
rest, and until its drive is over. A busy machine holds up both; see `labkit.exercises.naps`.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NoReturn

from labkit.exercises import Fail, Probe
from labkit.exercises.naps import Naps
from labkit.lessons.turtlebot.drive import ODOMETRY, SCAN, TWIST, Drive, EndOfDrive, Trial
from labkit.lessons.turtlebot.robot import OtherDrivers, place

if TYPE_CHECKING:
    from labkit.exercises.watch import Watch
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['BEGIN_SEC', 'FEW_SEC', 'LONGER_SEC', 'POLL_SEC', 'RealTime', 'refuse_flood']

# Times of commands are known to so much, s.
MARGIN_SEC = 0.25
# How long nothing may be commanded before a drive, and after it, s. A square may have pauses of
# 1 s, which last longer on a busy machine.
QUIET_SEC = 1.6
# How often it is tried to find the node at rest.
ATTEMPTS = 3
# The first command comes within this time, s.
BEGIN_SEC = 1.0
# How long a drive may take longer than the task allows, until it is cut, s.
LONGER_SEC = 1.0
# A node that keeps its own time sends more commands within so long a time, s, in real time than in
# virtual time; more by this share at least.
FEW_SEC, SAME = 0.8, 0.3
# More commands a second than this are a loop without a pause.
FLOOD_HZ = 200.0
POLL_SEC = 0.005


@dataclass
class RealTime:
    """Drives in real time.

    Attributes:
        probe: The probe of the check.
        robot: The robot.
        source: The publisher of the node under test.
        sign: The topic on which it hears the sign to start, and the type there.
        seconds: How long a drive may take, s.
        others: Who else may drive.
    """

    probe: Probe
    robot: Any
    source: Endpoint
    sign: tuple[str, str]
    seconds: float
    others: OtherDrivers

    def drive(self, trial: Trial, *, unless: int | None = None) -> Drive | None:
        """Let the robot and the node run, as they do without a check.

        Args:
            trial: What is to be driven.
            unless: If not many more commands than these come within `FEW_SEC`, give it up: the
                node is no quicker in real time than in virtual time.

        Returns:
            What was seen; None if it was given up.
        """
        with self.probe.uncounted():
            return self._drive(trial, unless)

    def _drive(self, trial: Trial, unless: int | None) -> Drive | None:
        probe, topics = self.probe, {'/cmd_vel': TWIST, '/odom': ODOMETRY, '/scan': SCAN}
        watches = {topic: probe.watch(topic, msg_type) for topic, msg_type in topics.items()}
        try:
            send = probe.sender(*self.sign)
            for _ in range(ATTEMPTS):
                self._expect_quiet(watches['/cmd_vel'])
                # On a busy machine a thread may have stood still in the middle of a drive.
                if self._put(trial.start, watches) and not len(watches['/cmd_vel']):
                    break
            found = Drive(goals=trial.goals, from_start=trial.from_start, exact=False)
            found.margin = MARGIN_SEC
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
        """Take what comes until the drive is over, or too long; see `drive`.

        It waits by a clock that is held up as the threads of the node are: on a busy machine a
        pause of the node takes longer, and is not the end.
        """
        ended, commands = EndOfDrive(0.0, QUIET_SEC), watches['/cmd_vel']
        first = math.inf
        while (now := naps.seconds) < self.seconds + LONGER_SEC and not ended(now, watches):
            time.sleep(POLL_SEC)
            for watch in watches.values():
                watch.pump()
            self.probe.look(now)
            self.others.refuse(commands.samples)
            first = min(first, now) if len(commands) else first
            if unless is not None and now > min(first, BEGIN_SEC) + FEW_SEC:
                if len(commands) < (1 + SAME) * unless + 2:
                    return False
                unless = None
            refuse_flood(len(commands), time.time() - sign)
        return True

    def _put(self, start: tuple[float, float, float], watches: Mapping[str, Watch]) -> bool:
        """Put the robot somewhere, and tell whether the node has heard of it."""
        from labkit.background.patience import answer_sec

        place(self.robot, start)
        placed, odometry = time.time(), watches['/odom'].samples
        for topic in ('/odom', '/scan'):
            watches[topic].pump()
            watches[topic].clear()
        # When the second one of the new place is here, the node has had the first one.
        return self.probe.wait(
            lambda: len(odometry) > 1 and odometry[-2].stamp > placed, answer_sec(1.0)
        )

    def _expect_quiet(self, commands: Watch) -> None:
        """Wait until nothing is commanded, and forget what was; raise Fail if there is no end."""
        seen, last = 0, 0.0
        with Naps() as naps:
            while (now := naps.seconds) < last + QUIET_SEC:
                time.sleep(POLL_SEC)
                commands.pump()
                self.probe.look(0.0)
                self.others.refuse(commands.samples)
                if len(commands) > seen:
                    seen, last = len(commands), now
                # One drive may not be over, and another one have been asked for meanwhile.
                if now > 2 * self.seconds + LONGER_SEC:
                    self._refuse_never_quiet(len(commands))
        commands.clear()

    def _refuse_never_quiet(self, count: int) -> NoReturn:
        raise Fail(
            'a robot that nobody drives, before the sign to start is given',
            f'{count} commands on /cmd_vel',
            why=f'{self.source.node} publishes without being asked to.',
            todo=f'Begin when a message comes on {self.sign[0]}.',
        )


def refuse_flood(count: int, seconds: float) -> None:
    """Raise Fail if more was commanded than a node with a pause between two commands sends.

    Args:
        count: How many commands came.
        seconds: In how much time, s.
    """
    if count > FLOOD_HZ * (seconds + 1.0):
        raise Fail(
            'ten commands a second, or about so',
            f'{count} commands on /cmd_vel in {seconds:.1f} s',
            why='A loop publishes without a pause.',
            todo='Publish in a timer of 0.1 s, one command each time.',
        )
