"""Exercise: the class Bot, which drives home by its odometry."""

from __future__ import annotations

from typing import TYPE_CHECKING

from labkit.exercises import (
    Exercise,
    Fail,
    Probe,
    Solution,
    Style,
    Wrong,
    changed,
    expect,
)
from labkit.lessons._script import in_process
from labkit.lessons.turtlebot.drawing import observed
from labkit.lessons.turtlebot.drive import (
    EMPTY,
    ODOMETRY,
    TWIST,
    Drive,
    drive,
    driver,
    expect_rate,
    expect_stop,
    is_zero,
    stands,
)
from labkit.lessons.turtlebot.mistakes import int_for_float, own_clock
from labkit.sim.kinematics import Pose, Twist2

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['bot']

STEPS = 20
HOME = (0.0, 0.0)

_BOT = """
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Empty

SIM_TIME = Parameter('use_sim_time', value=True)


class HomingBot(Node):
    def __init__(self):
        super().__init__('homing_bot', parameter_overrides=[SIM_TIME])
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


def _judge_bot(probe: Probe) -> str:
    source = driver(probe, '/go_home')
    _expect_odometry(probe, source)
    go = probe.sender('/go_home', EMPTY)
    with observed() as drives:
        for x in (0.2, -0.15):
            found = drive(
                probe,
                source,
                (x, 0.0, 0.0),
                lambda: go({}),
                until=stands(0.4),
                seconds=5.0,
                goals=[HOME],
            )
            drives.append(found)
            _judge_drive(found, x)
    return f'{STEPS} steps from x = 0.20 m to x = {drives[0].end.x:.2f} m, then stop.'


def _expect_odometry(probe: Probe, source: Endpoint) -> None:
    def hears(topic: str) -> bool:
        return source.node in {other.node for other in probe.subscriptions(topic)}

    # What another process subscribes to is seen piece by piece.
    if not probe.wait_to_appear(lambda: hears('/odom')) and hears('/cmd_vel'):
        raise Fail(
            f'{source.node} with a subscription to /odom ({ODOMETRY})',
            f'{source.node} subscribes to /cmd_vel',
            why='A Twist on /cmd_vel says how fast the robot shall be. Where it is, an Odometry '
            'on /odom tells.',
            todo="self.create_subscription(Odometry, 'odom', self.on_odometry, 10)",
        )
    expect.subscription(probe, '/odom', by=source.node)


def _judge_drive(found: Drive, x: float) -> None:
    first = found.moving[0].v if found.moving else 0.0
    expected = f'the first command near linear.x = {-x:.2f} m/s where x = {x:.2f} m: v = -x'
    if not found.moving:
        raise Fail(
            expected,
            'only commands that say stop',
            why='A robot that stands has the speed 0.0, and twist.twist in an Odometry is the '
            'speed. The place is in pose.pose.',
            todo='self.x = msg.pose.pose.position.x',
        )
    if first * x > 0:
        raise Fail(
            expected,
            f'linear.x = {first:.2f} m/s: it drives away from home',
            why='The sign is wrong. Where x is below 0 the robot has to drive forwards, where it '
            'is above 0 backwards.',
            todo='v = -x',
        )
    expect_rate(found)
    gaps = [abs(twist.v + seen.x) for (_, twist), seen in _moves(found)]
    if max(gaps) > 0.05:
        twist, seen = max(_moves(found), key=lambda item: abs(item[0][1].v + item[1].x))
        raise Fail(
            f'v = -x at every step, so linear.x = {-seen.x:.2f} m/s where x = {seen.x:.2f} m',
            f'linear.x = {twist[1].v:.2f} m/s there',
            why='The command does not follow the newest odometry.',
            todo='Let the callback keep x, and read it anew at each step.',
        )
    count = len(found.moving)
    if not STEPS - 1 <= count <= STEPS + 1:
        raise Fail(
            f'{STEPS} steps, then one stop command',
            f'{count} steps' + (' and no end' if not found.stopped else ''),
            why='The steps are not counted, or not to the right number.',
            todo='Count each step, and stop when 20 are done.',
        )
    expect_stop(found)


def _moves(found: Drive) -> list[tuple[tuple[float, Twist2], Pose]]:
    pairs = zip(found.commands, found.seen, strict=True)
    return [(command, seen) for command, seen in pairs if not is_zero(command[1])]


_LOOP = """
import threading

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.parameter import Parameter
from std_msgs.msg import Empty

node = rclpy.create_node('loop_bot', parameter_overrides=[Parameter('use_sim_time', value=True)])
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
    judge=_judge_bot,
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
        own_clock(_BOT),
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
