"""The robot says where its parts are, on /tf and /tf_static, when somebody wants to know."""

from __future__ import annotations

import math
from typing import Any

import pytest
from builtin_interfaces.msg import Time as Stamp
from geometry_msgs.msg import PointStamped
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.time import Time
from std_msgs.msg import String

from labkit.descriptions.forward_kinematics import link_transforms
from labkit.descriptions.links_and_joints import Cylinder, Sphere
from labkit.descriptions.urdf import examine, read
from labkit.packages import built_types
from labkit.sim import turtlebot
from labkit.sim.camera import PI_CAMERA
from labkit.sim.kinematics import Pose
from labkit.sim.parts import description, footprint, static_parts, urdf, wheel_parts
from labkit.sim.robots import BURGER
from labkit.sim.simulator import Simulator
from labkit.sim.world import open_field
from labkit.transforms import tf2_geometry_msgs
from labkit.transforms.buffer import Buffer
from labkit.transforms.buffer_core import BufferCore
from labkit.transforms.transform_listener import TransformListener
from tests.stage import Stage, twist

# A first build of the type takes seconds of processor time.
pytestmark = pytest.mark.timeout(900)


def where(
    robot: Simulator, frame: str, point: tuple[float, float, float], prefix: str = ''
) -> Any:
    """Return where a point of one frame is in odom."""
    buffer = BufferCore()
    for transform in static_parts(Stamp(sec=1), prefix):
        buffer.set_transform_static(transform, 'the test')
    stamp = Stamp(sec=1)
    for transform in (footprint(robot, stamp, prefix), *wheel_parts(robot, stamp, prefix)):
        buffer.set_transform(transform, 'the test')
    asked = PointStamped()
    asked.point.x, asked.point.y, asked.point.z = point
    found = buffer.lookup_transform_core(f'{prefix}odom', prefix + frame, Time())
    moved = tf2_geometry_msgs.do_transform_point(asked, found).point
    return pytest.approx((moved.x, moved.y, moved.z), abs=2e-3)


def test_parts_are_where_the_simulation_has_them() -> None:
    robot = Simulator(open_field(), start=Pose(1.0, 2.0, math.pi / 2))
    assert where(robot, 'base_footprint', (0.0, 0.0, 0.0)) == (1.0, 2.0, 0.0)
    assert where(robot, 'base_scan', (0.0, 0.0, 0.0)) == (1.0, 2.0 + BURGER.scan_x, 0.182)
    eye = (1.0, 2.0 + PI_CAMERA.x, PI_CAMERA.z)
    assert where(robot, 'camera_link', (0.0, 0.0, 0.0)) == eye
    # Of the camera z is ahead, x to the right, y down.
    ahead = (1.0, 2.0 + PI_CAMERA.x + 1.0, PI_CAMERA.z)
    assert where(robot, 'camera_rgb_optical_frame', (0.0, 0.0, 1.0)) == ahead
    right = (1.0 + 0.5, 2.0 + PI_CAMERA.x, PI_CAMERA.z)
    assert where(robot, 'camera_rgb_optical_frame', (0.5, 0.0, 0.0)) == right
    assert where(robot, 'wheel_left_link', (0.0, 0.0, 0.0), 'a/') == (1.0 - 0.08, 2.0, 0.033)


def test_wheels_turn_as_the_joints_do() -> None:
    robot = Simulator(open_field())
    robot.wheels = (math.pi / 2, 0.0)
    # What was ahead on the rim is below: the robot has driven ahead.
    rim = where(robot, 'wheel_left_link', (BURGER.wheel_radius, 0.0, 0.0))
    assert rim == (0.0, 0.08, 0.033 - BURGER.wheel_radius)
    rim = where(robot, 'wheel_right_link', (BURGER.wheel_radius, 0.0, 0.0))
    assert rim == (BURGER.wheel_radius, -0.08, 0.033)


