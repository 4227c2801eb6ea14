"""Exercise: hear a sensor that promises no more than best effort."""

from __future__ import annotations

from collections.abc import Sequence

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Answers, Matches
from labkit.exercises.draws import draw_int16s
from labkit.lessons._script import in_process, started_by_subprocess

__all__ = ['SONAR', 'millimetres']

INT16 = 'std_msgs/msg/Int16'
SONAR = '/sonar'

_CODE = """
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Int16


class Millimetres(Node):
    def __init__(self):
        super().__init__('millimetres')
        self.publisher = self.create_publisher(Int16, 'range_mm', 10)
        self.subscription = self.create_subscription(
            Int16, 'range', self.on_range, qos_profile_sensor_data
        )

    def on_range(self, msg):
        self.publisher.publish(Int16(data=10 * msg.data))


millimetres = lab.spin(Millimetres())
"""
_IMPORT = 'from rclpy.qos import qos_profile_sensor_data\n'
_PROFILE = 'self.on_range, qos_profile_sensor_data'
_POLICIES = 'from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy\n'
_NARROW = """        self.subscription = self.create_subscription(
            Int16, 'range', self.on_range, qos_profile_sensor_data
        )
"""
_DEFAULT = _NARROW.replace(
    "(\n            Int16, 'range', self.on_range, qos_profile_sensor_data\n        )",
    "(Int16, 'range', self.on_range, 10)",
)
_SECOND_SONAR = """    sonar = Node('sonar')
    sonar.create_publisher(Int16, 'range', 10)
"""


def _explain(number: int, came: Sequence[int]) -> tuple[str, str]:
    if number in came:
        return 'The number is passed on as it came.', 'Publish Int16(data=10 * msg.data).'
    if came and any(value * 10 in (number, number - number % 10) for value in came):
        return 'The number is divided by 10, and not multiplied.', '1 cm is 10 mm.'
    if (came and number * 100 in came) or number * 1000 in came:
        return 'That is not the number of millimetres.', '1 cm is 10 mm.'
    return '', ''


