"""Hard days for a notebook. Each trial does harm, and tells in figures what was left standing.

A trial is a function of a `Bench`, which has kernels, chance with a seed, and a size. It fails by
an assertion. `python tests/torture` runs all of them, `--small` in a few minutes. Two have found
faults that are mended: `buttons`, modules that stayed half loaded; `full`, programs of a notebook
that did not start where no log can be written.
"""

from __future__ import annotations

import json
import random
import re
import signal
import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import nbformat
from background.talker import LOCALHOST

ROOT = Path(__file__).resolve().parents[2]
LESSONS = sorted((ROOT / 'notebooks').glob('*.ipynb'))
CELL_SEC = 300.0
# What a person expects of cells in a wrong order: a name that is not there yet, or one that is
# there as something else; and what labkit says in words.
EXPECTED = re.compile(
    r'NameError: name|LabError: |LabTimeout: |NoSuchNameError: |_NotInWheels: |KeyboardInterrupt'
    r'|AttributeError: .* object has no attribute|AttributeError: module'
    # rclpy itself, where the cell that imports labkit comes later.
    r'|NotInitializedException: rclpy.init\(\) has not been called'
    # A node that ended with its name's next one, whose cell was interrupted before it was kept.
    r'|InvalidHandle: cannot use Destroyable because destruction was requested'
)


@dataclass
class Bench:
    """What a trial works with.

    Attributes:
        start: Starts a kernel; keyword arguments are environment variables.
        rng: Chance.
        large: Whether to do it for long.
    """

    start: Callable[..., Any]
    rng: random.Random
    large: bool

    def lessons(self) -> list[Path]:
        """Return the lessons: all that need nobody at the keyboard, or a quick one."""
        if self.large:
            return [path for path in LESSONS if not path.name.startswith(('06', '12'))]
        return [path for path in LESSONS if path.name.startswith('02')]


def _cells(path: Path) -> list[Any]:
    return [cell for cell in nbformat.read(path, 4).cells if cell.cell_type == 'code']


def _may_fail(cell: Any) -> bool:
    return 'raises-exception' in cell.metadata.get('tags', ())


def _counts(kernel: Any) -> dict[str, int]:
    """Return what a kernel holds once all its nodes are gone."""
    code = (
        'import gc, json, os, threading\nimport labkit as lab\nlab.stop()\ngc.collect()\n'
        'print(json.dumps({"threads": len(os.listdir("/proc/self/task")), '
        '"files": len(os.listdir("/proc/self/fd"))}))'
    )
    result = kernel.run(code)
    assert not result.error, result.traceback
    found: dict[str, int] = json.loads(result.text.splitlines()[-1])
    return found


def _works(kernel: Any) -> None:
    """Check that a new learner could begin here: a talker is heard, the check says its word."""
    result = kernel.run(HEARD, CELL_SEC)
    assert (result.error, result.text.splitlines()[-1:]) == ('', ['heard']), (result, kernel.log)


HEARD = """
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import String
lab.stop()
_node, _heard = Node('after_all'), []
_node.create_subscription(String, '/after_all', _heard.append, 10)
_publisher = _node.create_publisher(String, '/after_all', 10)
lab.spin(_node)
_publisher.publish(String(data='hello'))
lab.wait_until(lambda: _heard, timeout_sec=60)
lab.stop()
print('heard')
"""


# --- Lessons -------------------------------------------------------------------------------------


def thrice(bench: Bench) -> str:
    """Run lessons three times in one kernel: the same comes out, and nothing is left over."""
    grown: Counter[str] = Counter()
    cells_run = 0
    for path in bench.lessons():
        kernel = bench.start(**LOCALHOST)
        held = []
        for _ in range(3):
            for cell in _cells(path):
                result = kernel.run(cell.source, CELL_SEC, cell_id=cell.id)
                assert not result.error or _may_fail(cell), (path.name, cell.id, result.error)
                cells_run += 1
            held.append(_counts(kernel))
        # The first run loads what is loaded once.
        for kind in held[1]:
            more = held[2][kind] - held[1][kind]
            grown[kind] += more
            assert more <= 0, (path.name, kind, [each[kind] for each in held])
        kernel.close()
    return f'{cells_run} cells; left over: {dict(grown)}'


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
        cells = _cells(path)
        bench.rng.shuffle(cells)
        for cell in cells:
            result = kernel.run(cell.source, CELL_SEC, cell_id=cell.id)
            if not result.error or _may_fail(cell):
                continue
            errors[result.error.partition(':')[0]] += 1
            told = (path.name, number, cell.id, result.traceback)
            assert EXPECTED.match(result.error), told
            assert '/labkit/' not in result.traceback, told
        assert not kernel.run('%reset -f').error
        _works(kernel)
    for kernel in kernels.values():
        kernel.close()
    return f'{orders} orders; errors: {dict(errors)}'


