"""Programs of the shape of the official tutorials on tf2 run in cells; robots play its turtles.

The tutorials (docs.ros.org, Jazzy, Intermediate, tf2, Python) name turtlesim. Their programs only
see its topics and one service: poses, commands and `spawn`, with types that are built on demand.
What is here is written anew, with the same names of ROS, parameters and calls. See docs/tf2.md.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from labkit.background.domains import claim_domain
from tests.conftest import Kernel

pytestmark = [pytest.mark.timeout(900), pytest.mark.slow('two robots drive in real time')]

# Two robots behind the topics of two turtles. The second one is there before it is spawned.
TURTLESIM = """
import math

import labkit as lab
import rclpy
from geometry_msgs.msg import TransformStamped, Twist
from nav_msgs.msg import Odometry
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import (
    ConnectivityException, ExtrapolationException, LookupException, TransformBroadcaster,
    TransformException,
)
from tf2_ros.buffer import Buffer
from tf2_ros.static_transform_broadcaster import StaticTransformBroadcaster
from tf2_ros.transform_listener import TransformListener
from turtlesim.msg import Pose
from turtlesim.srv import Spawn
from labkit.sim.world import open_field


class Turtlesim(Node):
    def __init__(self):
        super().__init__('turtlesim')
        for name in ('turtle1', 'turtle2'):
            poses = self.create_publisher(Pose, f'/{name}/pose', 10)
            self.create_subscription(
                Odometry, f'/{name}/odom', lambda odom, poses=poses: self.tell(odom, poses), 10
            )
        self.create_service(Spawn, 'spawn', self.spawn)

    def tell(self, odom, poses):
        place, turn = odom.pose.pose.position, odom.pose.pose.orientation
        yaw = 2 * math.atan2(turn.z, turn.w)
        poses.publish(Pose(x=place.x, y=place.y, theta=yaw))

    def spawn(self, request, response):
        response.name = request.name
        return response


field = open_field()
turtle1 = lab.spin(lab.Turtlebot(namespace='turtle1', world=field, x=1.0, y=0.0))
turtle2 = lab.spin(lab.Turtlebot(namespace='turtle2', world=field, x=0.0, y=0.0))
turtlesim = lab.spin(Turtlesim())


def transform(node, parent, child, x=0.0, y=0.0, z=0.0, yaw=0.0):
    t = TransformStamped()
    t.header.stamp = node.get_clock().now().to_msg()
    t.header.frame_id = parent
    t.child_frame_id = child
    t.transform.translation.x, t.transform.translation.y = x, y
    t.transform.translation.z = z
    t.transform.rotation.z, t.transform.rotation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return t
"""
STATIC = """
class StaticFramePublisher(Node):
    def __init__(self, words):
        super().__init__('static_turtle_tf2_broadcaster')
        self.tf_static_broadcaster = StaticTransformBroadcaster(self)
        x, y, z, yaw = map(float, words[1:])
        self.tf_static_broadcaster.sendTransform(
            transform(self, 'world', words[0], x, y, z, yaw)
        )


fixed = lab.spin(StaticFramePublisher(['mystaticturtle', '0', '0', '1', '0']))
"""
BROADCASTER = """
class FramePublisher(Node):
    def __init__(self, **more):
        super().__init__('turtle_tf2_frame_publisher', **more)
        self.turtlename = self.declare_parameter(
            'turtlename', 'turtle').get_parameter_value().string_value
        self.tf_broadcaster = TransformBroadcaster(self)
        self.subscription = self.create_subscription(
            Pose, f'/{self.turtlename}/pose', self.handle_turtle_pose, 1)

    def handle_turtle_pose(self, msg):
        self.tf_broadcaster.sendTransform(
            transform(self, 'world', self.turtlename, msg.x, msg.y, yaw=msg.theta)
        )