millimetres = Exercise(
    name='millimetres',
    task='Hear /sonar, which publishes centimetres on /range, and publish millimetres on '
    '/range_mm.',
    subscribes={'/range': INT16},
    publishes={'/range_mm': INT16},
    clauses=(
        Answers(
            '/range',
            '/range_mm',
            'for each number on `/range`, publish ten times that number on `/range_mm` (both '
            '`std_msgs/msg/Int16`), once, within a second',
            answer=lambda number: 10 * number,
            draw=lambda: draw_int16s(0, 3276),
            explain=_explain,
        ),
        Matches(
            '/range',
            SONAR,
            'the node hears `/sonar`, which stays as it is',
            start='Run the cell that starts the sonar.',
            is_as_given=lambda profile: profile.reliability.name == 'BEST_EFFORT',
        ),
    ),
    hints=[
        'What does /sonar offer, and what does a subscription with a depth alone ask for? '
        '%ros2 topic info --verbose /range',
        'A subscription that asks for best effort hears every publisher of its type.',
        'qos_profile_sensor_data, from rclpy.qos, is the last argument of create_subscription().',
    ],
    answer=Solution(
        _CODE,
        'The subscription asks for no more than the sensor offers. So it hears a reliable '
        'publisher, too.',
    ),
    styles=[
        Style(
            'functions, with a profile of its own',
            """
import rclpy
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int16

node = rclpy.create_node('converter')
publisher = node.create_publisher(Int16, '/range_mm', 10)
profile = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
node.create_subscription(
    Int16, '/range', lambda msg: publisher.publish(Int16(data=msg.data * 10)), profile
)
lab.spin(node)
""",
        ),
        Style(
            'takes what the sonar offers',
            changed(
                _CODE,
                (_IMPORT, ''),
                (
                    _NARROW,
                    '        for info in self.get_publishers_info_by_topic("range"):\n'
                    '            profile = QoSProfile(depth=5, '
                    'reliability=info.qos_profile.reliability)\n'
                    "        self.create_subscription(Int16, 'range', self.on_range, profile)\n",
                ),
                ('from std_msgs', 'from rclpy.qos import QoSProfile\nfrom std_msgs'),
                ('"range"', "'range'"),
            ),
        ),
        Style(
            'the preset by its name',
            changed(
                _CODE,
                (_IMPORT, 'from rclpy.qos import QoSPresetProfiles\n'),
                (
                    f"            Int16, 'range', {_PROFILE}\n",
                    "            Int16, 'range', self.on_range, "
                    'QoSPresetProfiles.SENSOR_DATA.value\n',
                ),
            ),
        ),
        Style('own process, started here', started_by_subprocess(in_process(_CODE))),
        Style('own process', in_process(_CODE), process=True),
    ],
    wrong=[
        Wrong(
            'the default profile',
            changed(
                _CODE,
                (_IMPORT, ''),
                (_NARROW, _DEFAULT),
            ),
            'best effort publisher and reliable subscription',
        ),
        Wrong(
            'a larger depth',
            changed(
                _CODE,
                (_IMPORT, ''),
                (
                    _NARROW,
                    "        self.subscription = self.create_subscription(Int16, 'range', "
                    'self.on_range, 1000)\n',
                ),
            ),
            'Where it asks for more than is offered, no message passes.',
        ),
        Wrong(
            'best effort, but transient local',
            changed(
                _CODE,
                (_IMPORT, _POLICIES),
                (
                    '        self.subscription',
                    '        profile = QoSProfile(\n            depth=5,\n'
                    '            reliability=ReliabilityPolicy.BEST_EFFORT,\n'
                    '            durability=DurabilityPolicy.TRANSIENT_LOCAL,\n        )\n'
                    '        self.subscription',
                ),
                (_NARROW.partition('= ')[2].strip(), 'self.create_subscription(Int16, N)'),
                ('Int16, N', "Int16, 'range', self.on_range, profile"),
            ),
            'Volatile publisher and transient local subscription',
        ),
        Wrong(
            'the publisher got the profile',
            changed(
                _CODE,
                ("'range_mm', 10)", "'range_mm', qos_profile_sensor_data)"),
                (_NARROW, _DEFAULT),
            ),
            'change that of /millimetres',
        ),
        Wrong(
            'a second sonar that is reliable',
            changed(
                in_process(_CODE),
                (_IMPORT, ''),
                (_NARROW, _DEFAULT),
                ('    rclpy.spin(', _SECOND_SONAR + '    rclpy.spin('),
            ),
            'On a robot that end belongs to somebody else',
            process=True,
        ),
        Wrong(
            'centimetres as they are',
            changed(_CODE, ('10 * msg.data', 'msg.data')),
            'The number is passed on as it came.',
        ),
        Wrong(
            'divides',
            changed(_CODE, ('10 * msg.data', 'msg.data // 10')),
            '1 cm is 10 mm.',
        ),
        Wrong(
            'a float',
            changed(_CODE, ('10 * msg.data', '10.0 * msg.data')),
            'takes values of type int',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'other topic',
            changed(_CODE, ("'range_mm', 10", "'range_mn', 10")),
            'names must be equal to the last letter',
        ),
        Wrong(
            'forgot to publish',
            changed(
                _CODE,
                ('self.publisher.publish(Int16(data=10 * msg.data))', 'self.mm = 10 * msg.data'),
            ),
            'its callback did not publish',
        ),
        Wrong(
            'near ones only',
            changed(_CODE, ('10 * msg.data', 'min(10 * msg.data, 1000)')),
            'messages were answered rightly, others not',
        ),
        Wrong(
            'not spun',
            changed(_CODE, ('lab.spin(Millimetres())', 'Millimetres()')),
            'lab.spin(node)',
        ),
        Wrong(
            'the default profile, in a process of its own',
            changed(in_process(_CODE), (_IMPORT, ''), (_NARROW, _DEFAULT)),
            'best effort publisher and reliable subscription',
            process=True,
        ),
    ],
)
