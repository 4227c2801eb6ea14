"""Answers to `mounted`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

TEXT = "SCOUT.replace('</robot>', CAMERA)"
SPIN = f'scout = lab.spin(RobotStatePublisher({TEXT}))\n'
IMPORT = 'from labkit.programs.robot_state_publisher import RobotStatePublisher\n'
OWN = (
    'from rclpy.node import Node\nfrom rclpy.qos import DurabilityPolicy, QoSProfile\n'
    'from std_msgs.msg import String\n'
)
NODE = f"""\
class Mounter(Node):
    def __init__(self):
        super().__init__('mounter')
        profile = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = self.create_publisher(String, 'robot_description', profile)
        text = {TEXT}
        self.publisher.publish(String(data=text))


mounter = lab.spin(Mounter())
"""
PUBLISH = '        self.publisher.publish(String(data=text))\n'

ANSWERS = [
    right('a node of its own', (IMPORT, OWN), (SPIN, NODE)),
    wrong(
        'a publisher that keeps nothing',
        'uses durability volatile',
        ("'robot_description', profile)", "'robot_description', 10)"),
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
        ("'mounter')", "'mounter', namespace='my_own')"),
        of='a node of its own',
    ),
    wrong(
        'first rightly, later wrongly',
        'It is somewhere else',
        (
            PUBLISH,
            f"{PUBLISH}        text = text.replace('0.04 0 0.03', '0.04 0 0.04')\n{PUBLISH}",
        ),
        of='a node of its own',
    ),
    wrong(
        'a link that no joint holds',
        'there is none of that name',
        ('<child link="camera_link"/>', '<child link="camera_lnk"/>'),
        outcome=ERROR,
    ),
    wrong(
        'another robot name',
        'A robot is known by its name',
        (TEXT, f"{TEXT}.replace('scout', 'scouty')"),
    ),
    wrong('a place that is nearly right', 'It is somewhere else', ('0.04 0 0.03', '0.041 0 0.03')),
    wrong(
        'another name for the neck',
        'A joint of the robot is not what it was',
        (TEXT, f"{TEXT}.replace('neck', 'nape')"),
    ),
    wrong('millimetres', 'millimetres', ('0.04 0 0.03', '40 0 30')),
    right('not spun'),
    right(
        'with a box that is seen',
        (
            '<link name="camera_link"/>',
            '<link name="camera_link"><visual><geometry>\n'
            '    <box size="0.02 0.02 0.02"/></geometry></visual></link>',
        ),
    ),
    right('another name of the joint', ('"camera_joint"', '"screws"')),
    right(
        'the joint before the link',
        ('  <link name="camera_link"/>\n', ''),
        ('</robot>\n"""', '  <link name="camera_link"/>\n</robot>\n"""'),
    ),
    right(
        'with an axis that nobody needs',
        ('<child link="camera_link"/>', '<child link="camera_link"/>\n    <axis xyz="0 0 1"/>'),
    ),
    right('one turn more', ('"0 0.349 0"', '"0 -5.934 0"')),
    right(
        'an optical frame besides',
        (
            '</robot>\n"""',
            '  <link name="camera_optical"/>\n  <joint name="optics" type="fixed">\n'
            '    <parent link="camera_link"/><child link="camera_optical"/>\n'
            '    <origin rpy="-1.5708 0 -1.5708"/></joint>\n</robot>\n"""',
        ),
    ),
]