broadcasters = [
    lab.spin(FramePublisher(cli_args=[
        '--ros-args', '-r', f'__node:=broadcaster{n}', '-p', f'turtlename:=turtle{n}']))
    for n in (1, 2)
]
"""
LISTENER = """
class FrameListener(Node):
    def __init__(self, **more):
        super().__init__('turtle_tf2_frame_listener', **more)
        self.target_frame = self.declare_parameter(
            'target_frame', 'turtle1').get_parameter_value().string_value
        self.tf_buffer = Buffer()
        self.tf_listener = TransformListener(self.tf_buffer, self)
        self.spawner = self.create_client(Spawn, 'spawn')
        self.spawned, self.answer = False, None
        self.publisher = self.create_publisher(Twist, 'turtle2/cmd_vel', 1)
        self.timer = self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        if self.spawned:
            self.follow()
        elif self.answer is not None:
            self.spawned = self.answer.done()
        elif self.spawner.service_is_ready():
            request = Spawn.Request(name='turtle2', x=4.0, y=2.0, theta=0.0)
            self.answer = self.spawner.call_async(request)

    def look(self):
        return self.tf_buffer.lookup_transform('turtle2', self.target_frame, Time())

    def follow(self):
        try:
            t = self.look()
        except TransformException as ex:
            self.get_logger().info(
                f'Could not transform turtle2 to {self.target_frame}: {ex}', once=True)
            return
        msg = Twist()
        ahead, left = t.transform.translation.x, t.transform.translation.y
        msg.angular.z = 1.0 * math.atan2(left, ahead)
        msg.linear.x = 0.5 * math.sqrt(ahead ** 2 + left ** 2)
        self.publisher.publish(msg)
"""
FOLLOW = 'listener = lab.spin(FrameListener({}))'
TARGET = "cli_args=['--ros-args', '-p', 'target_frame:={}']"
FIXED = """
class FixedFrameBroadcaster(Node):
    def __init__(self):
        super().__init__('fixed_frame_tf2_broadcaster')
        self.tf_broadcaster = TransformBroadcaster(self)
        self.timer = self.create_timer(0.1, self.broadcast_timer_callback)

    def broadcast_timer_callback(self):
        self.tf_broadcaster.sendTransform(transform(self, 'turtle1', 'carrot1', y=2.0))


carrot = lab.spin(FixedFrameBroadcaster())
"""
DYNAMIC = """
class DynamicFrameBroadcaster(Node):
    def __init__(self):
        super().__init__('dynamic_frame_tf2_broadcaster')
        self.tf_broadcaster = TransformBroadcaster(self)
        self.timer = self.create_timer(0.1, self.broadcast_timer_callback)

    def broadcast_timer_callback(self):
        seconds, _ = self.get_clock().now().seconds_nanoseconds()
        x = seconds * math.pi / 10
        self.tf_broadcaster.sendTransform(
            transform(self, 'turtle1', 'carrot1', 10 * math.sin(x), 10 * math.cos(x)))


carrot = lab.spin(DynamicFrameBroadcaster())
"""
# Where turtle2 is, and that it comes nearer to what it follows.
NEARER = """
buffer = listener.tf_buffer
def distance(frame):
    t = buffer.lookup_transform('turtle2', frame, Time(), timeout=Duration(seconds=60.0))
    return math.hypot(t.transform.translation.x, t.transform.translation.y)

far = distance({frame!r})
lab.wait_until(lambda: distance({frame!r}) < far - 0.1, timeout_sec=120)
"""
# Asks for now, which nobody knows yet, and tells how it went.
NOW = """
class Impatient(FrameListener):
    said = ''

    def look(self):
        when = self.get_clock().now()
        return self.tf_buffer.lookup_transform('turtle2', 'turtle1', when)

    def follow(self):
        try:
            self.look()
        except (LookupException, ConnectivityException, ExtrapolationException) as ex:
            self.said = f'{type(ex).__name__}: {ex}'
            if isinstance(ex, ExtrapolationException):
                self.timer.cancel()


