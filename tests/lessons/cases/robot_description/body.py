"""Answers to `body`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

SPIN = 'cart = lab.spin(RobotStatePublisher(CART))\n'
IMPORT = 'from labkit.programs.robot_state_publisher import RobotStatePublisher\n'
OWN = (
    'from rclpy.node import Node\nfrom rclpy.qos import DurabilityPolicy, QoSProfile\n'
    'from std_msgs.msg import String\n'
)
NODE = """\
class Designer(Node):
    def __init__(self):
        super().__init__('designer')
        profile = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = self.create_publisher(String, 'robot_description', profile)
        self.publisher.publish(String(data=CART))


designer = lab.spin(Designer())
"""
PUBLISH = '        self.publisher.publish(String(data=CART))\n'
WHEEL = (
    '      <origin rpy="1.5708 0 0"/>\n'
    '      <geometry><cylinder radius="0.05" length="0.02"/></geometry>\n'
)

ANSWERS = [
    right('a node of its own', (IMPORT, OWN), (SPIN, NODE)),
    wrong(
        'a publisher that keeps nothing',
        'uses durability volatile',
        (
            "self.create_publisher(String, 'robot_description', profile)",
            "self.create_publisher(String, 'robot_description', 10)",
        ),
        (
            '        profile = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n',
            '',
        ),
        ('from rclpy.qos import DurabilityPolicy, QoSProfile\n', ''),
        of='a node of its own',
    ),
    wrong(
        'another topic name',
        '/robot_description',
        ("'robot_description'", "'robot_descripton'"),
        of='a node of its own',
    ),
    wrong(
        'in another namespace',
        '/robot_description',
        ("'designer')", "'designer', namespace='my_own')"),
        of='a node of its own',
    ),
    wrong(
        'nothing is published',
        'it has published no description',
        (PUBLISH, ''),
        of='a node of its own',
    ),
    wrong(
        'no XML',
        'ROS refuses this text',
        ('</robot>', '</robo>'),
        of='a node of its own',
    ),
    wrong(
        'first rightly, later wrongly',
        'another size',
        (
            PUBLISH,
            f"{PUBLISH}        later = CART.replace('0.24', '0.25')\n"
            f'        self.publisher.publish(String(data=later))\n',
        ),
        of='a node of its own',
    ),
    wrong(
        'a joint without a child',
        'has no child',
        ('    <child link="caster"/>\n', ''),
        outcome=ERROR,
    ),
    wrong('another robot name', 'A robot is known by its name', ('"cart"', '"car"')),
    wrong(
        'the right wheel alone is too large',
        'right_wheel: radius = 0.052 m',
        (
            f'{WHEEL}    </visual>\n  </link>\n  <joint name="right',
            f'{WHEEL.replace("0.05", "0.052")}    </visual>\n  </link>\n  <joint name="right',
        ),
    ),
    wrong('a place that is nearly right', 'It is somewhere else', ('0.14 0', '0.141 0')),
    wrong('millimetres', 'millimetres', ('0.24 0.16 0.06', '240 160 60')),
    wrong(
        'the axis of a frame that is turned',
        'It turns about another axis',
        ('<origin xyz="0 0.09 0"/>', '<origin xyz="0 0.09 0" rpy="1.5708 0 0"/>'),
    ),
    # Nothing has to be called for what is sent once.
    right('not spun'),
    right(
        'the frames of the wheels are turned',
        ('      <origin rpy="1.5708 0 0"/>\n', ''),
        ('<origin xyz="0 0.09 0"/>', '<origin xyz="0 0.09 0" rpy="-1.5708 0 0"/>'),
        ('<origin xyz="0 -0.09 0"/>', '<origin xyz="0 -0.09 0" rpy="-1.5708 0 0"/>'),
        ('<axis xyz="0 1 0"/>', '<axis xyz="0 0 1"/>'),
    ),
    right(
        'with masses, collisions and colours',
        (
            '<link name="caster">',
            '<material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>\n'
            '  <link name="caster">\n    <inertial><mass value="0.1"/><inertia ixx="1e-4"\n'
            '      ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/></inertial>\n'
            '    <collision><geometry><sphere radius="0.02"/></geometry></collision>',
        ),
    ),
    right(
        'a camera besides',
        (
            '</robot>',
            '  <link name="camera"/><joint name="camera_joint" type="fixed">\n'
            '    <parent link="base_link"/><child link="camera"/></joint>\n</robot>',
        ),
    ),
    right('an axis that is longer than 1', ('<axis xyz="0 1 0"/>', '<axis xyz="0 2 0"/>')),
    right('turned the other way', ('1.5708 0 0', '-1.57 0 0')),
    right(
        'sends it again and again',
        (
            PUBLISH,
            '        self.create_timer(0.5, self.on_timer)\n        self.on_timer()\n\n'
            f'    def on_timer(self):\n{PUBLISH}',
        ),
        of='a node of its own',
    ),
]
