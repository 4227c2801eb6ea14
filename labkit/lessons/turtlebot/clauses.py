"""The clauses that the driving tasks of this lesson share."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import NoReturn

from labkit.exercises import Fail
from labkit.exercises.clauses import Clause, Evidence
from labkit.lessons.turtlebot.drive import ODOMETRY, TWIST, Drive

__all__ = [
    'SLEEP_TOLERANCE',
    'Begins',
    'DriveClause',
    'Hears',
    'Rate',
    'Sensible',
    'Stops',
    'look_at_time',
    'short',
]

# How soon after the sign the first command has to come, s; and in real time.
BEGIN_SEC = 0.5
BEGIN_REAL_SEC = 1.0
# How far a rate may be off, as a part of it; where time is real, it depends on the machine, too.
TOLERANCE = 0.02
REAL_TOLERANCE = 0.2
# How far the shortest sleeps of a thread may be off 0.1 s, as a part of it.
SLEEP_TOLERANCE = 0.03
# How far one gap between two commands may be off.
GAP_TOLERANCE = 0.5
# What no robot of this kind can do, m/s and rad/s; degrees for radians are beyond it.
TOO_FAST, TOO_ROUND = 1.0, 10.0


class DriveClause(Clause):
    """A clause that looks at drives, one after the other."""

    @abstractmethod
    def look(self, found: Drive) -> None:
        """Look at a drive.

        Raises:
            Fail: It is not what the clause asks for.
        """


def short(msg_type: str) -> str:
    """Return the name of a type as it is imported, such as `'Twist'`."""
    return msg_type.rpartition('/')[2]


@dataclass(frozen=True)
class Begins(DriveClause):
    """The node begins each time that a message comes, and only then.

    Attributes:
        topic: The topic of the sign to start.
        msg_type: Name of its type.
    """

    topic: str
    msg_type: str

    @property
    def text(self) -> str:
        """What is asked for."""
        return (
            f'begin within {BEGIN_SEC} s of each message (`{short(self.msg_type)}`) on '
            f'`{self.topic}`, and only then'
        )

    def find(self, evidence: Evidence) -> None:
        """Look for a node that hears the sign and publishes commands."""
        evidence.publisher('/cmd_vel', evidence.subscription(self.topic).node)

    def look(self, found: Drive) -> None:
        """Look at the first command."""
        expected = f'a command on /cmd_vel within {BEGIN_SEC} s after a message on {self.topic}'
        todo = 'Let the callback set what the timer looks at, and publish in the timer.'
        if not found.commands and found.number:
            raise Fail(
                'a drive each time that a message comes',
                f'drives upon {found.number} of them, and nothing upon the next one',
                why='Something is used up by the first drive: a counter, a plan, a flag that is '
                'never set back.',
                todo='Set in the callback of the message all that a drive needs.',
            )
        if not found.commands:
            raise Fail(
                expected,
                'nothing, though the sign to start was given',
                why='The callback of the sign does not start anything, or the timer does not '
                'publish.',
                todo=todo,
            )
        early = [command for command in found.commands if command.at < found.sign]
        if early:
            raise Fail(
                'no command before the sign to start',
                f'{early[0]}, {found.sign - early[0].at:.2f} s before it',
                why='It drives without being asked to.',
                todo=todo,
            )
        late = found.commands[0].at - found.sign
        limit = BEGIN_SEC if found.exact else BEGIN_REAL_SEC
        if late > limit + found.margin:
            raise Fail(
                expected,
                f'the first one comes after {late:.2f} s',
                why='Something waits before the drive begins, or the period is too long.',
                todo=todo,
            )


@dataclass(frozen=True)
class Hears(Clause):
    """The node that drives subscribes to a topic as well.

    Attributes:
        topic: Full name of the topic.
        msg_type: Name of its type.
        sign: The topic of the sign to start, which tells the node.
    """

    topic: str
    msg_type: str
    sign: str

    @property
    def text(self) -> str:
        """What is asked for."""
        return f'subscribe to `{self.topic}` (`{short(self.msg_type)}`)'

    def find(self, evidence: Evidence) -> None:
        """Look for the subscription."""
        name = evidence.subscription(self.sign).node
        probe = evidence.probe

        def hears(topic: str) -> bool:
            return name in {end.node for end in probe.subscriptions(topic)}

        # What another process subscribes to is seen piece by piece.
        missing = not probe.wait_to_appear(lambda: hears(self.topic))
        if missing and self.topic == '/odom' and hears('/cmd_vel'):
            raise Fail(
                f'{name} with a subscription to /odom ({ODOMETRY})',
                f'{name} subscribes to /cmd_vel',
                why='A Twist on /cmd_vel says how fast the robot shall be. Where it is, an '
                'Odometry on /odom tells.',
                todo="self.create_subscription(Odometry, 'odom', self.on_odometry, 10)",
            )
        evidence.subscription(self.topic, name)


@dataclass(frozen=True)
class Rate(DriveClause):
    """Commands come ten times a second, from the first to the one that says stop.

    Attributes:
        pause: How long a pause between two of them may be, s; 0 if there may be none.
        pauses: How many pauses there may be.
    """

    pause: float = 0.0
    pauses: int = 0

    @property
    def text(self) -> str:
        """What is asked for."""
        rate = f'publish on `/cmd_vel` (`{short(TWIST)}`) ten times a second (2 % off)'
        return rate if not self.pause else f'{rate}, with pauses of up to {self.pause:g} s'

    def look(self, found: Drive) -> None:
        """Look at the time between commands."""
        gaps = found.gaps
        expected = 'a command every 0.1 s (10 Hz), until the drive is over'
        short = [gap for gap in gaps if gap <= (1 + GAP_TOLERANCE) * 0.1 + found.margin]
        long = [gap for gap in gaps if gap not in short]
        if gaps and max(gaps) <= 1e-3:
            raise Fail(
                expected,
                f'{len(found.commands)} commands at once',
                why='A loop publishes them without a pause. The robot obeys the last one.',
                todo='One command each time that the timer of 0.1 s calls.',
            )
        few = [gap for gap in gaps if gap < (1 - GAP_TOLERANCE) * 0.1 - found.margin]
        if found.exact and 1 < len(gaps) / 3 < len(few) < 0.7 * len(gaps):
            raise Fail(
                expected,
                f'{len(few)} of {len(gaps)} commands less than 0.05 s after the one before',
                why='More than one place publishes, or one place twice: is publish() called '
                'twice?',
                todo='One command each time that the timer of 0.1 s calls.',
            )
        period = found.period
        held_up = found.slowness > 1 + SLEEP_TOLERANCE
        if not found.exact and held_up and abs(found.meant / 0.1 - 1) < SLEEP_TOLERANCE:
            period = found.meant
        tolerance = TOLERANCE if found.exact else REAL_TOLERANCE
        if found.exact and short:
            # A time that is known to a tick tells a rate less exactly when a drive is short.
            tolerance += 2 * found.margin / sum(short) if found.margin > 1e-3 else 0.0
        if period and not abs(period / 0.1 - 1) <= tolerance:
            self._refuse(found, expected, period)
        last = gaps[-1] if gaps and found.ending else 0.1
        if found.exact and last < (1 - GAP_TOLERANCE) * 0.1 - found.margin:
            raise Fail(
                expected,
                f'the stop command comes {last:.3g} s after the last step',
                why='The last step ends before it has begun: the robot obeys the newest command.',
                todo='Let the stop command be one more step of the timer.',
            )
        if found.exact and few:
            raise Fail(
                expected,
                f'{min(few):.2g} s from one command to the next, once at least',
                why='Something else than the timer publishes, too.',
                todo='One command each time that the timer of 0.1 s calls.',
            )
        allowed = self.pause + found.margin if self.pause else 0.0
        too_long = [gap for gap in long if gap > allowed]
        if found.exact and (too_long or len(long) > self.pauses):
            raise Fail(
                expected,
                f'{len(long)} pauses, the longest one of {max(long):.2g} s'
                if len(long) > 1
                else f'a pause of {long[0]:.2g} s',
                why='A robot obeys a command for one second only, and turns and drives on in a '
                'pause.',
                todo='Let the timer go on to publish, also while the robot shall rest.',
            )

    def _refuse(self, found: Drive, expected: str, period: float) -> NoReturn:
        seen = f'a command every {period:.3g} s ({1 / period:.3g} Hz)'
        if abs(period - 1 / 30) < 0.002:
            raise Fail(
                expected,
                seen,
                why='The odometry comes 30 times a second, and its callback sends a command each '
                'time. So the sensor sets the rate of the control.',
                todo='Let the callback only keep the newest value, and publish in a timer of '
                '0.1 s.',
            )
        why = 'The rate is set by the period of the timer, in seconds.'
        if abs(period - 0.05) < 0.001:
            why = 'Twice as many: is publish() called twice, or the period half as long?'
        raise Fail(expected, seen, why=why, todo='create_timer(0.1, self.on_timer)')


@dataclass(frozen=True)
class Sensible(DriveClause):
    """The numbers of the commands are such as a robot can do."""

    @property
    def text(self) -> str:
        """What is asked for."""
        return f'ask for no more than {TOO_FAST:g} m/s and {TOO_ROUND:g} rad/s'

    def look(self, found: Drive) -> None:
        """Look at all numbers."""
        for command in found.commands:
            if abs(command.v) <= TOO_FAST and abs(command.w) <= TOO_ROUND and not command.others:
                continue
            why, todo = 'The robot has two wheels: it obeys linear.x and angular.z alone.', ''
            if not abs(command.v) <= TOO_FAST or command.v != command.v:
                why = 'No robot can drive like that. This one ignores the command and stops, or '
                why += 'drives as fast as it can.'
            elif not abs(command.w) <= TOO_ROUND:
                why = 'Its angles are degrees. ROS measures angles in radians, and turning rates '
                why += 'in radians a second. This robot can turn at 2.84 rad/s at most.'
                todo = 'math.pi / 2 is a right angle. math.atan2() gives radians as well.'
                if command.w != command.w:
                    why, todo = 'A nan is no number: a division or a root had no result.', ''
            raise Fail(
                f'at most {TOO_FAST:g} m/s in linear.x and {TOO_ROUND:g} rad/s in angular.z, and '
                '0.0 in the other numbers',
                f'a command with {command}',
                why=why,
                todo=todo,
            )


@dataclass(frozen=True)
class Stops(DriveClause):
    """The last command says stop, and nothing follows.

    Attributes:
        rests: Whether the robot may rest on its way, and at the end for a second, too.
    """

    rests: bool = False

    @property
    def text(self) -> str:
        """What is asked for."""
        if self.rests:
            return 'end with stop commands (all 0.0) for up to 1 s, then nothing more'
        return 'end with one stop command (all 0.0), then nothing more'

    def look(self, found: Drive) -> None:
        """Look at the last commands."""
        expected = 'a last command with all numbers 0.0, and then none'
        ending, moving = found.ending, found.moving
        if not moving:
            return
        if not ending and found.cut:
            raise Fail(
                expected,
                f'the command {moving[-1]}, and more of them, {found.duration:.0f} s after the '
                'sign',
                why='It does not end: it goes on to send commands that move the robot.',
                todo='When it is there: publish an empty Twist() once, and then nothing more.',
            )
        if not ending:
            raise Fail(
                expected,
                f'the last command says {moving[-1]}',
                why='A robot obeys the last command that it heard. Whoever ends without a stop '
                'command leaves it driving.',
                todo='At the end publish an empty Twist(): all of its fields are 0.0.',
            )
        rest = [number for number, command in enumerate(moving, start=1) if command.stops]
        if rest and not self.rests:
            raise Fail(
                'one command that says stop, at the end',
                f'command {rest[0]} of {len(moving)} says stop, and then it drives on',
                why='It stops on its way.',
                todo='Say stop when the drive is over, and only then.',
            )
        longest = 1.0 + found.margin if self.rests else 0.0
        if ending[-1].at - ending[0].at > longest or (len(ending) > 1 and not self.rests):
            raise Fail(
                expected,
                f'{len(ending)} commands that say stop, over {ending[-1].at - ending[0].at:.1f} s',
                why='It stands, and still publishes. So nobody else can drive the robot, such as '
                'a person with the keys.',
                todo='Forget the drive when it is over, and return in the timer until the next '
                'message comes.',
            )


def look_at_time(found: Drive, seconds: float) -> None:
    """Raise Fail if a drive takes longer than so many seconds."""
    taken = found.moving[-1].at - found.sign if found.moving else 0.0
    if taken / found.slowness > seconds + found.margin:
        raise Fail(
            f'an end of the drive {seconds:g} s after the message',
            f'it still moves after {taken:.1f} s',
            why='It drives or turns too slowly, or goes on and on.',
            todo='Let it drive at 0.2 m/s, and turn at about 1.5 rad/s.',
        )
