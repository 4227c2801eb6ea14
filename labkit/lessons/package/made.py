"""A package with faults in it, to be repaired."""

from __future__ import annotations

import shutil
from pathlib import Path

from labkit.lessons.package.workspace import make_workspace

__all__ = ['BROKEN', 'make_broken']

BROKEN = 'broken_lab'
_NODE = """\
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class {name}(Node):
    def __init__(self):
        super().__init__('{node}')
        {body}

    def {method}


def main(args=None):
    rclpy.init(args=args)
    node = {name}()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
"""
_TALKER = _NODE.format(
    name='Talker',
    node='talker',
    body="self.publisher = self.create_publisher(String, 'news', 10)\n"
    '        self.timer = self.create_timer(0.2, self.on_timer)',
    method="on_timer(self):\n        self.publisher.publish(String(data='news'))",
)
_LISTENER = _NODE.format(
    name='Listener',
    node='listener',
    body="self.subscription = self.create_subscription(String, 'news', self.on_news, 10)",
    method='on_news(self, msg):\n        self.get_logger().info(msg.data)',
)


def make_broken() -> Path:
    """Make the package `broken_lab` in the workspace anew, with a fault in each of two lines.

    Returns:
        Its setup.py, where both faults are.
    """
    from labkit.packages.skeleton import Part, Skeleton

    folder = make_workspace() / 'src' / BROKEN
    shutil.rmtree(folder, ignore_errors=True)
    package = Skeleton(
        name=BROKEN,
        maintainer='me',
        email='me@example.org',
        description='A talker and a listener',
        license='Apache-2.0',
        dependencies=['rclpy', 'std_msgs'],
        test_dependencies=['python3-pytest'],
        scripts=[
            ('talker', f'{BROKEN}.talker:main'),
            ('listener', f'{BROKEN}.listener:mian'),
        ],
    )
    parts = [
        *package.parts(),
        Part(f'{BROKEN}/talker.py', _TALKER),
        Part(f'{BROKEN}/listener.py', _LISTENER),
    ]
    for part in parts:
        part.write(folder)
    path = folder / 'setup.py'
    path.write_text(path.read_text().replace("talker:main',\n", "talker:main'\n"))
    return path
