"""Programs with tf2_ros: in cells, in callbacks, in scripts; whatever is installed comes first."""

from __future__ import annotations

from pathlib import Path

import pytest

from labkit.packages import stand_in

# A first build of the type of /tf takes seconds of processor time.
pytestmark = pytest.mark.timeout(900)

# As in the official tutorials: a static broadcaster, a broadcaster, a listener.
NODES = """
import rclpy
from geometry_msgs.msg import PointStamped, TransformStamped
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import TransformBroadcaster, TransformException
from tf2_ros.buffer import Buffer
from tf2_ros.static_transform_broadcaster import StaticTransformBroadcaster
from tf2_ros.transform_listener import TransformListener
import tf2_geometry_msgs


def transform(parent, child, x, stamp):
    found = TransformStamped()
    found.header.stamp = stamp
    found.header.frame_id = parent
    found.child_frame_id = child
    found.transform.translation.x = x
    found.transform.rotation.w = 1.0
    return found


class Sender(Node):
    def __init__(self):
        super().__init__('sender')
        self.fixed = StaticTransformBroadcaster(self)
        now = self.get_clock().now().to_msg()
        one = transform('base', 'scan', 1.0, now)
        self.fixed.sendTransform(one)
        one.child_frame_id = 'camera'
        one.transform.translation.x = 2.0
        self.fixed.sendTransform(one)
        self.moving = TransformBroadcaster(self)
        self.create_timer(0.05, self.tick)

    def tick(self):
        now = self.get_clock().now().to_msg()
        self.moving.sendTransform([transform('odom', 'base', 10.0, now)])


class Hearer(Node):
    def __init__(self):
        super().__init__('hearer')
        self.tf_buffer = Buffer()
        self.tf_listener = TransformListener(self.tf_buffer, self)
"""


def test_transforms_are_sent_heard_and_waited_for_in_cells(kernel):
    assert kernel.run('import labkit as lab').error == ''
    assert kernel.run(NODES, timeout=800).error == ''
    assert kernel.run('hearer, sender = lab.spin(Hearer()), lab.spin(Sender())').error == ''
    found = kernel.run(
        "found = hearer.tf_buffer.lookup_transform('odom', 'camera', Time(), Duration(seconds=60))"
        '\nprint(found.header.frame_id, found.child_frame_id, found.transform.translation.x)\n'
        "print(hearer.tf_buffer.lookup_transform('odom', 'scan', Time()).transform.translation.x)"
    )
    assert (found.error, found.text) == ('', 'odom camera 12.0\n11.0\n')
    # A time that is to come.
    later = kernel.run(
        'when = hearer.get_clock().now() + Duration(seconds=0.1)\n'
        "found = hearer.tf_buffer.lookup_transform('odom', 'base', when, Duration(seconds=60))\n"
        'print(Time.from_msg(found.header.stamp) == when)\n'
        "print(hearer.tf_buffer.can_transform('odom', 'nowhere', Time(), Duration(seconds=0.1)))"
    )
    assert (later.error, later.text) == ('', 'True\nFalse\n')
    moved = kernel.run(
        'point = PointStamped()\n'
        "point.header.frame_id = 'camera'\n"
        'point.point.y = 3.0\n'
        "moved = hearer.tf_buffer.transform(point, 'odom')\n"
        'print(moved.header.frame_id, moved.point.x, moved.point.y)'
    )
    assert (moved.error, moved.text) == ('', 'odom 12.0 3.0\n')
    shown = kernel.run('%ros2 topic info --verbose /tf_static')
    assert shown.text.count('Durability: TRANSIENT_LOCAL') == 2
    shown = kernel.run('%ros2 topic info --verbose /tf')
    assert shown.text.count('Durability: VOLATILE') == 2
    depths = kernel.run(
        'ends = [hearer.tf_listener.tf_sub, hearer.tf_listener.tf_static_sub]\n'
        'ends += [sender.moving.pub_tf, sender.fixed.pub_tf]\n'
        'print([end.qos_profile.depth for end in ends])'
    )
    assert depths.text == '[100, 100, 100, 1]\n'


def test_what_is_not_known_is_said_without_a_traceback(kernel):
    kernel.run('import labkit as lab\nimport tf2_ros\nfrom rclpy.time import Time')
    said = kernel.run("tf2_ros.Buffer().lookup_transform('odom', 'base', Time())")
    assert said.traceback == (
        "Cell In[2], line 1: tf2_ros.Buffer().lookup_transform('odom', 'base', Time())\n"
        'LookupException: "odom" passed to lookupTransform argument target_frame does not exist.'
    )
    said = kernel.run("tf2_ros.Buffer().lookup_transform('odom', 'base', Time(), timeout=1.0)")
    assert 'Write timeout=Duration(seconds=1.0).' in said.error