# --- The stop button, and worse ------------------------------------------------------------------


def buttons(bench: Bench) -> str:
    """Press the stop button at random moments of cells and checks, and while all is loaded."""
    presses = 300 if bench.large else 10
    kernel = bench.start()
    cells = [cell for path in bench.lessons()[:3] for cell in _cells(path)]
    seen: Counter[str] = Counter()
    for number in range(presses):
        cell = cells[number % len(cells)]
        press = threading.Timer(bench.rng.random() * 0.5, kernel.interrupt)
        request = kernel.start(cell.source, cell.id)
        press.start()
        press.join()
        result = kernel.finish(request, CELL_SEC)
        error = result.error.partition(':')[0]
        seen[error or 'no error'] += 1
        assert not error or _may_fail(cell) or EXPECTED.match(result.error), (cell.id, result)
    _works(kernel)
    kernel.close()
    loads = 30 if bench.large else 3
    for _ in range(loads):
        kernel = bench.start()
        request = kernel.start(HEARD)
        time.sleep(bench.rng.random())
        kernel.interrupt()
        result = kernel.finish(request)
        assert result.error in ('', 'KeyboardInterrupt: '), result
        seen[result.error.partition(':')[0] or 'no error'] += 1
        _works(kernel)
        kernel.close()
    return f'{presses} presses, {loads} while all is loaded: {dict(seen)}'


RECORD = """
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import String
class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.create_timer(0.002, lambda: self.publisher.publish(String(data='hello')))
lab.spin(Talker())
lesson = lab.lesson('talker_listener')
recording = lab.record('day', '/chatter')
recording.wait_for(1)
while not sum(topic.count for topic in lab.bag('day').topics):
    pass
print('begun', flush=True)
while True:
    lesson.every_two_seconds.check()
"""
READ = """
import labkit as lab
from labkit.exercises.progress_store import progress_store
data, note = progress_store.store.read()
print('progress:', len(data['lessons']), note)
print('in the bag:', sum(topic.count for topic in lab.bag('day').topics))
"""


def killed(bench: Bench) -> str:
    """Kill kernels while they record and check: bag and progress can be read afterwards."""
    deaths = 20 if bench.large else 2
    messages = 0
    for _ in range(deaths):
        kernel = bench.start()
        request = kernel.start(RECORD)
        kernel.wait_for_output(request, 'begun', CELL_SEC)
        time.sleep(bench.rng.random())
        kernel.process.send_signal(signal.SIGKILL)
        kernel.process.wait()
        reader = bench.start()
        assert not reader.run(f'%cd -q {kernel.folder}').error
        result = reader.run(READ)
        assert not result.error, result.traceback
        read = int(re.findall(r'in the bag: (\d+)', result.text)[0])
        assert read, result.text
        messages += read
        _works(reader)
        reader.close()
        kernel.close()
    return f'{deaths} kills; {messages} messages read back'


FULL = """
import resource
_before = resource.getrlimit(resource.RLIMIT_FSIZE)
resource.setrlimit(resource.RLIMIT_FSIZE, (0, _before[1]))
"""
FREE = 'resource.setrlimit(resource.RLIMIT_FSIZE, _before)'


def full(bench: Bench) -> str:
    """Let no file grow, and no folder be made: work goes on, and what is not kept is told."""
    kernel = bench.start()
    cells = {cell.id: cell for cell in _cells(bench.lessons()[0])}
    assert not kernel.run(RECORD.partition('recording =')[0]).error
    assert not kernel.run(FULL).error
    check = kernel.run('lesson.every_two_seconds.check()')
    assert not check.error, check.traceback
    recording = kernel.run('lab.record("day", "/chatter")')
    assert recording.error.startswith('LabError'), recording
    assert not kernel.run(FREE).error
    again = kernel.run('with lab.record("day", "/chatter") as r: r.wait_for(3)')
    assert not again.error, (recording.error, again.traceback)
    _works(kernel)
    kernel.close()
    # /proc takes no new files, from nobody.
    nowhere = bench.start(**LOCALHOST, LABKIT_HOME='/proc/labkit', HOME='/proc')
    for cell in cells.values():
        result = nowhere.run(cell.source, CELL_SEC, cell_id=cell.id)
        assert not result.error or _may_fail(cell), (cell.id, result.traceback)
    _works(nowhere)
    nowhere.close()
    return f'{len(cells)} cells without a home'


# --- Much, and wild ------------------------------------------------------------------------------

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
    _works(kernel)
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
    _works(kernel)
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
        _works(kernel)
        kernel.close()
    return f'{shown} values in {len(VIEWS)} views'


TRIALS: dict[str, Callable[[Bench], str]] = {
    trial.__name__: trial for trial in (thrice, shuffled, buttons, killed, full, many, large, wild)
}
