"""Exercise: a node that computes how far a robot has driven, whoever publishes its odometry."""

from __future__ import annotations

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Subscribes
from labkit.lessons._script import in_process
from labkit.lessons.bags.distance_clauses import (
    FLOAT64,
    INNER,
    ODOMETRY,
    OUTER,
    NoJumps,
    SumOfSteps,
)

__all__ = ['distance']


_NODE = """
import math

from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import Float64


class Distance(Node):
    def __init__(self):
        super().__init__('distance')
        self.publisher = self.create_publisher(Float64, 'distance', 10)
        self.subscription = self.create_subscription(Odometry, 'odom', self.on_odometry, 10)
        self.last = None
        self.total = 0.0

    def on_odometry(self, msg):
        position = msg.pose.pose.position
        place = (position.x, position.y)
        if self.last is not None:
            step = math.dist(self.last, place)
            if step < 0.5:
                self.total += step
        self.last = place
        self.publisher.publish(Float64(data=self.total))


distance = lab.spin(Distance())
"""
_STEP = '            step = math.dist(self.last, place)\n'
_IF = '            if step < 0.5:\n                self.total += step\n'


distance = Exercise(
    name='distance',
    task='Tell how far a robot has driven, from its odometry or from a bag of it.',
    publishes={OUTER: FLOAT64},
    subscribes={INNER: ODOMETRY},
    clauses=[Subscribes(INNER, ODOMETRY), SumOfSteps(), NoJumps()],
    hints=[
        'Keep two things in the node: the place of the last message, and the sum.',
        'At the first message there is no last place yet: begin with self.last = None.',
        'math.dist((x1, y1), (x2, y2)) is the length of a step. Compare it with 0.5 before you '
        'add it.',
    ],
    answer=Solution(
        _NODE,
        'The node keeps the last place, adds each step, and leaves out jumps. It need not know '
        'whether a robot publishes, or a bag.',
    ),
    styles=[
        Style('own process', in_process(_NODE), process=True),
        Style(
            'hypot',
            changed(
                _NODE,
                (
                    _STEP,
                    '            dx, dy = place[0] - self.last[0], place[1] - self.last[1]\n'
                    '            step = math.hypot(dx, dy)\n',
                ),
            ),
        ),
        Style(
            'numpy',
            changed(
                _NODE,
                ('import math\n\n', 'import numpy as np\n'),
                ('place = (position.x, position.y)', 'place = np.array([position.x, position.y])'),
                ('math.dist(self.last, place)', 'float(np.linalg.norm(place - self.last))'),
            ),
        ),
        Style(
            'list of places',
            changed(
                _NODE,
                (
                    '        self.last = None\n        self.total = 0.0\n',
                    '        self.places = []\n',
                ),
                (
                    '        place = (position.x, position.y)\n'
                    '        if self.last is not None:\n'
                    + _STEP
                    + _IF
                    + '        self.last = place\n'
                    '        self.publisher.publish(Float64(data=self.total))\n',
                    '        self.places.append((position.x, position.y))\n'
                    '        steps = map(math.dist, self.places, self.places[1:])\n'
                    '        total = sum(step for step in steps if step < 0.5)\n'
                    '        self.publisher.publish(Float64(data=float(total)))\n',
                ),
            ),
        ),
        Style(
            'function',
            """
import math

from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import Float64

node = lab.spin(Node('distance'))
publisher = node.create_publisher(Float64, '/distance', 10)
state = {'last': None, 'total': 0.0}


def on_odometry(msg):
    place = (msg.pose.pose.position.x, msg.pose.pose.position.y)
    step = math.dist(state['last'] or place, place)
    state['last'] = place
    state['total'] += step if step < 0.5 else 0.0
    publisher.publish(Float64(data=state['total']))


node.create_subscription(Odometry, '/odom', on_odometry, 10)
""",
        ),
    ],
    wrong=[
        Wrong(
            'straight line',
            changed(
                _NODE,
                (
                    _STEP + _IF,
                    '            self.total = math.dist(self.first, place)\n',
                ),
                (
                    '        self.last = place\n',
                    '        else:\n            self.first = place\n        self.last = place\n',
                ),
            ),
            'It is the straight line to where the robot is now.',
        ),
        Wrong(
            'x alone',
            changed(_NODE, ('math.dist(self.last, place)', 'abs(place[0] - self.last[0])')),
            'Only x is counted.',
        ),
        Wrong(
            'x and y added',
            changed(
                _NODE,
                (
                    'math.dist(self.last, place)',
                    'abs(place[0] - self.last[0]) + abs(place[1] - self.last[1])',
                ),
            ),
            'The robot drives the diagonal of the two.',
        ),
        Wrong(
            'a limit that is too high',
            changed(_NODE, ('step < 0.5', 'step < 1.0')),
            'The jump was counted',
        ),
        Wrong(
            'a limit that is too low',
            changed(_NODE, ('step < 0.5', 'step < 0.4')),
            'Steps before this one were counted, and this one is not.',
        ),
        Wrong(
            'no root',
            changed(_NODE, ('math.dist(self.last, place)', 'math.dist(self.last, place) ** 2')),
            'The root is missing.',
        ),
        Wrong(
            'the last step alone',
            changed(_NODE, ('self.total += step', 'self.total = step')),
            'What is published is the last step alone',
        ),
        Wrong(
            'never renews the last place',
            changed(
                _NODE,
                (
                    '        self.last = place\n',
                    '        else:\n            self.last = place\n',
                ),
                ('step < 0.5', 'step < 5'),
            ),
            'the last place is never renewed',
        ),
        Wrong(
            'counts jumps',
            changed(_NODE, (_IF, '            self.total += step\n')),
            'The jump was counted as if the robot had driven it.',
        ),
        Wrong(
            'begins anew at a jump',
            changed(_NODE, (_IF, _IF + '            else:\n                self.total = 0.0\n')),
            'The sum begins anew at the jump.',
        ),
        Wrong(
            'from the origin',
            changed(
                _NODE,
                ('        self.last = place\n', '        self.last = (0.0, 0.0)\n'),
                ('step < 0.5', 'step < 50'),
            ),
            'The way from (0, 0) is added each time.',
        ),
        Wrong(
            'publishes only when something is added',
            changed(
                _NODE,
                (
                    '        self.publisher.publish(Float64(data=self.total))\n',
                    '',
                ),
                (
                    '                self.total += step\n',
                    '                self.total += step\n'
                    '                self.publisher.publish(Float64(data=self.total))\n',
                ),
            ),
            'Some messages are not answered.',
        ),
        Wrong(
            'publishes twice',
            changed(
                _NODE,
                (
                    '        self.publisher.publish(Float64(data=self.total))\n',
                    '        self.publisher.publish(Float64(data=self.total))\n'
                    '        self.publisher.publish(Float64(data=self.total))\n',
                ),
            ),
            'More is published than answers.',
        ),
        Wrong(
            'does not publish',
            changed(_NODE, ('        self.publisher.publish(Float64(data=self.total))\n', '')),
            'The callback does not publish.',
        ),
        Wrong(
            'no place at first',
            changed(_NODE, ('        if self.last is not None:\n', '        if True:\n')),
            'NoneType',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'begins at 1',
            changed(_NODE, ('self.total = 0.0', 'self.total = 1.0')),
            'The sum does not begin at 0.0',
        ),
        Wrong(
            'listens elsewhere',
            changed(_NODE, ("Odometry, 'odom'", "Odometry, 'odometry'")),
            '/odometry',
        ),
        Wrong(
            'another topic',
            changed(_NODE, ("Float64, 'distance'", "Float64, 'distances'")),
            '/distances',
        ),
    ],
)
