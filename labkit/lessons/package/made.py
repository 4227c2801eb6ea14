"""A package with faults in it, to be repaired."""

from __future__ import annotations

import os
from pathlib import Path

from labkit.files import replaced
from labkit.lessons.package.learner_workspace import NAME, workspace

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
_TELLER = _NODE.format(
    name='Teller',
    node='teller',
    body="self.publisher = self.create_publisher(String, 'news', 10)\n"
    '        self.timer = self.create_timer(0.2, self.on_timer)',
    method="on_timer(self):\n        self.publisher.publish(String(data='news'))",
)
_HEARER = _NODE.format(
    name='Hearer',
    node='hearer',
    body="self.subscription = self.create_subscription(String, 'news', self.on_news, 10)",
    method='on_news(self, msg):\n        self.get_logger().info(msg.data)',
)


def make_broken(*, overwrite: bool = False) -> str:
    """Make the package `broken_lab` in the workspace, with a fault in each of two lines.

    Args:
        overwrite: Whether to make it anew if it is there.

    Returns:
        Where its setup.py is.
    """
    from labkit.packages.skeleton import Part, Skeleton

    folder = (workspace() or Path(NAME)) / 'src' / BROKEN
    path = folder / 'setup.py'
    if folder.exists() and not overwrite:
        return os.path.relpath(path)
    package = Skeleton(
        name=BROKEN,
        maintainer='me',
        email='me@example.org',
        description='A teller and a hearer',
        license='Apache-2.0',
        dependencies=['rclpy', 'std_msgs'],
        test_dependencies=['python3-pytest'],
        scripts=[
            ('teller', f'{BROKEN}.teller:main'),
            ('hearer', f'{BROKEN}.hearer:mian'),
        ],
    )
    parts = [
        *package.parts(),
        Part(f'{BROKEN}/teller.py', _TELLER),
        Part(f'{BROKEN}/hearer.py', _HEARER),
    ]
    folder.parent.mkdir(parents=True, exist_ok=True)
    with replaced(folder):
        for part in parts:
            part.write(folder)
        path.write_text(path.read_text().replace("teller:main',\n", "teller:main'\n"))
    return os.path.relpath(path)