listener = lab.spin(Impatient())
lab.wait_until(lambda: 'Extrapolation' in listener.said, timeout_sec=120)
print(listener.said)
"""
# A cell waits for it.
WAITS = """
now = listener.get_clock().now()
t = listener.tf_buffer.lookup_transform(
    'turtle2', 'turtle1', now, timeout=Duration(seconds=60.0))
print(Time.from_msg(t.header.stamp) == now)
"""
# In a callback it does not, and says what does.
IN_CALLBACK = """
class Patient(Impatient):
    def look(self):
        return self.tf_buffer.lookup_transform(
            'turtle2', 'turtle1', self.get_clock().now(), timeout=Duration(seconds=1.0))


lab.remove(listener)
listener = lab.spin(Patient())
lab.wait_until(lambda: 'Extrapolation' in listener.said, timeout_sec=120)
print('await buffer.lookup_transform_async(...)' in listener.said)


class Awaiting(FrameListener):
    found = None

    def __init__(self):
        super().__init__()
        self.timer.cancel()
        self.timer = self.create_timer(0.1, self.on_time)

    async def on_time(self):
        self.timer.cancel()
        self.found = await self.tf_buffer.lookup_transform_async(
            'turtle2', 'turtle1', self.get_clock().now())


lab.remove(listener)
listener = lab.spin(Awaiting())
lab.wait_until(lambda: listener.found, timeout_sec=120)
print(listener.found.child_frame_id)
"""
TRAVEL = """
go = lab.spin(Node('go')).create_publisher(Twist, '/turtle1/cmd_vel', 1)
drive = go.publish
listener = lab.spin(Node('traveller'))
listener.tf_buffer = Buffer()
listener.tf_listener = TransformListener(listener.tf_buffer, listener)
started = listener.tf_buffer.lookup_transform(
    'world', 'turtle1', Time(), timeout=Duration(seconds=60.0))
timer = listener.create_timer(
    0.1, lambda: drive(Twist(linear=type(Twist().linear)(x=0.2))))
def moved():
    t = listener.tf_buffer.lookup_transform('world', 'turtle1', Time())
    return t.transform.translation.x - started.transform.translation.x

lab.wait_until(lambda: moved() > 0.3, timeout_sec=120)
when = Time.from_msg(started.header.stamp)
then = listener.tf_buffer.lookup_transform(
    'turtle2', 'turtle1', when + Duration(seconds=0.5), timeout=Duration(seconds=0.05))
mixed = listener.tf_buffer.lookup_transform_full(
    target_frame='turtle2',
    target_time=Time(),
    source_frame='turtle1',
    source_time=when,
    fixed_frame='world',
    timeout=Duration(seconds=0.05))
now = listener.tf_buffer.lookup_transform('turtle2', 'turtle1', Time())
# turtle2 stands at the origin, so this is where turtle1 was in the world when it started.
print(round(mixed.transform.translation.x - started.transform.translation.x, 6))
print(now.transform.translation.x - mixed.transform.translation.x > 0.2)
try:
    listener.tf_buffer.lookup_transform('turtle2', 'turtle1', when - Duration(seconds=20))
except ExtrapolationException as ex:
    print('into the past' in str(ex))
"""
# As in the tutorial on debugging: a turtle that is not there, then a time that is to come.
DEBUG = """
class Wrong(FrameListener):
    said = ''

    def follow(self):
        try:
            self.tf_buffer.lookup_transform('turtle3', 'turtle1', self.get_clock().now())
        except TransformException as ex:
            self.said = f'Could not transform turtle3 to turtle1: {ex}'


listener = lab.spin(Wrong())
lab.wait_until(lambda: 'turtle1' in listener.tf_buffer.tree.names() and listener.said)
print(listener.said)
from labkit.silent.watch import watch
lab.wait_until(
    lambda: any('turtle3' in str(fault) for fault in watch.look()), timeout_sec=60)