@pytest.fixture
def unasked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let this process be one that has not imported the type."""
    monkeypatch.setattr(turtlebot, 'is_loaded', lambda name: False)


class Hearer(Node):
    """Hears all frames, and a scan."""

    def __init__(self) -> None:
        super().__init__('hearer')
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)


@pytest.mark.usefixtures('unasked')
def test_who_listens_hears_where_all_parts_are(stage: Stage) -> None:
    robot, driver = stage.robot(x=0.5, yaw=1.0), stage.driver()
    assert robot.count_publishers('/tf') == robot.count_publishers('/tf_static') == 0
    buffer = stage.add(Hearer()).buffer
    stage.until(lambda: buffer.can_transform('odom', 'camera_rgb_optical_frame', Time()))
    (info,) = robot.get_publishers_info_by_topic('/tf_static')
    assert info.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
    assert robot.count_publishers('/tf') == 1
    driver.commands.publish(twist(0.1, 0.5))
    stage.until(lambda: robot.twist.w)
    # What a scan has seen can be looked up at its own time, and there odometry agrees.
    driver.scans.clear()
    stage.until(lambda: driver.scans)
    scan = driver.scans[0]
    stage.until(lambda: buffer.can_transform('odom', scan.header.frame_id, scan.header.stamp))
    place = buffer.lookup_transform('odom', 'base_footprint', scan.header.stamp).transform
    (told,) = (one for one in driver.odometry if one.header.stamp == scan.header.stamp)
    assert place.translation.x == pytest.approx(told.pose.pose.position.x, abs=1e-9)
    assert place.rotation.z == pytest.approx(told.pose.pose.orientation.z, abs=1e-9)
    # Who comes later, too.
    later = stage.add(Node('later'))
    buffer = Buffer()
    TransformListener(buffer, later)
    stage.until(lambda: buffer.can_transform('odom', 'wheel_left_link', Time()))


def test_without_odometry_its_wheels_alone_are_told(stage: Stage) -> None:
    robot = stage.robot(odometry=False)
    buffer = stage.add(Hearer()).buffer
    stage.until(lambda: buffer.can_transform('base_footprint', 'wheel_left_link', Time()))
    # It came with the wheels where a robot tells it.
    assert 'odom' not in buffer.all_frames_as_yaml()
    assert robot.count_publishers('/odom') == 0
    assert robot.count_publishers('/joint_states') == 1


def test_in_lock_step_it_is_told_before_the_first_command(stage: Stage) -> None:
    assert built_types.is_ready(turtlebot.TF_TYPE)
    assert built_types.is_loaded(turtlebot.TF_TYPE)
    stage.robot(lockstep=0.1, namespace='robot1')
    buffer = stage.add(Hearer()).buffer
    stage.until(lambda: buffer.can_transform('robot1/odom', 'robot1/base_scan', Time()))


@pytest.mark.usefixtures('unasked')
def test_without_the_type_it_says_so_once_to_who_listens(
    stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(turtlebot, 'is_ready', lambda name: False)
    robot, driver = stage.robot(), stage.driver()
    stage.add(Hearer())
    stage.until(lambda: driver.warnings)
    scans = len(driver.scans)
    stage.until(lambda: len(driver.scans) > scans + 2)
    assert driver.warnings == [
        "Can't say on /tf where my parts are: the type tf2_msgs/msg/TFMessage is not there. This "
        'builds it, once: from tf2_msgs.msg import TFMessage'
    ]
    assert robot.count_publishers('/tf') == 0


def test_it_says_what_it_looks_like_when_somebody_asks(stage: Stage) -> None:
    robot = stage.robot(namespace='robot1')
    ear = stage.add(Node('ear'))
    stage.until(lambda: robot.simulator.time > 0.5)
    assert ear.count_publishers('/robot1/robot_description') == 0
    heard: list[String] = []
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    ear.create_subscription(String, '/robot1/robot_description', heard.append, latched)
    stage.until(lambda: heard)
    found = read(heard[0].data)
    assert found.root == 'robot1/base_footprint' and len(found.links) == 10
    # Its frames are those of the description, and its joints those of /joint_states.
    driver = stage.driver('robot1')
    stage.until(lambda: driver.joints)
    assert {j.name for j in found.free_joints} == set(driver.joints[0].name)
    frames = {one.child_frame_id for one in static_parts(Stamp(), 'robot1/')}
    parts = wheel_parts(robot.simulator, Stamp(), 'robot1/')
    parts.append(footprint(robot.simulator, Stamp(), 'robot1/'))
    moving = {one.child_frame_id for one in parts}
    assert frames | moving == found.links.keys()


def test_the_description_is_in_order() -> None:
    reading = examine(urdf())
    assert reading.problems == () and reading.description == description()
    left, right = (description().links[f'wheel_{side}_link'] for side in ('left', 'right'))
    (shape,) = {part.geometry for part in (*left.collisions, *right.collisions)}
    assert isinstance(shape, Cylinder) and shape.radius == BURGER.wheel_radius
    places = link_transforms(description())
    left_y = places['wheel_left_link'].translation[1]
    right_y = places['wheel_right_link'].translation[1]
    assert left_y - right_y == pytest.approx(BURGER.wheel_separation)
    # Wheels and caster touch the floor.
    assert places['wheel_left_link'].translation[2] == pytest.approx(BURGER.wheel_radius)
    caster = description().links['caster_back_link'].collisions[0].geometry
    assert isinstance(caster, Sphere)
    assert places['caster_back_link'].translation[2] == pytest.approx(caster.radius)
