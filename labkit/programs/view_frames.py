"""`ros2 run tf2_tools view_frames`: a picture of the tree of frames, as a file.

It does what the real one does (ros2/geometry2, branch jazzy, tf2_tools/tf2_tools/view_frames.py),
for machines where that is not installed: five seconds of listening, a file for Graphviz, and its
PDF if Graphviz is there.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.utilities import remove_ros_args, try_shutdown

from labkit.errors import LabError
from labkit.files import write_atomically
from labkit.transforms.buffer import Buffer
from labkit.transforms.cache import NANOSECONDS
from labkit.transforms.transform_listener import TransformListener
from labkit.transforms.tree import Edge

__all__ = ['as_dot', 'main']


def as_dot(edges: list[Edge], now: float) -> str:
    """Return the tree for Graphviz; `now` is the time at which it was recorded, s."""
    if not edges:
        return 'digraph G { "No tf data received" }'
    lines = ['digraph G {']
    for edge in edges:
        latest, oldest = edge.latest / NANOSECONDS, edge.oldest / NANOSECONDS
        label = (
            f' Broadcaster: {_escaped(edge.authority)}\\nAverage rate: {round(edge.rate, 3)}\\n'
            f'Buffer length: {round(latest - oldest, 3)}\\n'
            f'Most recent transform: {round(latest, 6)}\\nOldest transform: {round(oldest, 6)}\\n'
        )
        lines.append(f'"{_escaped(edge.parent)}" -> "{_escaped(edge.child)}"[label="{label}"];')
    children = {edge.child for edge in edges}
    roots = [edge.parent for edge in edges if edge.parent not in children] or [edges[0].parent]
    lines += [
        'edge [style=invis];',
        ' subgraph cluster_legend { style=bold; color=black; label ="view_frames Result";',
        f'"Recorded at time: {now}"[ shape=plaintext ] ;',
        f'}}->"{_escaped(roots[-1])}";',
        '}',
    ]
    return '\n'.join(lines)


def _escaped(text: str) -> str:
    return text.replace('\\', '\\\\').replace('"', '\\"')


def _listen(node: Node, buffer: Buffer, seconds: float) -> None:
    TransformListener(buffer, node)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.1)


def _draw(node: Node, buffer: Buffer, name: str) -> None:
    log: Any = node.get_logger()  # type: ignore[no-untyped-call]
    log.info('Generating graph...')
    told = f'tf2_msgs.srv.FrameGraph_Response(frame_yaml={buffer.all_frames_as_yaml()!r})'
    log.info(f'Result:{told}')
    file, picture = Path(f'{name}.gv'), Path(f'{name}.pdf')
    log.info(f'Exporting graph in {picture} file...')
    now = node.get_clock().now().nanoseconds / NANOSECONDS
    write_atomically(file, as_dot(buffer.tree.edges(), now).encode())
    dot = shutil.which('dot')
    if dot is None:
        raise LabError(
            f'{file} is written. {picture} is not, for there is no Graphviz here.',
            todo='sudo apt install graphviz',
        )
    subprocess.run([dot, '-Tpdf', str(file), '-o', str(picture)], check=False)


def main() -> None:
    """Listen, and write the files."""
    parser = argparse.ArgumentParser(
        prog='view_frames',
        description='Create a diagram of the TF frames being broadcast over ROS',
    )
    parser.add_argument(
        *('--wait-time', '-t'),
        type=float,
        default=5.0,
        help='Listen to the /tf topic for this many seconds before rendering the frame tree',
    )
    parser.add_argument('-o', '--output', help='Output filename')
    words = parser.parse_args(remove_ros_args(sys.argv)[1:])
    rclpy.init(args=sys.argv)
    node = Node('view_frames')
    buffer = Buffer()
    node.get_logger().info(f'Listening to tf data for {words.wait_time} seconds...')  # type: ignore[no-untyped-call]
    try:
        _listen(node, buffer, words.wait_time)
        _draw(node, buffer, words.output or time.strftime('frames_%Y-%m-%d_%H.%M.%S'))
    except LabError as error:
        sys.exit(str(error))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        try_shutdown()


if __name__ == '__main__':
    main()
