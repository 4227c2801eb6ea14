"""Answers to `millimetres`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'the default profile',
        'best effort publisher and reliable subscription',
        ('from rclpy.qos import qos_profile_sensor_data\n', ''),
        (
            '        self.subscription = self.create_subscription(\n'
            "            Int16, 'range', self.on_range, qos_profile_sensor_data\n"
            '        )\n',
            "        self.subscription = self.create_subscription(Int16, 'range', "
            'self.on_range, 10)\n',
        ),
    ),
    wrong(
        'a larger depth',
        'Where it asks for more than is offered, no message passes.',
        ('from rclpy.qos import qos_profile_sensor_data\n', ''),
        (
            '        self.subscription = self.create_subscription(\n'
            "            Int16, 'range', self.on_range, qos_profile_sensor_data\n"
            '        )\n',
            "        self.subscription = self.create_subscription(Int16, 'range', "
            'self.on_range, 1000)\n',
        ),
    ),
    wrong(
        'best effort, but transient local',
        'Volatile publisher and transient local subscription',
        (
            'from rclpy.qos import qos_profile_sensor_data\n',
            'from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy\n',
        ),
        (
            '        self.subscription',
            '        profile = QoSProfile(\n            depth=5,\n'
            '            reliability=ReliabilityPolicy.BEST_EFFORT,\n'
            '            durability=DurabilityPolicy.TRANSIENT_LOCAL,\n        )\n'
            '        self.subscription',
        ),
        (
            'self.create_subscription(\n'
            "            Int16, 'range', self.on_range, qos_profile_sensor_data\n"
            '        )',
            'self.create_subscription(Int16, N)',
        ),
        ('Int16, N', "Int16, 'range', self.on_range, profile"),
    ),
    wrong(
        'the publisher got the profile',
        'change that of /millimetres',
        ("'range_mm', 10)", "'range_mm', qos_profile_sensor_data)"),
        (
            '        self.subscription = self.create_subscription(\n'
            "            Int16, 'range', self.on_range, qos_profile_sensor_data\n"
            '        )\n',
            "        self.subscription = self.create_subscription(Int16, 'range', "
            'self.on_range, 10)\n',
        ),
    ),
    wrong(
        'a second sonar that is reliable',
        'On a robot that end belongs to somebody else',
        run='process',
    ),
    wrong(
        'a float', 'takes values of type int', ('10 * msg.data', '10.0 * msg.data'), outcome=ERROR
    ),
    wrong('another topic', 'names must be equal to the last letter'),
    wrong(
        'forgot to publish',
        'its callback did not publish',
        ('self.publisher.publish(Int16(data=10 * msg.data))', 'self.mm = 10 * msg.data'),
    ),
    wrong(
        'near ones only',
        'messages were answered correctly, the others were not',
        ('10 * msg.data', 'min(10 * msg.data, 1000)'),
    ),
    wrong(
        'the default profile, in a process of its own',
        'best effort publisher and reliable subscription',
        ('from rclpy.qos import qos_profile_sensor_data\n', ''),
        (
            '        self.subscription = self.create_subscription(\n'
            "            Int16, 'range', self.on_range, qos_profile_sensor_data\n"
            '        )\n',
            "        self.subscription = self.create_subscription(Int16, 'range', "
            'self.on_range, 10)\n',
        ),
        run='process',
    ),
    wrong('wrong type', 'Use the same type on both sides', outcome=ERROR),
    right('functions, with a profile of its own'),
    right(
        'takes what the sonar offers',
        ('from rclpy.qos import qos_profile_sensor_data\n', ''),
        (
            '        self.subscription = self.create_subscription(\n'
            "            Int16, 'range', self.on_range, qos_profile_sensor_data\n"
            '        )\n',
            '        for info in self.get_publishers_info_by_topic("range"):\n'
            '            profile = QoSProfile(depth=5, '
            'reliability=info.qos_profile.reliability)\n'
            "        self.create_subscription(Int16, 'range', self.on_range, profile)\n",
        ),
        ('from std_msgs', 'from rclpy.qos import QoSProfile\nfrom std_msgs'),
        ('"range"', "'range'"),
    ),
    right(
        'the preset by its name',
        (
            'from rclpy.qos import qos_profile_sensor_data\n',
            'from rclpy.qos import QoSPresetProfiles\n',
        ),
        (
            "            Int16, 'range', self.on_range, qos_profile_sensor_data\n",
            "            Int16, 'range', self.on_range, QoSPresetProfiles.SENSOR_DATA.value\n",
        ),
    ),
]
