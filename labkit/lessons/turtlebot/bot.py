"""Exercise: the class Bot, which drives home by its odometry."""

from __future__ import annotations

from labkit.exercises import Exercise, Solution, Style, Wrong, changed
from labkit.lessons._script import in_process, started_by_subprocess
from labkit.lessons.turtlebot.bot_clauses import Gain, Steps, draw, tell
from labkit.lessons.turtlebot.clauses import (
    Begins,
    Hears,
    Stops,
)
from labkit.lessons.turtlebot.drive import EMPTY, ODOMETRY, TWIST
from labkit.lessons.turtlebot.judge import driven
from labkit.lessons.turtlebot.mistakes import first_time_only, int_for_float

__all__ = ['bot']

SIGN = '/go_home'
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


_CLAUSES = (
    Begins(SIGN, EMPTY),
    Hears('/odom', ODOMETRY, SIGN),
    Steps(),
    Gain(),
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
    judge=driven((SIGN, EMPTY), _CLAUSES, draw, tell, seconds=SECONDS),
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
