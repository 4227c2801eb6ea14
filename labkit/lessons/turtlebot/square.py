"""Exercise: drive a square."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from labkit.exercises import Exercise, Probe, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Clause, Evidence
from labkit.exercises.variants import varied
from labkit.lessons._script import in_process
from labkit.lessons.turtlebot.clauses import (
    Begins,
    Rate,
    Sensible,
    Stops,
)
from labkit.lessons.turtlebot.drive import EMPTY, TWIST, Drive
from labkit.lessons.turtlebot.judge import driven
from labkit.lessons.turtlebot.mistakes import first_time_only, int_for_float
from labkit.lessons.turtlebot.robot import find_robot
from labkit.lessons.turtlebot.square_clauses import Closes, Outline, Sides, draw, tell
from labkit.lessons.turtlebot.trials import Trials

__all__ = ['square']

SIGN = '/go_square'
# Sides of variants, m. The corner opposite to the start is in none near that of another.
SIDES = (0.24, 0.4, 0.56, 0.72)

_SQUARE = """
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Empty


class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Empty, 'go_square', self.on_go, 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.plan = []

    def on_go(self, msg):
        side = 20 * [(0.2, 0.0)] + 2 * [(0.0, 0.0)]
        turn = 10 * [(0.0, 1.5708)] + 5 * [(0.0, 0.0)]
        self.plan = 4 * (side + turn)

    def on_timer(self):
        if not self.plan:
            return
        v, w = self.plan.pop(0)
        msg = Twist()
        msg.linear.x, msg.angular.z = v, w
        self.publisher.publish(msg)


square = lab.spin(Square())
"""

_BY_ODOMETRY = """
import math

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import Empty

node = rclpy.create_node('by_odometry')
pub = node.create_publisher(Twist, '/cmd_vel', 10)
state = {'pose': None, 'todo': []}


def on_odometry(msg):
    q, p = msg.pose.pose.orientation, msg.pose.pose.position
    state['pose'] = p.x, p.y, 2 * math.atan2(q.z, q.w)


def on_go(msg):
    x, y, yaw = state['pose']
    corners = [(0.4, 0.0), (0.4, 0.4), (0.0, 0.4), (0.0, 0.0)]
    state['todo'] = [
        (x + a * math.cos(yaw) - b * math.sin(yaw), y + a * math.sin(yaw) + b * math.cos(yaw))
        for a, b in corners
    ]


def on_timer():
    if not state['todo']:
        return
    x, y, yaw = state['pose']
    dx, dy = state['todo'][0][0] - x, state['todo'][0][1] - y
    error = math.remainder(math.atan2(dy, dx) - yaw, math.tau)
    msg = Twist()
    if math.hypot(dx, dy) < 0.03:
        state['todo'].pop(0)
    elif abs(error) > 0.2:
        msg.angular.z = 2.0 * error
    else:
        msg.linear.x, msg.angular.z = 0.2, 2.0 * error
    pub.publish(msg)


node.create_subscription(Odometry, 'odom', on_odometry, 10)
node.create_subscription(Empty, 'go_square', on_go, 10)
node.create_timer(0.1, on_timer)
lab.spin(node)
"""


def _clauses(outline: Outline) -> tuple[Clause, ...]:
    return (
        Begins(SIGN, EMPTY),
        Sensible(),
        Rate(pause=1.0, pauses=8),
        Sides(outline),
        Stops(rests=True),
        Closes(outline),
    )


def _task(outline: Outline) -> str:
    return (
        f'On /go_square a node drives a square of {outline.side} m to the {outline.turn}, and '
        'stops where it began.'
    )


def _hints(outline: Outline) -> list[str]:
    side, turn = outline.side, outline.turn
    sign = '' if turn == 'left' else '-'
    return [
        f'A square is four times the same: a side, then a turn of 90 degrees to the {turn}.',
        f'Way = speed * time. 0.2 m/s for {side / 0.2:g} s are {side} m: {side / 0.02:.0f} steps '
        f'of 0.1 s. Angle = turning rate * time. {sign}1.57 rad/s for 1 s are 90 degrees to the '
        f'{turn}: 10 steps.',
        'Make a list of (v, w), one for each step, and let the timer take one at a time. '
        'Let it rest for some steps, (0.0, 0.0), after each side and each turn.',
    ]


def _judge(outline: Outline) -> Callable[[Probe], str]:
    drives = partial(draw, outline)
    return driven((SIGN, EMPTY), _clauses(outline), drives, tell, seconds=outline.seconds)


_LOOP = """
import threading

