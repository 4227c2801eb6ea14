"""Where the driving tasks take place: a robot, which the learner's node drives at a sign.

The robot and the node step together, in virtual time (`labkit.exercises.observation`), so a drive
takes a fraction of its time and is the same on a busy machine. A node of another process is told
the time in steps, and its commands are known to such a step. One that keeps a time of its own, as
a process that sleeps by itself does, fails, and is told to use a timer.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from labkit.exercises import Clause, Fail, Probe, Stage, expect, words_of
from labkit.exercises.clauses import Evidence
from labkit.exercises.figures import many
from labkit.exercises.judging import find, naming
from labkit.exercises.observation import Life, Stimulus, live
from labkit.lessons.turtlebot.drawing import observed
from labkit.lessons.turtlebot.drive import (
    ODOMETRY,
    SAME,
    SCAN,
    STEP_SEC,
    TAIL_SEC,
    TWIST,
    Drive,
    EndOfDrive,
    Trial,
    command_of,
)
from labkit.lessons.turtlebot.drive_clauses import AT_ONCE, UNASKED, Begins
from labkit.lessons.turtlebot.robot import (
    find_robot,
    in_room,
    listed_others,
    place,
    refuse_copies,
    refuse_others,
    walls_near,
)

if TYPE_CHECKING:
    from labkit.exercises.messages_heard import Lived, Watch
    from labkit.exercises.time.virtual_time import VirtualTime

__all__ = ['Drives', 'Trials']

WORDS = words_of(__file__)

# The sign is given when time has passed for so long, s; no timer of a node ticks just then.
SIGN_SEC = 0.25
# How long a drive may take longer than the task allows, until it is cut, s.
LONGER_SEC = 1.0
# How often nodes of other processes are told the time, s: so their rate is known.
TICK_SEC = STEP_SEC / 2
# More commands a second than this are a loop without a pause.
FLOOD_HZ = 200.0

DEAF = WORDS.mistake('turtlebot/deaf')
OWN_TIME = (
    ' In a process of its own let a timer send the commands: how a loop drives that sleeps by '
    'itself, a check can tell in this notebook only.'
)


@dataclass(frozen=True)
class Drives(Stage[Drive]):
    """A robot that the learner's node drives when it is given the sign to start.

    Attributes:
        sign: The topic of the sign, and the type there.
        draw: Draws where the drives begin, and where they lead.
        say: Says what was seen, if all was right.
        seconds: How long a drive may take, s.
        physics: Whether it takes place in worlds with physics.
    """

    sign: tuple[str, str]
    draw: Callable[[], Sequence[Trial]]
    say: Callable[[Sequence[Drive]], str]
    seconds: float
    physics: bool = False

    @contextmanager
    def scenes(self, probe: Probe, clauses: Sequence[Clause[Drive]]) -> Iterator[Iterator[Drive]]:
        """Find the node and the robot, and make the drives one after the other."""
        evidence = Evidence(probe)
        find(clauses, Drive(evidence))
        trials = Trials(evidence, self.sign, self.seconds, physics=self.physics)
        with observed() as drives:
            with naming(next(each for each in clauses if isinstance(each, Begins))):
                trials.wait_until_quiet()
            try:
                yield trials.made(self.draw(), drives)
            except Fail as fail:
                if not trials.is_here:
                    fail.todo += OWN_TIME
                raise

    def tell(self, seen: Sequence[Drive]) -> str:
        """Say what was seen."""
        return self.say(seen)


class Trials:
    """The drives of one check.

    Args:
        evidence: What was found in the graph.
        sign: The topic on which the node hears the sign to start, and the type there.
        seconds: How long a drive may take, s.
        physics: Whether they take place in worlds with physics.
    """

    def __init__(
        self,
        evidence: Evidence,
        sign: tuple[str, str],
        seconds: float,
        *,
        physics: bool = False,
    ) -> None:
        self._evidence, self._probe = evidence, evidence.probe
        self._sign, self._seconds = sign, seconds
        node = evidence.subscription(sign[0]).node
        self._source = evidence.publisher('/cmd_vel', node)
        refuse_copies(self._probe, node, sign[0])
        self.is_here = self._probe.in_this_process(self._source)
        if self.is_here:
            expect.spun(self._probe, self._source)
        self._robot = find_robot(self._probe, physics=physics)

    def made(self, trials: Sequence[Trial], drives: list[Drive]) -> Iterator[Drive]:
        """Make the drives, one after the other.

        Args:
            trials: What is to be driven.
            drives: Gets the drives, too.

        Raises:
            Fail: Another node drives, or the node keeps a time of its own.
            LearnerError: A callback has raised.
        """
        for trial in trials:
            found = Drive(
                self._evidence,
                sign=SIGN_SEC,
                number=len(drives),
                goals=trial.goals,
                from_start=trial.from_start,
                # What another process answers may come a step later.
                margin=SAME if self.is_here else 2 * TICK_SEC + SAME,
            )
            with in_room(self._robot, trial):
                longest = SIGN_SEC + self._seconds + LONGER_SEC
                until = _noting(self._robot, found, EndOfDrive(SIGN_SEC))
                life = self._live(longest, until, trial)
                found.cut = life.seconds >= longest
                found.take(life)
                if found.poses:
                    found.walls = walls_near(self._robot, found.end)
            drives.append(found)
            if not found.commands:
                # Of another process this is not asked before: a lost answer proves nothing.
                expect.spun(self._probe, self._source)
            yield found

    def wait_until_quiet(self) -> None:
        """Let time pass until nothing is commanded: an earlier drive may not be over.

        Raises:
            Fail: It goes on and on.
        """
        limit = self._seconds + TAIL_SEC + LONGER_SEC
        was_told = self._was_told()
        life = self._live(limit, EndOfDrive(0.0))
        commands = life.on('/cmd_vel')
        if not was_told:
            self._refuse_unasked(commands)
        if life.seconds >= limit:
            refuse_others(self._probe, self._source, commands, unasked=True)
            expected = 'a robot that nobody drives, before the sign to start is given'
            seen = f'{many(len(commands), "command")} on /cmd_vel in {limit:.0f} s'
            # A key of a teleop may be held: that is not told by a message.
            others = listed_others(self._probe, self._source)
            seen += f'; {others} can drive the robot as well' if others else ''
            raise Fail(expected, seen, UNASKED)

    def _was_told(self) -> bool:
        """Tell whether anything but the robot has told the node to drive; if in doubt, it has."""
        node = self._probe.node_object(self._source.node)
        if node is None:
            return True
        sensors = ('/odom', '/scan', '/clock', '/tf', '/tf_static')
        asked = [end for end in node.subscriptions if end.topic_name not in sensors]
        counts = [self._probe.callbacks.count(node, end) for end in (*asked, *node.services)]
        return any(count is None or count > 0 for count in counts)

    def _refuse_unasked(self, commands: Sequence[Lived]) -> None:
        """Raise Fail if the node has driven, and nothing has told it to.

        Args:
            commands: What was said just now.
        """
        before = self._evidence.earlier('/cmd_vel', self._source.node)
        mine = [sample for sample in commands if sample.node == self._source.node]
        said = [*map(command_of, before), *map(command_of, mine)]
        moves = [command for command in said if not command.stops]
        if moves:
            raise Fail(
                'no command that moves the robot, before the sign to start is given',
                f'{len(moves)} of them, the first one {moves[0]}, when nothing had come on '
                f'{self._sign[0]} yet',
                UNASKED,
            )

    def _live(
        self,
        seconds: float,
        until: Callable[[float, Mapping[str, Watch]], bool],
        trial: Trial | None = None,
    ) -> Life:
        """Let time pass for the robot and the node under test.

        Raises:
            Fail: Another node drives, a callback does not return, there is no end of them, or the
                node keeps a time of its own.
            LearnerError: A callback has raised.
        """

        def begin(passing: VirtualTime) -> None:
            if trial is not None:
                place(self._robot, trial.start)
            passing.restart_timers()

        stimuli = [Stimulus(SIGN_SEC, *self._sign, trial.fields, ('/cmd_vel',))] if trial else []
        life = live(
            self._probe,
            {'/cmd_vel': TWIST, '/odom': ODOMETRY, self._sign[0]: self._sign[1]},
            seconds,
            stimuli=stimuli,
            also={'/scan': SCAN},
            nodes={self._robot.get_fully_qualified_name(), self._source.node},
            step=TICK_SEC,
            before=begin,
            until=until,
        )
        commands = life.on('/cmd_vel')
        if len(commands) > FLOOD_HZ * (life.seconds + 1.0):
            raise Fail(
                'ten commands a second, or about so',
                f'{many(len(commands), "command")} on /cmd_vel in {life.seconds:.1f} s',
                AT_ONCE,
            )
        refuse_others(self._probe, self._source, commands)
        self._evidence.life = life
        self._evidence.refuse_trouble(())
        if not self.is_here and not life.remote:
            name = self._source.node
            expected = f'{name} follows the time of ROS (use_sim_time), as its timers do'
            raise Fail(expected, f'{name} does not answer when it is told the time', DEAF)
        return life


def _noting(
    robot: Any, drive: Drive, until: Callable[[float, Mapping[str, Watch]], bool]
) -> Callable[[float, Mapping[str, Watch]], bool]:
    """Return when a drive is over; in a world with physics, note meanwhile what is where."""

    def noting(now: float, watches: Mapping[str, Watch]) -> bool:
        drive.true_poses.append((now, robot.pose))
        drive.crate += [(now, pose) for pose in robot.simulator.physics.crate_poses()[:1]]
        return until(now, watches)

    return noting if robot.simulator.has_physics else until