CALLBACKS = """
class Asker(Hearer):
    def __init__(self):
        super().__init__()
        self.said = []
        self.timer = self.create_timer(0.05, self.tick)

    def tick(self):
        self.timer.cancel()
        try:
            self.tf_buffer.lookup_transform('odom', 'scan', Time(), Duration(seconds=3600))
        except TransformException as error:
            self.said.append(str(error))
        print(self.tf_buffer.can_transform('odom', 'scan', Time(), Duration(seconds=3600)))
        self.later = self.create_timer(0.05, self.wait)

    async def wait(self):
        self.later.cancel()
        found = await self.tf_buffer.lookup_transform_async('odom', 'scan', Time())
        print(found.transform.translation.x)
        self.said.append('found')


asker = lab.spin(Asker())
"""


def test_a_callback_does_not_wait_in_vain_and_a_coroutine_waits(kernel):
    kernel.run('import labkit as lab')
    asked = kernel.run(NODES + CALLBACKS, timeout=800)
    assert asked.error == ''
    said = kernel.run('lab.wait_until(lambda: asker.said, timeout_sec=60)\nprint(asker.said[0])')
    assert said.text.splitlines()[-2:] == [
        '"odom" passed to lookupTransform argument target_frame does not exist. ',
        'It was not waited for: a callback asked, and no transform is heard until it returns. Ask '
        'again in the next callback, or in one that is `async def`: '
        'await buffer.lookup_transform_async(...).',
    ]
    kernel.run('lab.spin(Sender())\nlab.wait_until(lambda: asker.said[1:], timeout_sec=60)')
    assert kernel.run('print(asker.said[1])').text == 'found\n'


SCRIPT = """
import threading
from rclpy.executors import ExternalShutdownException


def spin():
    try:
        rclpy.spin(sender)
    except ExternalShutdownException:
        pass


rclpy.init()
hearer = Hearer()
del hearer.tf_listener
heard = TransformListener(hearer.tf_buffer, hearer, spin_thread=True)
sender = Sender()
thread = threading.Thread(target=spin)
thread.start()
found = hearer.tf_buffer.lookup_transform('odom', 'scan', Time(), Duration(seconds=60))
print(found.transform.translation.x)
rclpy.shutdown()
thread.join()
"""


def test_a_script_that_does_not_know_labkit_runs(script):
    stand_ins = str(Path(stand_in.__file__).with_name('stand_ins'))
    done = script(f'import sys\nsys.path.append({stand_ins!r})\n{NODES}{SCRIPT}')
    assert (done.stdout, done.exit_code) == ('11.0\n', 0), done.stderr
    assert 'Traceback' not in done.stderr


def test_a_notebook_has_one_thread_that_spins(kernel):
    kernel.run('import labkit as lab')
    assert kernel.run(NODES, timeout=800).error == ''
    done = kernel.run(
        "hearer = Node('hearer')\n"
        'buffer = Buffer()\n'
        'listener = TransformListener(buffer, hearer, spin_thread=True)\n'
        'sender = lab.spin(Sender())\n'
        "found = buffer.lookup_transform('odom', 'scan', Time(), Duration(seconds=60))\n"
        'print(found.transform.translation.x)\n'
        'print(hasattr(listener, "dedicated_listener_thread"))\n'
        'listener.unregister()\n'
        'lab.wait_until(lambda: not hearer.count_subscribers("/tf"), timeout_sec=60)'
    )
    assert (done.error, done.text) == ('', '11.0\nFalse\n')


@pytest.mark.parametrize('package', ['tf2_py', 'tf2_ros', 'tf2_geometry_msgs'])
def test_one_that_is_installed_wins(script, tmp_path, package):
    stand_ins = str(Path(stand_in.__file__).with_name('stand_ins'))
    for folder in ('early', 'late'):
        (tmp_path / folder / package).mkdir(parents=True)
        (tmp_path / folder / package / '__init__.py').write_text(f"WHOSE = '{folder}'")
    code = f'import {package}; print({package}.WHOSE)'
    early = script(code, PYTHONPATH=f'{tmp_path / "early"}:{stand_ins}')
    assert early.stdout == 'early\n', early.stderr
    late = script(f'import sys; sys.path += [{stand_ins!r}, {str(tmp_path / "late")!r}]\n{code}')
    assert late.stdout == 'late\n', late.stderr


def test_names_are_those_of_the_real_packages(script):
    done = script(
        'import labkit, tf2_py, tf2_ros, tf2_geometry_msgs\n'
        'from tf2_ros import *\n'
        'from tf2_geometry_msgs.tf2_geometry_msgs import do_transform_pose\n'
        'import tf2_ros.buffer_interface, tf2_ros.transform_broadcaster\n'
        'print(Buffer is tf2_ros.buffer.Buffer, issubclass(Buffer, tf2_py.BufferCore))\n'
        'print(issubclass(LookupException, TransformException), TransformBroadcaster)\n'
        'print(sorted(name for name in dir(tf2_ros) if name[0].isupper()))'
    )
    assert done.stdout.splitlines()[0] == 'True True', done.stderr
    names = (
        'Buffer BufferCore BufferInterface ConnectivityException ConvertRegistration '
        'ExtrapolationException InvalidArgumentException LookupException '
        'NotImplementedException Stamped StaticTransformBroadcaster TimeoutException '
        'TransformBroadcaster TransformException TransformListener TransformRegistration '
        'TypeException'
    )
    assert done.stdout.splitlines()[2] == str(names.split())
