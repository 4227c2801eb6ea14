"""Robots as programs of their own: `ros2 run labkit turtlebot`, and nodes of a launch file."""

from collections.abc import Iterator
from math import inf
from pathlib import Path

import pytest
import rclpy

from labkit.background.domains import claim_domain
from labkit.errors import LabError
from labkit.sim.turtlebot_program import TurtlebotProgram

TWO = """\
<launch>
  <arg name="x" default="1"/>
  <node pkg="labkit" exec="turtlebot" namespace="robot1"/>
  <node pkg="labkit" exec="turtlebot" namespace="robot2">
    <param name="x" value="$(var x)"/>
  </node>
</launch>
"""


@pytest.fixture
def kernel(start_kernel) -> Iterator:
    claim = claim_domain()
    env = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_DOMAIN_ID': str(claim.domain_id)}
    kernel = start_kernel(**env)
    kernel.run('import labkit as lab')
    yield kernel
    claim.close()


@pytest.fixture
def file(tmp_path: Path) -> str:
    path = tmp_path / 'two.launch.xml'
    path.write_text(TWO, encoding='utf-8')
    return str(path)


def wait_for_text(kernel, words: str) -> None:
    """Wait until the arena says something."""
    assert not kernel.run(f'lab.wait_until(lambda: {words!r} in view.text, timeout_sec=50)').error


def test_robots_of_a_launch_stand_in_one_world(kernel, file):
    assert not kernel.run(f'robots = lab.launch({file!r})').error
    kernel.run('view = lab.arena()\ndisplay(view)')
    wait_for_text(kernel, 'Nearest obstacle 0.93 m away, ahead.')
    wait_for_text(kernel, 'robot2 at x = 1.00 m')
    assert (
        'robot1/odom'
        in kernel.run(
            'from nav_msgs.msg import Odometry\n'
            'print(lab.wait_for_message("/robot1/odom", Odometry).header.frame_id)'
        ).text
    )
    assert '  x\n' in kernel.run('%ros2 param list /robot2/turtlebot').text
    # Other nodes do not see how they know of each other.
    assert 'places' not in kernel.run('%ros2 topic list\n%ros2 node info /robot1/turtlebot').text
    # One drives away, and the other one sees it go.
    assert not kernel.run(
        'from geometry_msgs.msg import Twist\nfrom rclpy.node import Node\n'
        'pilot = lab.spin(Node("pilot"))\n'
        'commands = pilot.create_publisher(Twist, "/robot2/cmd_vel", 10)\n'
        'ahead = Twist()\nahead.linear.x = 0.2\n'
        'timer = pilot.create_timer(0.1, lambda: commands.publish(ahead))'
    ).error
    wait_for_text(kernel, 'Nearest obstacle 1.2')
    kernel.run('lab.remove(pilot)')
    # One that ends is in nobody's way any more.
    assert not kernel.run(
        'import os, signal\nos.kill(robots.processes[1].pid, signal.SIGINT)'
    ).error
    wait_for_text(
        kernel,
        'robot1 at x = 0.00 m, y = 0.00 m, heading 0°. It stands. Nearest '
        'obstacle 1.81 m away, 124° to the right.',
    )


@pytest.mark.slow('starts other processes')
def test_one_robot_by_ros2_run(kernel):
    said = kernel.run('%ros2 run labkit turtlebot --ros-args -r __ns:=/robot1 -p y:=-1.0').text
    assert 'as node /robot1/turtlebot. lab.processes() lists' in said and 'installed' not in said
    text = kernel.run('print(lab.arena())').text
    assert text.startswith('robot1 at x = 0.00 m, y = -1.00 m')
    # Why it stands is known from another process, too.
    kernel.run(
        'view = lab.arena()\ndisplay(view)\n'
        '%ros2 topic pub --once /robot1/cmd_vel geometry_msgs/msg/Twist "{linear: {x: 0.1}}"'
    )
    wait_for_text(kernel, 'It stands: no command for 1 s; its time limit for commands has stopped')


@pytest.mark.parametrize(
    ('said', 'limit'), [((), 1.0), (('command_timeout:=2',), 2.0), (('command_timeout:=0',), inf)]
)
def test_its_command_timeout_is_a_parameter(said, limit):
    rclpy.init(args=['--ros-args', *(word for one in said for word in ('-p', one))])
    try:
        robot = TurtlebotProgram()
        assert robot.simulator.command_timeout == limit
        robot.destroy_node()
    finally:
        rclpy.shutdown()


def test_a_command_timeout_without_sense_is_told():
    rclpy.init(args=['--ros-args', '-p', 'command_timeout:=-1'])
    try:
        with pytest.raises(LabError, match=r'command_timeout must be .* but it is -1'):
            TurtlebotProgram()
    finally:
        rclpy.shutdown()


@pytest.mark.slow('a launch that ends')
@pytest.mark.parametrize(
    ('value', 'words'), [('9', 'x=9.0, y=0.0 is outside of it.'), ('far', "but it is 'far'.")]
)
def test_a_start_that_is_none_is_told(kernel, file, value, words):
    kernel.run(f'robots = lab.launch({file!r}, x={value!r})')
    code = 'lab.wait_until(lambda: robots.processes[1].exit_code is not None, timeout_sec=50)'
    assert not kernel.run(code).error
    assert words in kernel.run('print(*robots.output, sep="\\n")').text
    assert kernel.run('print(robots.processes)').text.endswith('ended (exit code 1)]\n')