import rclpy
from geometry_msgs.msg import Twist
from std_msgs.msg import Empty

node = lab.spin(rclpy.create_node('surveyor'))
publisher = node.create_publisher(Twist, '/cmd_vel', 10)
started = threading.Event()


def send(v, w, steps):
    msg = Twist()
    msg.linear.x, msg.angular.z = v, w
    for _ in range(steps):
        publisher.publish(msg)
        rate.sleep()


def work():
    while started.wait():
        started.clear()
        for _ in range(4):
            send(0.2, 0.0, 20)
            send(0.0, 1.5708, 10)
            send(0.0, 0.0, 6)


rate = node.create_rate(10)
node.create_subscription(Empty, '/go_square', lambda msg: started.set(), 10)
threading.Thread(target=work, daemon=True).start()
"""

_USUAL = Exercise(
    name='square',
    task=_task(Outline()),
    subscribes={'/go_square': EMPTY},
    publishes={'/cmd_vel': TWIST},
    shared=['/cmd_vel'],
    reliable=['/cmd_vel'],
    clauses=_clauses(Outline()),
    judge=_judge(Outline()),
    hints=_hints(Outline()),
    answer=Solution(
        _SQUARE,
        'Nothing is measured here: it relies on speed and time. By odometry it would be more '
        'exact, as in the exercise before.',
    ),
    styles=[
        Style('by odometry', _BY_ODOMETRY),
        Style(
            'without commands in its pauses',
            changed(
                _SQUARE,
                ('2 * [(0.0, 0.0)]', '[(0.0, 0.0)] + 2 * [None]'),
                ('5 * [(0.0, 0.0)]', '[(0.0, 0.0)] + 4 * [None]'),
                (
                    '        v, w = self.plan.pop(0)\n',
                    '        step = self.plan.pop(0)\n        if step is None:\n'
                    '            return\n',
                ),
                ('msg.angular.z = v, w', 'msg.angular.z = step'),
            ),
        ),
        Style(
            'without a last turn',
            changed(_SQUARE, ('4 * (side + turn)', '(4 * (side + turn))[:-15]')),
        ),
        Style('a loop with a rate, in a thread', _LOOP),
        Style('own process', in_process(_SQUARE), process=True),
    ],
    wrong=[
        Wrong(
            'degrees for radians', changed(_SQUARE, ('1.5708', '90.0')), 'Its angles are degrees'
        ),
        Wrong('to the right', changed(_SQUARE, ('1.5708', '-1.5708')), 'It turns to the right'),
        Wrong('turns too little', changed(_SQUARE, ('1.5708', '1.0')), 'no right angle'),
        Wrong(
            'sides too long',
            changed(_SQUARE, ('20 *', '35 *')),
            'the side has another length',
        ),
        Wrong('three sides', changed(_SQUARE, ('4 *', '3 *')), 'The fourth side is missing'),
        Wrong(
            'forgets to stop',
            changed(
                _SQUARE,
                ('4 * (side + turn)', '3 * (side + turn) + 17 * [(0.2, 0.0)]'),
            ),
            'leaves it driving',
        ),
        first_time_only(_SQUARE, 'self.plan = 4 * (side + turn)'),
        Wrong('five sides', changed(_SQUARE, ('4 *', '5 *')), 'It goes on after the fourth side'),
        Wrong('two squares', changed(_SQUARE, ('4 *', '8 *')), 'It does not end'),
        Wrong(
            'twelve and a half commands a second',
            changed(_SQUARE, ('create_timer(0.1,', 'create_timer(0.08,')),
            'a command every 0.08 s (12.5 Hz)',
        ),
        Wrong(
            'a circle',
            changed(
                _SQUARE,
                ('20 * [(0.2, 0.0)] + 2 * [(0.0, 0.0)]', '25 * [(0.178, 0.6283)]'),
                ('10 * [(0.0, 1.5708)] + 5 * [(0.0, 0.0)]', '[(0.0, 0.0)]'),
            ),
            'The first side has another length',
        ),
        Wrong(
            'round corners',
            changed(
                _SQUARE,
                ('20 * [(0.2, 0.0)] + 2 * [(0.0, 0.0)]', '14 * [(0.2, 0.0)]'),
                ('10 * [(0.0, 1.5708)] + 5 * [(0.0, 0.0)]', '8 * [(0.15, 1.96)]'),
                ('(side + turn)', '(side + turn) + [(0.0, 0.0)]'),
            ),
            'It drives a curve',
        ),
        Wrong(
            'never ends',
            changed(
                _SQUARE,
                (
                    '        self.publisher.publish(msg)\n',
                    '        self.publisher.publish(msg)\n        self.plan.append((v, w))\n',
                ),
            ),
            'It does not end',
        ),
        Wrong(
            'says stop for ever',
            changed(
                _SQUARE,
                (
                    '            return\n',
                    '            self.publisher.publish(Twist())\n            return\n',
                ),
            ),
            'all of them stop commands',
        ),
        Wrong(
            'rests for long at its end',
            changed(_SQUARE, ('4 * (side + turn)', '4 * (side + turn) + 15 * [(0.0, 0.0)]')),
            'It stands, and still publishes.',
        ),
        Wrong(
            'too slow',
            changed(_SQUARE, ('20 * [(0.2, 0.0)]', '50 * [(0.08, 0.0)]')),
            'after the message',
        ),
        int_for_float(_SQUARE, '(0.0, 1.5708)', '(0, 1.5708)'),
    ],
)


def _variant(*, outline: tuple[float, str]) -> Exercise:
    wanted = Outline(*outline)
    code = changed(_SQUARE, ('20 * [(0.2, 0.0)]', f'{wanted.side / 0.02:.0f} * [(0.2, 0.0)]'))
    if wanted.turn == 'right':
        code = changed(code, ('1.5708', '-1.5708'))
    return replace(
        _USUAL,
        task=_task(wanted),
        clauses=_clauses(wanted),
        judge=_judge(wanted),
        hints=_hints(wanted),
        answer=Solution(code, _USUAL.answer.reason),
        styles=(),
        wrong=(),
    )


def _guess(probe: Probe) -> dict[str, Any] | None:
    evidence = Evidence(probe)
    source = evidence.publisher('/cmd_vel', evidence.subscription(SIGN).node)
    longest = max(map(Outline, SIDES), key=lambda outline: outline.side)
    trials = Trials(probe, find_robot(probe), source, (SIGN, EMPTY), longest.seconds)
    drives: list[Drive] = []
    trials.wait_until_quiet()
    trials.run(draw(longest)[:1], lambda found: None, drives)
    path = [drives[0].told(pose)[:2] for _, pose in drives[0].poses]
    if not path:
        return None
    far = max((y for _, y in path), key=abs)
    side = min(SIDES, key=lambda side: abs(side - abs(far)))
    return {'outline': (side, 'left' if far > 0 else 'right')}


square = varied(
    _USUAL,
    _variant,
    _guess,
    outline=[
        (side, turn)
        for side in SIDES
        for turn in ('left', 'right')
        if Outline(side, turn) != Outline()
    ],
)
