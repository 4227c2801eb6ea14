"""A package that does not name what it needs."""

from __future__ import annotations

from pathlib import Path

from labkit.files import replaced
from labkit.lessons.package.learner_workspace import make_workspace

__all__ = ['COURIER', 'make_courier']

COURIER = 'courier_lab'
_MODULE = """\
import math

import rclpy
from geometry_msgs.msg import Point
from rclpy.node import Node
from std_msgs.msg import String


class Courier(Node):
    def __init__(self):
        super().__init__('courier')
        self.place = self.create_publisher(Point, 'place', 10)
        self.news = self.create_publisher(String, 'news', 10)
        self.timer = self.create_timer(0.2, self.on_timer)
        self.angle = 0.0

    def on_timer(self):
        self.angle += 0.1
        self.place.publish(Point(x=math.cos(self.angle), y=math.sin(self.angle)))
        self.news.publish(String(data='on the way'))


def main(args=None):
    rclpy.init(args=args)
    node = Courier()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
"""


def make_courier() -> Path:
    """Make the package `courier_lab` in the workspace anew; its package.xml names `rclpy` alone.

    Returns:
        Its folder.
    """
    from labkit.packages.skeleton import Part, Skeleton

    folder = make_workspace() / 'src' / COURIER
    package = Skeleton(
        name=COURIER,
        maintainer='me',
        email='me@example.org',
        description='A courier that tells where it is',
        license='Apache-2.0',
        dependencies=['rclpy'],
        test_dependencies=['python3-pytest'],
        scripts=[('courier', f'{COURIER}.courier:main')],
    )
    with replaced(folder):
        for part in [*package.parts(), Part(f'{COURIER}/courier.py', _MODULE)]:
            part.write(folder)
    return folder
