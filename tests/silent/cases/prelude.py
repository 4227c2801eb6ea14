"""What the cells of all cases may use. It is run in the kernel, and made for nothing else."""
# ruff: noqa: F401

import math
import threading
import time
from typing import Any

import rclpy
from geometry_msgs.msg import PoseStamped, Twist, TwistStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import (
    DurabilityPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import (
    BatteryState,
    Image,
    JointState,
    LaserScan,
    NavSatFix,
    PointCloud2,
)
from std_msgs.msg import Int16, Int32, String
from std_srvs.srv import SetBool, Trigger
from test_msgs.action import Fibonacci
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint
from visualization_msgs.msg import Marker

import labkit as lab
from labkit.background.notebook_rclpy import ORIGINALS
from labkit.background.runtime import runtime
from labkit.rosgraph.snapshot import is_whole
from labkit.silent.kinds import in_words
from labkit.silent.watch import watch

lab.start()
elsewhere: list[Any] = []


def heard(*_):
    pass


def node(name, **more):
    return lab.spin(Node(name, **more))


def loud(name, topic, kind=String, qos=10, **more):
    """Make a node with a publisher; return the publisher."""
    return node(name, **more).create_publisher(kind, topic, qos)


def deaf(name, topic, kind=String, qos=10, callback=heard, **more):
    """Make a node with a subscription; return the node."""
    made = node(name, **more)
    made.create_subscription(kind, topic, callback, qos)
    return made


def say(message, topic='topic', name='speaker'):
    """Publish one message, from a node of that name."""
    publisher = loud(name, topic, type(message))
    publisher.publish(message)
    return publisher


def other_process(name):
    """Make a node of another participant, as that of another process is."""
    context = Context()
    rclpy.init(context=context, domain_id=runtime.domain_id)
    made = Node(name, context=context)
    elsewhere.append((context, made))
    return made


def stamped(kind, **more):
    """Make a message with a header as it should be."""
    message = kind(**more)
    message.header.frame_id = 'base_link'
    message.header.stamp = runtime.helper.get_clock().now().to_msg()
    return message


def scan(**more):
    """Make a laser scan as it should be."""
    usual = {
        'angle_min': -1.0,
        'angle_max': 1.0,
        'angle_increment': 0.5,
        'range_min': 0.1,
        'range_max': 3.5,
        'ranges': [1.0] * 5,
    }
    return stamped(LaserScan, **{**usual, **more})


def all_named(count):
    """Wait until the graph knows as many nodes as there are, and whose each end is."""
    helper: Any = runtime.helper
    lab.wait_until(
        lambda: len(helper.get_node_names()) >= count and is_whole(helper),
        timeout_sec=20,
    )


def served(name, servers):
    """Wait until the graph has so many servers of a service, and one client.

    The name of a node may come before its ends.
    """
    helper: Any = runtime.helper
    lab.wait_until(
        lambda: (helper.count_services(name), helper.count_clients(name)) == (servers, 1),
        timeout_sec=20,
    )


def look():
    """Print what is told now."""
    found = watch.look()
    for fault in found:
        assert str(fault) and fault.advice, fault
        assert len(str(fault)) < 400, fault
    print('TOLD', *sorted({fault.kind.id for fault in found}))
    print('ALOUD', *sorted({fault.kind.id for fault in found if fault.is_aloud}))
    print(in_words(found))


def clean():
    """End all that a case has made."""
    for context, made in elsewhere:
        made.destroy_node()
        rclpy.shutdown(context=context)
    elsewhere.clear()
    lab.stop()
    lab.start()
