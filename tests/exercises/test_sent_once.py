"""Messages that are sent once, before a check, and across a stop of ROS."""

from __future__ import annotations

from types import ModuleType

import pytest
import rclpy
from std_msgs.msg import Int16, String

from labkit.exercises.sent_once import Recorder

NEWS = '/news'


@pytest.fixture
def recorder(lab: ModuleType) -> Recorder:
    recorder = Recorder({NEWS: 'std_msgs/msg/Int16'})
    recorder.keep()
    return recorder


def publish(*numbers: int) -> None:
    node = rclpy.create_node('teller')
    publisher = node.create_publisher(Int16, NEWS, 10)
    for number in numbers:
        publisher.publish(Int16(data=number))
    node.destroy_node()


def heard(recorder: Recorder) -> list[int]:
    return recorder.watches()[NEWS].values('data')


def kept(recorder: Recorder) -> list[int]:
    return [sample.message.data for sample in recorder.watches()[NEWS].earlier]


@pytest.mark.parametrize('stop', [1, 2, 3])
def test_recording_comes_to_life_again_when_ros_does(
    stop: int, lab: ModuleType, recorder: Recorder
) -> None:
    publish(1)
    assert heard(recorder) == [1]
    for _ in range(stop):
        lab.stop()
        lab.start()
    publish(3)
    assert heard(recorder) == [1, 3]


def test_whoever_waits_for_a_subscription_when_ros_is_back_finds_one(
    lab: ModuleType, recorder: Recorder
) -> None:
    lab.stop()
    lab.start()
    node = rclpy.create_node('teller')
    publisher = node.create_publisher(Int16, NEWS, 10)
    lab.wait_for_subscribers(publisher)


def test_while_ros_is_stopped_nothing_comes_and_nothing_fails(
    lab: ModuleType, recorder: Recorder
) -> None:
    recording = recorder.watches()[NEWS]
    publish(1)
    recording.pump()
    lab.stop()
    recording.pump()
    assert recording.values('data') == [1]
    recorder.forget()
    assert heard(recorder) == []
    lab.start()
    publish(5)
    recording.pump()
    assert recording.values('data') == [5]


def test_what_a_check_keeps_is_there_for_the_next_one_only(recorder: Recorder) -> None:
    recording = recorder.watches()[NEWS]
    publish(1, 2)
    recording.pump()
    recording.keep(recording.samples[:1])
    recorder.forget()
    assert (kept(recorder), heard(recorder)) == ([1], [])
    publish(3)
    assert (kept(recorder), heard(recorder)) == ([1], [3])
    recorder.forget()
    assert (kept(recorder), heard(recorder)) == ([], [])


def test_topic_that_has_another_type_is_heard_once_that_is_gone(lab: ModuleType) -> None:
    node = rclpy.create_node('other')
    node.create_publisher(String, NEWS, 10)
    recorder = Recorder({NEWS: 'std_msgs/msg/Int16'})
    recorder.keep()
    assert heard(recorder) == []
    node.destroy_node()
    recorder.keep()
    publish(7)
    assert heard(recorder) == [7]
