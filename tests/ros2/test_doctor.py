"""`ros2 doctor` on nodes of this process."""

from __future__ import annotations

from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import String

import labkit
from labkit.ros2.shell import run_line


def test_doctor_finds_ends_that_do_not_match(capsys):
    lamp = labkit.spin(Node('lamp'))
    lamp.create_publisher(String, '/fast', qos_profile_sensor_data)
    lamp.create_subscription(String, '/fast', print, 10)
    lamp.create_publisher(String, '/chatter', 10)
    lamp.create_subscription(String, '/chatter', print, 10)
    assert run_line('doctor') == 1
    shown = capsys.readouterr()
    assert shown.err.endswith(
        "UserWarning: ERROR: QoS compatibility error found on topic '/fast': "
        'Best effort publisher and reliable subscription;\n'
    )
    assert shown.out.endswith('Failed modules: middleware\n')
    assert run_line('doctor --report') == 0
    report = capsys.readouterr().out
    pairs = [line.split(': ', 1)[1] for line in report.splitlines() if 'compatibility st' in line]
    assert pairs == ['OK', 'ERROR: Best effort publisher and reliable subscription;']
    told = {
        line.partition(':')[0].rstrip(): line.partition(': ')[2] for line in report.splitlines()
    }
    assert told['topic [type]'] == '/fast [std_msgs/msg/String]'
    assert (told['publisher node'], told['subscriber node']) == ('lamp', 'lamp')