print(*[str(f) + ' ' + f.advice for f in watch.look() if f.kind.id == 'frames.unknown'])
"""
TOOLS = """
def said(words, of):
    lab.wait_until(lambda: any(words in line for process in lab.processes()
        if of in str(process) for line in process.output), timeout_sec=120)
"""


@pytest.fixture
def kernel(start_kernel: Callable[..., Kernel]) -> Iterator[Kernel]:
    claim = claim_domain()
    kernel = start_kernel(
        ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST', ROS_DOMAIN_ID=str(claim.domain_id)
    )
    run(kernel, TURTLESIM)
    yield kernel
    claim.close()


def run(kernel: Kernel, code: str) -> str:
    ran = kernel.run(code, timeout=800)
    assert not ran.error, ran.traceback
    return ran.text


def test_a_static_broadcaster(kernel: Kernel) -> None:
    run(kernel, STATIC)
    run(
        kernel,
        '%ros2 run tf2_ros static_transform_publisher --z 1 --yaw 0 --pitch 0 --roll 0 '
        '--frame-id mystaticturtle --child-frame-id othersturtle',
    )
    run(kernel, '%ros2 run tf2_ros tf2_echo world othersturtle')
    run(kernel, TOOLS + "said('- Translation: [0.000, 0.000, 2.000]', 'tf2_echo')")


def test_a_broadcaster_and_a_listener(kernel: Kernel) -> None:
    run(kernel, BROADCASTER)
    run(kernel, '%ros2 run tf2_ros tf2_echo world turtle1')
    run(kernel, TOOLS + "said('- Translation: [1.000, 0.000, 0.000]', 'tf2_echo')")
    run(kernel, LISTENER + FOLLOW.format(''))
    run(kernel, NEARER.format(frame='turtle1'))


@pytest.mark.parametrize('code', [FIXED, DYNAMIC], ids=['fixed', 'dynamic'])
def test_a_frame_is_added(kernel: Kernel, code: str) -> None:
    run(kernel, BROADCASTER + code)
    run(kernel, LISTENER + FOLLOW.format(TARGET.format('carrot1')))
    frame = 'carrot1'
    if code == FIXED:
        run(kernel, NEARER.format(frame=frame))
    else:
        # It goes round the turtle, faster than anybody can follow.
        where = f"listener.tf_buffer.lookup_transform('turtle1', '{frame}', Time()).transform"
        run(
            kernel,
            f"lab.wait_until(lambda: '{frame}' in listener.tf_buffer.tree.names())\n"
            f'before = {where}\n'
            f'lab.wait_until(lambda: {where} != before, timeout_sec=60)',
        )


def test_using_time(kernel: Kernel) -> None:
    run(kernel, BROADCASTER + LISTENER)
    said = run(kernel, NOW)
    assert said.startswith('ExtrapolationException: Lookup would require extrapolation into the')
    assert run(kernel, WAITS) == 'True\n'
    assert run(kernel, IN_CALLBACK) == 'True\nturtle1\n'


def test_travelling_in_time(kernel: Kernel) -> None:
    run(kernel, BROADCASTER)
    assert run(kernel, TRAVEL) == '0.0\nTrue\nTrue\n'


def test_debugging(kernel: Kernel) -> None:
    run(kernel, BROADCASTER + LISTENER)
    said, told = run(kernel, DEBUG).splitlines()
    assert said == (
        'Could not transform turtle3 to turtle1: "turtle3" passed to lookupTransform argument '
        'target_frame does not exist. '
    ) or said.rstrip().endswith('does not exist.')
    assert 'asks for the frame turtle3, which nobody publishes' in told
    assert 'Did you mean' in told
    run(kernel, '%ros2 run tf2_ros tf2_echo turtle3 turtle1')
    run(kernel, TOOLS + "said('\"turtle3\" passed to canTransform', 'tf2_echo')")
    run(kernel, '%ros2 run tf2_ros tf2_monitor turtle2 turtle1')
    run(kernel, "said('Chain is: turtle2', 'tf2_monitor')")
