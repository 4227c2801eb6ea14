"""What live views cost at 1,000 messages a second: the page, the kernel, and who waits for it."""

from __future__ import annotations

import statistics
import time
from collections.abc import Iterator

from kernel import Kernel
from table import Row

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


def tables(quick: bool) -> Iterator[tuple[str, list[Row]]]:
    """Measure, and give title and rows of the table."""
    seconds, rounds = (1, 5) if quick else (5, 100)
    rows: dict[str, list[Row]] = {}
    with Kernel() as kernel:
        kernel.run(TALKER)
        for name, code in VIEWS.items():
            if code:
                kernel.run(f'{code}\n{SEEN}')
                sizes = kernel.comm_messages(seconds)
                rows.setdefault('page', []).extend(
                    [
                        Row(f'to the page: {name}', len(sizes) / seconds, 'updates/s', at_most=20),
                        Row(f'to the page: {name}', sum(sizes) / seconds / 1e3, 'kB/s'),
                    ]
                )
                kernel.run(SEEN)
            begin, before = time.perf_counter(), float(kernel.run(POSITION))
            share = kernel.cpu_share(seconds)
            sent = 1000 * (float(kernel.run(POSITION)) - before) / (time.perf_counter() - begin)
            rows.setdefault('sent', []).append(Row(f'published: {name}', sent, 'messages/s'))
            cpu = rows.setdefault('cpu', [])
            cpu.append(Row(f'CPU: {name}', share, '% of a core'))
            if code:
                more = share - (cpu[0].figure or 0)
                cpu.append(Row(f'CPU: {name}, beyond no view', more, '% of a core', at_most=10))
            if code:
                kernel.run(SEEN)
            delays = []
            for _ in range(rounds):
                begin = time.perf_counter()
                kernel.run('pass')
                delays.append(1e3 * (time.perf_counter() - begin))
            rows.setdefault('cell', []).append(
                Row(f'an empty cell: {name}', statistics.median(delays), 'ms')
            )
            if code:
                kernel.run('view.close()')
    yield (
        'Live views at 1,000 Odometry messages a second',
        [r for part in rows.values() for r in part],
    )
