"""What live views cost at 1,000 messages a second: the page, the kernel, and who waits for it."""

from __future__ import annotations

import statistics
import time
from collections.abc import Iterator, Mapping
from functools import partial

from kernel import Kernel
from table import Row
from turns import Figures, take_turns

__all__ = ['tables']

TALKER = """
import labkit as lab
from nav_msgs.msg import Odometry
from rclpy.node import Node

class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.message = Odometry()
        self.publisher = self.create_publisher(Odometry, 'odom', 10)
        self.create_timer(0.001, self.tick)

    def tick(self):
        self.message.pose.pose.position.x += 0.001
        self.publisher.publish(self.message)

talker = lab.spin(Talker())
"""
# As a page does that shows it.
VIEWS = {
    'no view': '',
    'monitor': "view = lab.monitor('/odom')",
    'plot': "view = lab.plot('/odom.pose.pose.position.x', '/odom.pose.pose.position.y')",
}
POSITION = 'print(talker.message.pose.pose.position.x)'
SEEN = "view._widget._handle_custom_msg({'view': 'seen'}, [])"


TITLE = 'Live views at 1,000 Odometry messages a second'


def tables(quick: bool) -> Iterator[tuple[str, list[Row]]]:
    """Measure, and give title and rows of the table."""
    seconds, rounds, turns = (1, 5, 1) if quick else (2, 25, 5)
    with Kernel() as kernel:
        kernel.run(TALKER)
        ways = {name: partial(_look, kernel, name, seconds, rounds) for name in VIEWS}
        seen = take_turns(ways, ('cpu',), turns)
    typical = {
        name: {key: statistics.median(each[key] for each in found) for key in found[0]}
        for name, found in seen.items()
    }
    yield TITLE, list(_rows(typical))


def _rows(typical: Mapping[str, Figures]) -> Iterator[Row]:
    views = [name for name, code in VIEWS.items() if code]
    for name in views:
        updates = typical[name]['updates']
        yield Row(f'to the page: {name}', updates, 'updates/s', at_most=20)
        yield Row(f'to the page: {name}', typical[name]['size'], 'kB/s')
    for name, figures in typical.items():
        yield Row(f'published: {name}', figures['sent'], 'messages/s')
        yield Row(f'CPU: {name}', figures['cpu'], '% of a core')
    for name in views:
        more = typical[name]['cpu'] - typical['no view']['cpu']
        yield Row(f'CPU: {name}, beyond no view', more, '% of a core', at_most=10)
    for name, figures in typical.items():
        yield Row(f'an empty cell: {name}', figures['delay'], 'ms')


def _look(kernel: Kernel, name: str, seconds: float, rounds: int) -> Figures:
    """Open a view, or none, measure for a while, and close it."""
    figures = {}
    if VIEWS[name]:
        kernel.run(f'{VIEWS[name]}\n{SEEN}')
        sizes = kernel.comm_messages(seconds)
        figures = {'updates': len(sizes) / seconds, 'size': sum(sizes) / seconds / 1e3}
        kernel.run(SEEN)
    begin, before = time.perf_counter(), float(kernel.run(POSITION))
    figures['cpu'] = kernel.cpu_share(seconds)
    sent = float(kernel.run(POSITION)) - before
    figures['sent'] = 1000 * sent / (time.perf_counter() - begin)
    delays = []
    if VIEWS[name]:
        kernel.run(SEEN)
    for _ in range(rounds):
        begin = time.perf_counter()
        kernel.run('pass')
        delays.append(1e3 * (time.perf_counter() - begin))
    if VIEWS[name]:
        kernel.run('view.close()')
    return {**figures, 'delay': statistics.median(delays)}
