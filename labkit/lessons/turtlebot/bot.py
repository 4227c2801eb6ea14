"""Exercise: the class Bot, which drives home by its odometry."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass

from labkit.exercises import Exercise, Fail, Solution, Style, Wrong, changed
from labkit.lessons._script import in_process, started_by_subprocess
from labkit.lessons.turtlebot.clauses import (
    Begins,
    DriveClause,
    Hears,
    Rate,
    Stops,
    driven,
    short,
)
from labkit.lessons.turtlebot.drive import EMPTY, ODOMETRY, TWIST, Drive
from labkit.lessons.turtlebot.mistakes import first_time_only, int_for_float
from labkit.lessons.turtlebot.trials import Trial

__all__ = ['bot']

STEPS = 20
SIGN = '/go_home'
HOME = (0.0, 0.0)
# How old the odometry may be that a command follows, s: that of the step before is right, too.
STEP_SEC = 0.1
# How far a command may be from what is asked for, m/s.
SAME = 1e-6
# A drive that goes on for so long has no end, s; a right one takes 2 s.
SECONDS = 5.0

_BOT = """
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import Empty


class HomingBot(Node):
    def __init__(self):
        super().__init__('homing_bot')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Odometry, 'odom', self.on_odometry, 10)
        self.create_subscription(Empty, 'go_home', self.on_go, 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.x = 0.0
        self.steps = 0

    def on_odometry(self, msg):
        self.x = msg.pose.pose.position.x

    def on_go(self, msg):
        self.steps = 21

    def on_timer(self):
        if self.steps == 0:
            return
        self.steps -= 1
        msg = Twist()
        if self.steps > 0:
            msg.linear.x = -self.x
        self.publisher.publish(msg)


homing_bot = lab.spin(HomingBot())
"""


@dataclass(frozen=True)
class _Gain(DriveClause):
    """Each command asks for v = -x."""

    @property
    def text(self) -> str:
        return '`linear.x` = -x with the newest odometry (or that of a step before), all else 0.0'

    def look(self, found: Drive) -> None:
        if not found.commands:
            return
        x = found.start.x
        expected = f'the first command with linear.x = {-x:.2f} m/s where x = {x:.2f} m: v = -x'
        if not found.moving:
            raise Fail(
                expected,
                'only commands that say stop',
                why='A robot that stands has the speed 0.0, and twist.twist in an Odometry is the '
                'speed. The place is in pose.pose.',
                todo='self.x = msg.pose.pose.position.x',
            )
        first = found.moving[0]
        if abs(first.v + found.start.y) < SAME:
            raise Fail(
                expected,
                f'linear.x = {first.v:.2f} m/s, where y = {found.start.y:.2f} m',
                why='That is y. Home is where x = 0.',
                todo='self.x = msg.pose.pose.position.x',
            )
        if first.v * x > 0:
            raise Fail(
                expected,
                f'linear.x = {first.v:.2f} m/s: it drives away from home',
                why='The sign is wrong. Where x is below 0 the robot has to drive forwards, where '
                'it is above 0 backwards.',
                todo='v = -x',
            )
        for number, command in enumerate(found.moving[: STEPS + 1], start=1):
            known = [
                pose.x
                for pose in found.seen(
                    command.at + found.margin, since=STEP_SEC + 2 * found.margin
                )
            ]
            if command.w or command.others:
                raise Fail(
                    'linear.x = -x, and 0.0 in all other numbers',
                    f'step {number} says {command}',
                    why='The bot drives straight on: home is where x = 0, whatever y is.',
                    todo='Set msg.linear.x alone.',
                )
            if min(known) - SAME <= -command.v <= max(known) + SAME:
                continue
            raise Fail(
                f'v = -x at every step, so linear.x = {-known[-1]:.3f} m/s where '
                f'x = {known[-1]:.3f} m',
                f'linear.x = {command.v:.3f} m/s there, in step {number}',
                why=_misconception(found, number),
                todo='Let the callback keep x, and read it anew at each step.',
            )


def _misconception(found: Drive, number: int) -> str:
    v, x = found.moving[number - 1].v, found.start.x
    if math.isnan(v):
        return 'nan is no number: something was divided by 0.0, or never set.'
    if number == 1 and abs(x) > SAME:
        return f'The gain is 1 here: v = -1.0 * x. This is {-v / x:.2g} * x, the other way.'
    if v == found.moving[0].v:
        return 'The command does not follow the newest odometry: it stays as it was at the start.'
    return 'The command does not follow the newest odometry.'


@dataclass(frozen=True)
class _Steps(DriveClause):
    """So many steps are taken."""

    @property
    def text(self) -> str:
        return f'publish {STEPS} steps on `/cmd_vel` (`{short(TWIST)}`), ten a second (2 % off)'

    def look(self, found: Drive) -> None:
        count = len(found.moving)
        if not count:
            return
        Rate().look(found)
        if count == STEPS:
            return
        off = 'One too many.' if count == STEPS + 1 else 'One too few.'
        raise Fail(
            f'{STEPS} steps',
            f'{count} steps' + (', and no end' if found.cut else ''),
            why=off
            if abs(count - STEPS) == 1
            else 'The steps are not counted, or not to the right number.',
            todo=f'Count each step, and stop when {STEPS} are done.',
        )


def _draw() -> list[Trial]:
    """Return two drives, one on each side of home."""
    side = random.choice((-1, 1))
    return [
        Trial(
            (way, random.uniform(-0.4, 0.4), random.uniform(-0.2, 0.2)),
            goals=[HOME],
        )
        for way in (side * random.uniform(0.12, 0.2), -side * random.uniform(0.12, 0.2))
    ]


def _tell(drives: Sequence[Drive]) -> str:
    steps = f'{STEPS} steps from x = {drives[0].start.x:.2f} m to x = {drives[0].end.x:.2f} m'
    return f'{steps}, then stop. Each of {len(drives)} times.'


_CLAUSES = (
    Begins(SIGN, EMPTY),
    Hears('/odom', ODOMETRY, SIGN),
    _Steps(),
    _Gain(),
    Stops(),
)

_LOOP = """
import threading

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import Empty

node = rclpy.create_node('loop_bot')
pub = node.create_publisher(Twist, '/cmd_vel', 1)
state = {'x': 0.0}
started = threading.Event()


def keep(msg):
    state['x'] = msg.pose.pose.position.x


def run():
    while True:
        started.wait()
        started.clear()
        rate = node.create_rate(10)
        for _ in range(20):
            msg = Twist()
            msg.linear.x = -state['x']
            pub.publish(msg)
            rate.sleep()
        pub.publish(Twist())


node.create_subscription(Odometry, '/odom', keep, 1)
node.create_subscription(Empty, '/go_home', lambda msg: started.set(), 1)
lab.spin(node)
threading.Thread(target=run, daemon=True).start()
"""

bot = Exercise(
    name='bot',
    task='On /go_home a node drives v = -x for 20 steps at 10 Hz, by its odometry, and stops.',
    subscribes={'/odom': ODOMETRY, '/go_home': EMPTY},
    publishes={'/cmd_vel': TWIST},
    shared=['/cmd_vel'],
    reliable=['/cmd_vel'],
    clauses=_CLAUSES,
    judge=driven((SIGN, EMPTY), _CLAUSES, _draw, _tell, seconds=SECONDS),
    hints=[
        'Three callbacks: the odometry keeps x, the message on /go_home sets a counter, the timer '
        'does one step.',
        'In the timer: nothing if the counter is 0. Else count down, make a Twist, set '
        'msg.linear.x = -self.x, publish.',
        'The stop command is one more step, with an empty Twist(): begin the counter with 21.',
    ],
    answer=Solution(
        _BOT,
        'The callbacks only keep what is new. The timer alone decides when a command is sent, so '
        'the rate is 10 Hz, however often the odometry comes.',
    ),
    styles=[
        Style('a loop with a rate, in a thread', _LOOP),
        Style(
            'a thread that sleeps',
            changed(
                _LOOP,
                ('import threading\n', 'import threading\nimport time\n'),
                ('        rate = node.create_rate(10)\n', ''),
                ('rate.sleep()', 'time.sleep(0.1)'),
            ),
        ),
        Style(
            'each tenth call of a fast timer',
            changed(
                _BOT,
                ('create_timer(0.1,', 'create_timer(0.01,'),
                ('        self.steps = 0\n', '        self.steps = self.calls = 0\n'),
                (
                    '    def on_timer(self):\n        if self.steps == 0:\n',
                    '    def on_timer(self):\n        self.calls += 1\n'
                    '        if self.steps == 0 or self.calls % 10:\n',
                ),
            ),
        ),
        Style(
            'a fast timer that looks at the clock',
            changed(
                _BOT,
                ('create_timer(0.1,', 'create_timer(0.005,'),
                ('        self.steps = 0\n', '        self.steps = self.due = 0\n'),
                (
                    '    def on_timer(self):\n        if self.steps == 0:\n            return\n',
                    '    def on_timer(self):\n        now = self.get_clock().now().nanoseconds\n'
                    '        if self.steps == 0 or now < self.due:\n            return\n'
                    '        self.due = max(self.due, now - 10**7) + 10**8\n',
                ),
            ),
        ),
        Style(
            "a fast timer that looks at the computer's clock",
            changed(
                _BOT,
                ('\nfrom geometry', '\nimport time\n\nfrom geometry'),
                ('create_timer(0.1,', 'create_timer(0.005,'),
                ('        self.steps = 0\n', '        self.steps = self.due = 0\n'),
                (
                    '    def on_timer(self):\n        if self.steps == 0:\n            return\n',
                    '    def on_timer(self):\n        now = time.monotonic()\n'
                    '        if self.steps == 0 or now < self.due:\n            return\n'
                    '        self.due = max(self.due, now - 0.05) + 0.1\n',
                ),
            ),
        ),
        Style('started as a process', started_by_subprocess(in_process(_BOT))),
        Style('own process', in_process(_BOT), process=True),
    ],
    wrong=[
        Wrong('sign of the error', changed(_BOT, ('= -self.x', '= self.x')), 'The sign is wrong'),
        Wrong(
            'reads the speed',
            changed(_BOT, ('msg.pose.pose.position.x', 'msg.twist.twist.linear.x')),
            'The place is in pose.pose.',
        ),
        Wrong(
            'reads Twist instead of Odometry',
            changed(
                _BOT,
                ("Odometry, 'odom'", "Twist, 'cmd_vel'"),
                ('msg.pose.pose.position.x', 'msg.linear.x'),
            ),
            'Where it is, an Odometry on /odom tells',
        ),
        Wrong(
            'forgets to stop',
            changed(_BOT, ('self.steps = 21', 'self.steps = 20'), ('self.steps > 0:', 'True:')),
            'leaves it driving',
        ),
        Wrong(
            'never ends',
            changed(_BOT, ('        self.steps -= 1\n', '')),
            'The steps are not counted',
        ),
        Wrong(
            'controls inside the callback',
            changed(
                _BOT,
                ('= self.create_timer(0.1, self.on_timer)', '= None'),
                ('position.x\n', 'position.x\n        self.on_timer()\n'),
            ),
            'the sensor sets the rate',
        ),
        first_time_only(_BOT, 'self.steps = 21'),
        Wrong(
            'drives all the time',
            changed(
                _BOT,
                (
                    '        if self.steps == 0:\n            return\n        self.steps -= 1\n',
                    '        self.steps = 21\n',
                ),
            ),
            'publishes without being asked to',
        ),
        Wrong('a step too few', changed(_BOT, ('steps = 21', 'steps = 20')), 'One too few'),
        Wrong(
            'twelve and a half commands a second',
            changed(_BOT, ('create_timer(0.1,', 'create_timer(0.08,')),
            'a command every 0.08 s (12.5 Hz)',
        ),
        Wrong(
            'a period of 0',
            changed(_BOT, ('create_timer(0.1,', 'create_timer(0.0,')),
            'A timer has no period',
        ),
        Wrong(
            'all at once',
            changed(
                _BOT,
                ('= self.create_timer(0.1, self.on_timer)', '= None'),
                (
                    '        self.steps = 21\n',
                    '        self.steps = 21\n        while self.steps:\n'
                    '            self.on_timer()\n',
                ),
            ),
            'A loop publishes them without a pause',
        ),
        Wrong(
            'each command twice',
            changed(
                _BOT, ('publish(msg)\n', 'publish(msg)\n        self.publisher.publish(msg)\n')
            ),
            'is publish() called twice',
        ),
        Wrong(
            'another gain', changed(_BOT, ('= -self.x', '= -1.1 * self.x')), 'The gain is 1 here'
        ),
        Wrong('y for x', changed(_BOT, ('position.x', 'position.y')), 'That is y.'),
        Wrong(
            'the place at the start',
            changed(
                _BOT,
                ('        self.x = 0.0\n', '        self.x = self.start = 0.0\n'),
                (
                    '        self.steps = 21\n',
                    '        self.steps = 21\n        self.start = self.x\n',
                ),
                ('= -self.x', '= -self.start'),
            ),
            'it stays as it was at the start',
        ),
        Wrong(
            'turns a little',
            changed(
                _BOT,
                (
                    '            msg.linear.x = -self.x\n',
                    '            msg.linear.x = -self.x\n            msg.angular.z = 0.1\n',
                ),
            ),
            'The bot drives straight on',
        ),
        Wrong(
            'a speed that is no number',
            changed(_BOT, ('= -self.x', "= float('nan')")),
            'nan is no number',
        ),
        Wrong(
            'says stop for ever',
            changed(
                _BOT,
                (
                    '        if self.steps == 0:\n            return\n        self.steps -= 1\n',
                    '        if self.steps == 0:\n            self.publisher.publish(Twist())\n'
                    '            return\n        self.steps -= 1\n',
                ),
            ),
            'all of them stop commands',
        ),
        Wrong(
            'says stop three times',
            changed(
                _BOT,
                ('self.steps = 21', 'self.steps = 23'),
                ('if self.steps > 0:\n            msg', 'if self.steps > 2:\n            msg'),
            ),
            'It stands, and still publishes.',
        ),
        Wrong(
            'an older node of another name',
            changed(_BOT, ("__init__('homing_bot')", "__init__('old_bot')"))
            + f'\n{_BOT.strip()}\n',
            'Each of them drives the robot',
        ),
        int_for_float(_BOT, '= -self.x', '= -int(10 * self.x)'),
        Wrong(
            'publishes when it is made, and not at the sign',
            changed(
                _BOT,
                ('        self.steps = 21\n', '        pass\n'),
                (
                    '        self.x = 0.0\n',
                    '        self.x = 0.0\n        self.steps = 1\n        self.on_timer()\n',
                ),
            ),
            'does not start anything',
        ),
        Wrong(
            'waits in the callback',
            changed(
                _BOT,
                (
                    '        self.steps = 21\n',
                    '        import time\n\n        time.sleep(3)\n',
                ),
            ),
            'While a callback runs, no other one can',
        ),
    ],
)
