"""Hard days for a notebook. Each trial does harm, and tells in figures what was left standing.

A trial is a function of a `Bench`, which has kernels, chance with a seed, and a size. It fails by
an assertion. Two have found faults that are mended: `buttons`, modules that stayed half loaded;
`full`, programs of a notebook that did not start where no log can be written.
"""

from __future__ import annotations

import json
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from background.talker import LOCALHOST
from torture.bench import CELL_SEC, EXPECTED, Bench, code_cells, may_fail, works
from torture.harm import buttons, clock, full, killed, rebuilt

# So long a person waits for a cell before pressing the stop button, s.
WAITS_SEC = 60.0


def counts(kernel: Any) -> dict[str, int]:
    """Return what a kernel holds once all its nodes are gone."""
    code = (
        'import gc, json, os, threading\nimport labkit as lab\nlab.stop()\ngc.collect()\n'
        'print(json.dumps({"threads": len(os.listdir("/proc/self/task")), '
        '"files": len(os.listdir("/proc/self/fd"))}))'
    )
    result = kernel.run(code)
    assert not result.error, result.traceback
    # A line of somebody's log may come after it.
    [line] = [each for each in result.text.splitlines() if each.startswith('{"threads"')]
    found: dict[str, int] = json.loads(line)
    return found


def thrice(bench: Bench) -> str:
    """Run lessons three times in one kernel: the same comes out, and nothing is left over."""
    grown: Counter[str] = Counter()
    cells_run = 0
    for path in bench.lessons():
        kernel = bench.start(**LOCALHOST)
        held = []
        for _ in range(3):
            for cell in code_cells(path):
                result = kernel.run(cell.source, CELL_SEC, cell_id=cell.id)
                assert not result.error or may_fail(cell), (path.name, cell.id, result.error)
                cells_run += 1
            held.append(counts(kernel))
        # One more may be about for a while: a thread that has printed keeps its own way to the
        # page until it is collected. What is left over is more after each run.
        for kind in held[0]:
            first, second, third = (each[kind] for each in held)
            grown[kind] += third - first
            assert not first < second < third, (path.name, kind, [first, second, third])
        kernel.close()
    return f'{cells_run} cells; left over: {dict(grown)}'


@contextmanager
def pressing_stop(kernel: Any) -> Iterator[None]:
    """Press the stop button now and then: who is waited for may not be there in this order.

    As in a terminal, `ros2 topic echo --once` waits, and the next command of the cell as well.
    """
    done = threading.Event()

    def press() -> None:
        while not done.wait(WAITS_SEC):
            kernel.interrupt()

    thread = threading.Thread(target=press)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


def shuffled(bench: Bench) -> str:
    """Run lessons in random orders: errors are those that a person expects, in few words."""
    lessons = bench.lessons()
    orders = 2 * len(lessons)
    kernels: dict[Path, Any] = {}
    errors: Counter[str] = Counter()
    for number in range(orders):
        path = lessons[number % len(lessons)]
        if path not in kernels:
            kernels[path] = bench.start(**LOCALHOST)
        kernel = kernels[path]
        cells = code_cells(path)
        bench.rng.shuffle(cells)
        for cell in cells:
            with pressing_stop(kernel):
                result = kernel.run(cell.source, 10 * WAITS_SEC, cell_id=cell.id)
            if not result.error or may_fail(cell):
                continue
            errors[result.error.partition(':')[0]] += 1
            told = (path.name, number, cell.id, result.traceback)
            assert EXPECTED.match(result.error), told
            assert '/labkit/' not in result.traceback, told
        assert not kernel.run('%reset -f').error
        works(kernel)
    for kernel in kernels.values():
        kernel.close()
    return f'{orders} orders; errors: {dict(errors)}'


MANY = """
import time, psutil, labkit as lab
from rclpy.node import Node
from std_msgs.msg import String
lab.stop()
begin = time.monotonic()
many = [lab.spin(Node(f'node_{{n}}')) for n in range({nodes})]
for n in range({topics}):
    many[n % len(many)].create_publisher(String, f'topic_{{n}}', 1)
print(f'{{time.monotonic() - begin:.1f}} s, {{psutil.Process().memory_info().rss / 1e6:.0f}} MB')
"""


def many(bench: Bench) -> str:
    """Have very many nodes and topics, list them, draw them, end them."""
    # Each node of a process costs as much as there are, so that a thousand take 25 times as long
    # as 200.
    nodes, topics = (300, 3_000) if bench.large else (40, 200)
    kernel = bench.start()
    made = kernel.run(MANY.format(nodes=nodes, topics=topics), CELL_SEC)
    assert not made.error, made.traceback
    listed = kernel.run('%ros2 node list', CELL_SEC)
    assert listed.text.count('/node_') == nodes
    assert kernel.run('%ros2 topic list', CELL_SEC).text.count('/topic_') == topics
    drawn = kernel.run('lab.graph(live=False)', CELL_SEC)
    assert not drawn.error, drawn.traceback
    begin = time.monotonic()
    works(kernel)
    kernel.close()
    ended = time.monotonic() - begin
    return f'{nodes} nodes, {topics} topics: made in {made.text.strip()}, ended in {ended:.1f} s'


