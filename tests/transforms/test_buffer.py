"""The buffer that waits: it forgets when time goes back, and tells its frames as a service."""

from __future__ import annotations

import threading

import pytest
import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.duration import Duration
from rclpy.time import Time

from labkit.transforms.buffer import Buffer

# A first build of the type of the service takes seconds of processor time.
pytestmark = pytest.mark.timeout(900)


@pytest.fixture
def buffer():
    rclpy.init()
    node = rclpy.create_node('keeper')
    yield Buffer(node=node)
    node.destroy_node()
    rclpy.shutdown()


def put(buffer: Buffer, time: int) -> None:
    transform = TransformStamped()
    transform.header.frame_id, transform.child_frame_id = 'odom', 'base'
    transform.header.stamp = Time(seconds=time).to_msg()
    transform.transform.rotation.w = 1.0
    buffer.set_transform(transform, 'the test')


def test_it_forgets_when_time_goes_back_and_only_then(buffer, capfd):
    put(buffer, 100)
    clock = buffer.clock
    # A check sets the clock to what it says anyway, and lets it go on.
    clock.set_ros_time_override(clock.now())
    clock._set_ros_time_is_active(True)
    clock.set_ros_time_override(clock.now() + Duration(seconds=5))
    assert buffer.can_transform('odom', 'base', Time())
    # A simulator begins.
    clock.set_ros_time_override(Time(seconds=3, clock_type=clock.clock_type))
    assert 'Detected jump back in time. Clearing tf buffer.' in capfd.readouterr().err
    assert not buffer.can_transform('odom', 'base', Time())
    assert buffer._frameExists('base')


def test_the_service_tells_all_frames(buffer):
    put(buffer, 100)
    said = buffer._on_frames(None, buffer.srv.srv_type.Response())
    assert said.frame_yaml == buffer.all_frames_as_yaml() and "parent: 'odom'" in said.frame_yaml
    assert buffer.srv.srv_name.endswith('tf2_frames')


def test_a_future_is_done_when_the_transform_comes(buffer):
    future = buffer.wait_for_transform_async('odom', 'base', Time(seconds=7))
    other = buffer.wait_for_transform_full_async(
        'odom', Time(seconds=8), 'base', Time(seconds=7), 'odom'
    )
    put(buffer, 6)
    assert not future.done() and not other.done()
    cancelled = buffer.wait_for_transform_async('odom', 'base', Time(seconds=9))
    cancelled.cancel()
    put(buffer, 8)
    assert future.result().header.stamp.sec == 7 and other.result().header.stamp.sec == 8
    assert not buffer._waiting
    at_once = buffer.wait_for_transform_async('odom', 'base', Time(seconds=7))
    assert at_once.done() and not buffer._waiting


def test_an_answer_may_come_with_its_reason(buffer):
    asked = 'odom', 'base', Time()
    why = 'Invalid frame ID "odom" passed to canTransform argument target_frame - frame does not'
    known, said = buffer.can_transform(*asked, return_debug_tuple=True)
    assert not known and said.startswith(why)
    full = 'odom', Time(), 'base', Time(), 'odom'
    known, said = buffer.can_transform_full(*full, Duration(seconds=0.02), True)
    assert not known and said.startswith(why)
    put(buffer, 1)
    assert buffer.can_transform(*asked, return_debug_tuple=True) == (True, '')
    assert (
        buffer.lookup_transform_full(*full, timeout=Duration(seconds=9)).child_frame_id == 'base'
    )


def test_what_a_future_calls_may_wait_for_another_thread_that_uses_the_buffer(buffer):
    future = buffer.wait_for_transform_async('odom', 'base', Time())
    asked = []

    def in_thread():
        buffer.wait_for_transform_async('odom', 'base', Time())
        asked.append(buffer.can_transform('odom', 'base', Time()))

    def on_done(future):
        thread = threading.Thread(target=in_thread)
        thread.start()
        thread.join(timeout=60)

    future.add_done_callback(on_done)
    put(buffer, 1)
    assert asked == [True]
