"""The robot as a ROS node: its topics, what they say, and its warnings."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest
import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import BatteryState, Imu, LaserScan
from std_msgs.msg import Float64

from labkit.errors import LabError
from labkit.sim.kinematics import Pose, yaw_from_quaternion
from labkit.sim.robots import BURGER
from labkit.sim.turtlebot import Turtlebot
from labkit.sim.world import Post, Wall, World, open_field, playground
from tests.stage import Stage, twist, yaw_of


def test_topics_types_and_qos_are_those_of_the_real_robot(stage: Stage) -> None:
    robot = stage.robot()
    reliable, best_effort = ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT
    expected = {
        '/odom': ('nav_msgs/msg/Odometry', reliable),
        '/joint_states': ('sensor_msgs/msg/JointState', reliable),
        '/imu': ('sensor_msgs/msg/Imu', reliable),
        '/battery_state': ('sensor_msgs/msg/BatteryState', reliable),
        '/scan': ('sensor_msgs/msg/LaserScan', best_effort),
    }
    for topic, (kind, reliability) in expected.items():
        (info,) = robot.get_publishers_info_by_topic(topic)
        assert info.topic_type == kind
        assert info.qos_profile.reliability == reliability
        assert info.qos_profile.durability == DurabilityPolicy.VOLATILE
    (info,) = robot.get_subscriptions_info_by_topic('/cmd_vel')
    assert info.topic_type == 'geometry_msgs/msg/Twist'
    assert info.qos_profile.reliability == reliable
    assert robot.count_publishers('/clock') == 0


def test_messages_hold_what_the_real_robot_would_say(stage: Stage) -> None:
    robot = stage.robot(x=0.5, y=-0.25, yaw=1.0)
    driver = stage.driver()
    stage.until(lambda: driver.odometry and driver.joints and driver.scans)
    odometry, joints, scan = driver.odometry[0], driver.joints[0], driver.scans[0]
    assert (odometry.header.frame_id, odometry.child_frame_id) == ('odom', 'base_footprint')
    assert odometry.pose.pose.position.x == 0.5
    assert odometry.pose.pose.position.y == -0.25
    assert yaw_of(odometry) == pytest.approx(1.0)
    assert odometry.pose.covariance[0] > 0
    assert odometry.twist.covariance[35] > 0
    assert joints.header.frame_id == 'base_link'
    assert list(joints.name) == ['wheel_left_joint', 'wheel_right_joint']
    assert scan.header.frame_id == 'base_scan'
    assert len(scan.ranges) == 360
    assert scan.angle_min == 0
    assert scan.angle_min + 359 * scan.angle_increment == pytest.approx(scan.angle_max)
    assert 360 * scan.angle_increment == pytest.approx(math.tau)
    assert (scan.range_min, scan.range_max) == pytest.approx((0.12, 3.5))
    assert list(scan.ranges) == pytest.approx(robot.simulator.scan())
    stamps = [message.header.stamp.sec for message in (odometry, joints, scan)]
    assert all(stamp > 1e9 for stamp in stamps), 'real time, as the system clock has it'


def test_that_its_timeout_has_stopped_it_is_said_to_those_who_come_later(stage: Stage) -> None:
    robot = stage.robot(namespace='robot1', command_timeout=0.25, speed=10)
    stage.driver('robot1').commands.publish(twist(0.2))
    stage.until(lambda: robot.timed_out and robot.twist.v == 0)
    heard: list[Float64] = []
    listener = stage.add(Node('listener'))
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    listener.create_subscription(Float64, '/robot1/_command_timed_out', heard.append, latched)
    stage.until(lambda: heard)
    robot.place()
    stage.until(lambda: len(heard) == 2)
    assert [message.data for message in heard] == [0.25, 0.0]


def test_the_imu_feels_the_drive(stage: Stage) -> None:
    robot = stage.robot(world=open_field(), lockstep=0.02, yaw=1.0, drift=0.1)
    driver = stage.driver()
    felt: list[Imu] = []
    driver.create_subscription(Imu, '/imu', felt.append, 10)
    stage.until(lambda: robot.count_subscribers('/imu') == 1)
    stage.command(driver, 0.2, 1.0)
    stage.until(lambda: len(felt) == 1)
    start = felt[0]
    assert start.header.frame_id == 'imu_link'
    assert (start.header.stamp.sec, start.header.stamp.nanosec) == (0, 20_000_000)
    # The drive speeds up: 2.5 m/s² and 3.2 rad/s².
    assert start.linear_acceleration.x == pytest.approx(2.5)
    assert start.angular_velocity.z == pytest.approx(0.064)
    stage.command(driver, 0.2, 1.0, count=20)
    stage.until(lambda: len(felt) == 21)
    curve = felt[-1]
    assert curve.angular_velocity.z == 1.0
    assert curve.linear_acceleration.x == 0.0
    assert curve.linear_acceleration.y == pytest.approx(0.2)
    assert curve.linear_acceleration.z == 9.80665
    turn = curve.orientation
    # In truth, not as the drifting odometry believes.
    assert yaw_from_quaternion(turn.x, turn.y, turn.z, turn.w) == pytest.approx(robot.pose.yaw)
    assert robot.simulator.odometry.yaw != pytest.approx(robot.pose.yaw, abs=1e-3)
    stage.command(driver, 0.0, 0.0, count=30)
    stage.until(lambda: len(felt) == 51)
    rest = felt[-1]
    assert rest.linear_acceleration.x == rest.linear_acceleration.y == 0.0
    assert rest.linear_acceleration.z == 9.80665


def test_the_battery_falls_with_simulated_time(stage: Stage) -> None:
    robot = stage.robot(lockstep=60.0)
    driver = stage.driver()
    seen: list[BatteryState] = []
    driver.create_subscription(BatteryState, '/battery_state', seen.append, 10)
    stage.until(lambda: robot.count_subscribers('/battery_state') == 1)
    stage.command(driver, 0.0, 0.0)
    stage.until(lambda: len(seen) == 1)
    assert seen[0].percentage == pytest.approx(100 * (1 - 60 / 9000))
    assert seen[0].voltage == pytest.approx(12.3 - 1.8 * 60 / 9000)
    assert seen[0].design_capacity == pytest.approx(1.8)
    assert seen[0].present
    robot.simulator.step(10_000.0)
    stage.command(driver, 0.0, 0.0)
    stage.until(lambda: len(seen) == 2)
    assert (seen[1].percentage, seen[1].voltage) == (0.0, 10.5)


def test_the_scanner_may_say_zero_for_nothing_as_a_real_one(stage: Stage) -> None:
    # A wall behind the scanner, too near for it, one within its range, and nothing elsewhere.
    walls = [Wall(-0.12, -0.001, -0.12, 0.001), Wall(1.0, -0.1, 1.0, 0.1)]
    seen: dict[str, list[float]] = {}
    for name, options in (('rep', {}), ('real', {'scan_nothing': 0.0})):
        stage.robot(namespace=name, world=World(walls), lockstep=0.1, **options)
        driver = stage.driver(name)
        stage.command(driver, 0.0, 0.0)
        stage.until(lambda driver=driver: driver.scans)
        seen[name] = list(driver.scans[-1].ranges)
    rep, real = seen['rep'], seen['real']
    assert rep[0] == real[0] == pytest.approx(1.032)
    assert (rep[90], rep[180]) == (math.inf, -math.inf)
    assert (real[90], real[180]) == (0.0, 0.0)
    assert [one if math.isfinite(one) else 0.0 for one in rep] == real


def test_a_number_that_is_none_is_seen_on_the_topic(stage: Stage) -> None:
    robot = stage.robot(lockstep=0.1)
    driver = stage.driver()
    listener = stage.add(Node('listener'))
    commands: list[Twist] = []
    listener.create_subscription(Twist, '/cmd_vel', commands.append, 10)
    stage.until(lambda: driver.commands.get_subscription_count() == 2)
    stage.command(driver, math.nan, 0.5)
    stage.until(lambda: commands)
    assert math.isnan(commands[0].linear.x)
    assert commands[0].angular.z == 0.5
    assert robot.twist == (0.0, 0.0)


def test_it_drives_in_real_time_and_stops_when_commands_stop(stage: Stage) -> None:
    stage.robot()
    driver = stage.driver()
    driver.create_timer(0.1, lambda: driver.commands.publish(twist(0.2, 0.5)))
    stage.until(lambda: driver.odometry and driver.odometry[-1].pose.pose.position.x > 0.1)
    assert yaw_of(driver.odometry[-1]) > 0
    # On a busy machine the last command may just have run out.
    stage.until(lambda: driver.odometry[-1].twist.twist.linear.x == 0.2)
    for timer in driver.timers:
        timer.cancel()
    stage.until(lambda: driver.odometry[-1].twist.twist == Twist())
    count = len(driver.odometry)
    stage.until(lambda: len(driver.odometry) > count + 3)
    assert driver.odometry[-1].pose == driver.odometry[-3].pose
    assert not driver.warnings


@pytest.mark.slow('waits in real time')
def test_real_time_keeps_the_rates(stage: Stage) -> None:
    stage.robot()
    driver = stage.driver()
    stage.until(lambda: len(driver.scans) >= 4)
    driver.odometry.clear()
    driver.scans.clear()
    stage.until(lambda: len(driver.odometry) >= 60)
    # A busy machine may lose rounds, never invent them.
    assert 8 <= len(driver.scans) <= 22
    assert len(driver.joints) >= 60


def test_nonsense_is_refused_with_one_warning_and_the_robot_stands(stage: Stage) -> None:
    robot = stage.robot(lockstep=0.1)
    driver = stage.driver()
    stage.command(driver, 0.1, 0.0, count=5)
    for bad in (math.nan, math.inf, 1e300):
        stage.command(driver, bad, 0.0, count=3)
    sideways = twist(0.1)
    sideways.linear.y = math.nan
    driver.commands.publish(sideways)
    assert robot.twist == (0.0, 0.0)
    stage.until(lambda: driver.warnings)
    assert driver.warnings == ['Refused a command without sense: linear.x=nan. Stopping.']
    stage.command(driver, 0.1, 0.0)
    stage.command(driver, 0.0, -math.inf)
    stage.until(lambda: len(driver.warnings) == 2)
    assert 'angular.z=-inf' in driver.warnings[1]


def test_what_two_wheels_cannot_do_is_said_once(stage: Stage) -> None:
    robot = stage.robot(lockstep=0.5)
    driver = stage.driver()
    sideways = twist(1.0)
    sideways.linear.y = 0.5
    for count in range(1, 4):
        driver.commands.publish(sideways)
        stage.until(lambda count=count: robot.simulator.time == pytest.approx(0.5 * count))
    stage.until(lambda: len(driver.warnings) >= 2)
    assert len(driver.warnings) == 2
    assert 'linear.y' in driver.warnings[0]
    assert '0.22 m/s' in driver.warnings[1]
    assert robot.pose.y == 0
    assert robot.twist.v == 0.22


def test_a_wall_stops_it_with_one_warning(stage: Stage) -> None:
    robot = stage.robot(world=World([Wall(0.3, -1, 0.3, 1)]), lockstep=0.1)
    driver = stage.driver()
    stage.command(driver, 0.2, 0.0, count=30)
    stage.until(lambda: driver.warnings)
    assert driver.odometry[-1].pose.pose.position.x == pytest.approx(0.3 - BURGER.radius)
    assert driver.odometry[-1].twist.twist.linear.x == 0
    (contact,) = robot.collisions
    assert contact.thing == Wall(0.3, -1, 0.3, 1)
    assert len(driver.warnings) == 1
    assert 'Bumped into a wall at x=0.30 m, y=0.00 m' in driver.warnings[0]


def test_robots_share_a_world_by_namespace(stage: Stage) -> None:
    world = open_field()
    stage.robot(namespace='one', world=world, lockstep=0.1)
    stage.robot(namespace='two', world=world, x=1.0, yaw=math.pi, lockstep=0.1)
    driver = stage.driver('one')
    stage.command(driver, 0.2, 0.0, count=60)
    odometry = driver.odometry[-1]
    assert (odometry.header.frame_id, odometry.child_frame_id) == (
        'one/odom',
        'one/base_footprint',
    )
    assert odometry.pose.pose.position.x == pytest.approx(1 - 2 * BURGER.radius)
    stage.until(lambda: driver.scans and driver.scans[-1].ranges[0] < 0.2)
    stage.until(lambda: driver.warnings)
    assert 'an obstacle' in driver.warnings[0]


def test_it_leaves_its_world_when_it_is_destroyed() -> None:
    rclpy.init()
    world = playground()
    robot = Turtlebot(world=world)
    assert len(world.robots) == 1
    robot.destroy_node()
    assert not world.robots
    rclpy.shutdown()


def test_place_puts_it_back(stage: Stage) -> None:
    robot = stage.robot(lockstep=0.5)
    driver = stage.driver()
    stage.command(driver, 0.2, 0.2, count=3)
    assert robot.pose.x > 0.2
    robot.place(0.1, 0.2, -1.0)
    stage.command(driver, 0.0, 0.0)
    assert robot.pose == Pose(0.1, 0.2, -1.0)
    assert yaw_of(driver.odometry[-1]) == pytest.approx(-1.0)
    with pytest.raises(LabError, match='room around it'):
        robot.place(2.5)


@pytest.mark.parametrize(
    ('place', 'words'),
    [
        ((2.6, 0.0, 0.0), r'from x=-2.5 to 2.5 m and from y=-2.5 to 2.5 m, but x=2.6, y=0.0'),
        ((0.0, -7.0, 0.0), 'is outside of it'),
        ((1e300, 0.0, 0.0), 'is outside of it'),
        ((2.5, 0.0, 0.0), 'next wall or post is 0.000 m away'),
        ((1.6, 1.6, 0.0), 'next wall or post is 0.000 m away'),
        ((math.nan, 0.0, 0.0), 'finite numbers'),
        ((0.0, math.inf, 0.0), 'finite numbers'),
        ((0.0, 0.0, -math.inf), 'finite numbers'),
    ],
)
def test_a_place_without_room_is_refused_and_the_robot_stays(
    stage: Stage, place: tuple[float, float, float], words: str
) -> None:
    robot = stage.robot(lockstep=0.5, x=0.5)
    driver = stage.driver()
    stage.command(driver, 0.2, 0.0)
    before = robot.pose, robot.twist
    with pytest.raises(LabError, match=words):
        robot.place(*place)
    assert (robot.pose, robot.twist) == before
    with pytest.raises(LabError, match=words):
        Turtlebot(name='other', x=place[0], y=place[1], yaw=place[2])


@pytest.mark.parametrize(
    ('options', 'words'),
    [
        ({'speed': 0.0}, 'speed must be'),
        ({'speed': math.nan}, 'speed must be'),
        ({'speed': 1e6}, 'speed must be'),
        ({'lockstep': 0.0}, 'lockstep must be'),
        ({'lockstep': math.inf}, 'lockstep must be'),
        ({'lockstep': 0.1, 'speed': 2.0}, 'exclude'),
        ({'use_sim_time': True, 'speed': 2.0}, 'exclude'),
        ({'scan_nothing': 3.5}, 'scan_nothing must be inf or 0.0'),
        ({'scan_nothing': math.nan}, 'scan_nothing must be inf or 0.0'),
        ({'x': 10.0, 'world': World([], [Post(10.0, 0.0, 1.0)])}, 'room around it'),
    ],
)
def test_arguments_without_sense_are_refused(options: dict[str, Any], words: str) -> None:
    with pytest.raises(LabError, match=words):
        Turtlebot(**options)


def test_in_a_notebook_the_cell_may_be_run_again(kernel: Any) -> None:
    setup = kernel.run(
        'import labkit as lab\n'
        'from labkit.sim.world import playground\n'
        'from nav_msgs.msg import Odometry\n'
        'world = playground()'
    )
    assert not setup.error
    for _ in range(3):
        result = kernel.run('robot = lab.spin(lab.Turtlebot(world=world, x=0.5))')
        assert not result.error, result.traceback
    result = kernel.run(
        'heard = lab.listen("/odom", Odometry, count=3)\n'
        'print(heard[-1].pose.pose.position.x, len(world.robots))\n'
        'print([name for name in robot.get_node_names() if name == "turtlebot"])'
    )
    assert (result.error, result.text) == ('', "0.5 1\n['turtlebot']\n")


def test_without_ros_started_it_starts_ros(script: Callable[..., Any]) -> None:
    done = script(
        'import labkit as lab\n'
        'robot = lab.Turtlebot(lockstep=0.1)\n'
        'lab.spin(robot)\n'
        'print(robot.get_name(), robot.pose)\n'
    )
    assert done.stdout == 'turtlebot Pose(x=0.0, y=0.0, yaw=0.0)\n', done.stderr
    assert done.exit_code == 0


def test_qos_of_a_careless_subscriber_hears_no_scan(stage: Stage) -> None:
    # As on the real robot: a reliable subscription and a best-effort publisher don't match.
    robot = stage.robot()
    careless = stage.add(Node('careless'))
    heard: list[LaserScan] = []
    careless.create_subscription(LaserScan, '/scan', heard.append, QoSProfile(depth=10))
    driver = stage.driver()
    stage.until(lambda: len(driver.scans) >= 3)
    assert not heard
    assert robot.count_subscribers('/scan') == 2


def test_a_robot_of_jazzy_takes_stamped_commands(stage: Stage) -> None:
    robot = stage.robot(stamped=True, lockstep=0.1)
    driver = stage.add(Node('stamped_driver'))
    commands = driver.create_publisher(TwistStamped, 'cmd_vel', 10)
    stage.until(lambda: commands.get_subscription_count() == 1)
    commands.publish(TwistStamped(twist=twist(0.1, 0.0)))
    stage.until(lambda: robot.pose.x > 0)
    assert 0 < robot.pose.x <= 0.01