LARGE = """
import time, labkit as lab
from rclpy.node import Node
from std_msgs.msg import UInt8MultiArray
lab.stop()
node, sizes = Node('large'), []
node.create_subscription(UInt8MultiArray, '/large', lambda m: sizes.append(len(m.data)), 10)
publisher = node.create_publisher(UInt8MultiArray, '/large', 10)
lab.spin(node)
message, begin = UInt8MultiArray(data=bytes({size})), time.monotonic()
for n in range({count}):
    publisher.publish(message)
    lab.wait_until(lambda: len(sizes) > n, timeout_sec=60)
print(set(sizes) == {{ {size} }}, f'{{(time.monotonic() - begin) / {count}:.3f}} s each')
"""


def large(bench: Bench) -> str:
    """Send messages of ten megabytes."""
    count = 50 if bench.large else 3
    kernel = bench.start()
    result = kernel.run(LARGE.format(size=10_000_000, count=count), CELL_SEC)
    assert not result.error and result.text.startswith('True'), result
    works(kernel)
    kernel.close()
    return f'{count} of 10 MB, {result.text.split(maxsplit=1)[1].strip()}'


HOSTILE = '</script><img src=x onerror="alert(1)">\\u202e\\x1b[2J' + 'x' * 2000
WILD = """
import math, labkit as lab
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import Image, LaserScan
from std_msgs.msg import Float64, String
lab.stop()
node = Node('wild')
topics = dict(number=Float64, odom=Odometry, scan=LaserScan, picture=Image, text=String, cmd=Twist)
out = {{name: node.create_publisher(kind, name, 10) for name, kind in topics.items()}}
node.declare_parameter('text', {hostile!r})
lab.spin(node)
def say(value):
    odom, scan = Odometry(child_frame_id={hostile!r}), LaserScan(ranges=[value] * 8)
    odom.pose.pose.position.x = odom.pose.pose.orientation.w = odom.twist.twist.linear.x = value
    scan.angle_min = scan.angle_increment = scan.range_max = value
    picture = Image(height=2, width=2, encoding='32FC1', step=8, data=bytes(16))
    picture.header.frame_id = {hostile!r}
    command = Twist()
    command.linear.x = value
    sent = dict(number=Float64(data=value), odom=odom, scan=scan, picture=picture,
                text=String(data={hostile!r}), cmd=command)
    for name, message in sent.items():
        out[name].publish(message)
    node.get_logger().warn({hostile!r})
"""
VIEWS = (
    "lab.plot('/number.data', '/odom.pose.pose.position.x')",
    'lab.arena()',
    "lab.image('/picture')",
    *(f"lab.monitor('/{name}')" for name in ('number', 'odom', 'scan', 'text')),
    'lab.graph()',
    'lab.graph(live=False)',
    'node',
)
# Narrower fields of messages take less.
VALUES = ('math.nan', 'math.inf', '-math.inf', '1e308', '-1e308', '5e-324', '3.4e38')


def wild(bench: Bench) -> str:
    """Show numbers that are none, and texts that want to run, in every view."""
    shown = 0
    for view in VIEWS:
        kernel = bench.start()
        assert not kernel.run(WILD.format(hostile=HOSTILE)).error
        request = kernel.start(f'view = {view}\nview')
        begun = kernel.finish(request, CELL_SEC)
        assert not begun.error, begun.traceback
        for value in VALUES:
            said = kernel.run(
                f'try: say({value})\nexcept (AssertionError, ValueError): pass\n'
                'lab.wait_until(lambda: True, timeout_sec=1)',
                CELL_SEC,
            )
            assert not said.error, (view, value, said.traceback)
        assert not kernel.run(f'again = {view}\nagain').error
        outputs = kernel.outputs_of(request, updated=True)
        text = json.dumps([output.get('data', {}).get('text/html', '') for output in outputs])
        assert '<img src=x' not in text and '</script><img' not in text, (view, text)
        assert 'Traceback' not in json.dumps(outputs), (view, outputs)
        shown += len(VALUES)
        works(kernel)
        kernel.close()
    return f'{shown} values in {len(VIEWS)} views'


TRIALS: dict[str, Callable[[Bench], str]] = {
    trial.__name__: trial
    for trial in (thrice, shuffled, buttons, killed, rebuilt, full, clock, many, large, wild)
}
