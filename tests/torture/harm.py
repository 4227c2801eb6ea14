"""The stop button, kill -9, a full disk, a clock that is set: what goes on afterwards."""

from __future__ import annotations

import re
import signal
import subprocess
import threading
import time
from collections import Counter
from pathlib import Path

from background.talker import LOCALHOST
from torture.bench import CELL_SEC, EXPECTED, HEARD, Bench, code_cells, may_fail, works


def buttons(bench: Bench) -> str:
    """Press the stop button at random moments of cells and checks, and while all is loaded."""
    presses = 300 if bench.large else 10
    kernel = bench.start()
    cells = [cell for path in bench.lessons()[:3] for cell in code_cells(path)]
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
        assert not error or may_fail(cell) or EXPECTED.match(result.error), (cell.id, result)
    works(kernel)
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
        works(kernel)
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
from labkit.exercises.record.progress_store import progress_store
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
        works(reader)
        reader.close()
        kernel.close()
    return f'{deaths} kills; {messages} messages read back'


PACKAGE = """
%%bash
mkdir -p ws/src && cd ws/src
ros2 pkg create pack_lab --build-type ament_python --node-name program --license Apache-2.0
"""
BUILD = "import labkit as lab\nprint('begun', flush=True)\nlab.build('ws')"


def rebuilt(bench: Bench) -> str:
    """Kill kernels while they build: the next one builds the package, and its program runs."""
    deaths = 20 if bench.large else 2
    for _ in range(deaths):
        kernel = bench.start(**LOCALHOST)
        made = kernel.run(PACKAGE.lstrip())
        assert not made.error, made.traceback
        request = kernel.start(BUILD)
        kernel.wait_for_output(request, 'begun', CELL_SEC)
        time.sleep(bench.rng.random() * 2)
        kernel.process.send_signal(signal.SIGKILL)
        kernel.process.wait()
        next_one = bench.start(**LOCALHOST)
        assert not next_one.run(f'%cd -q {kernel.folder}').error
        works(next_one)
        built = next_one.run(BUILD, CELL_SEC)
        assert not built.error, built.traceback
        ran = next_one.run('!ros2 run pack_lab program')
        assert 'Hi from pack_lab.' in ran.text, ran
        next_one.close()
        kernel.close()
    return f'{deaths} kills'


FULL = """
import resource
_before = resource.getrlimit(resource.RLIMIT_FSIZE)
resource.setrlimit(resource.RLIMIT_FSIZE, (0, _before[1]))
"""
FREE = 'resource.setrlimit(resource.RLIMIT_FSIZE, _before)'


def full(bench: Bench) -> str:
    """Let no file grow, and no folder be made: work goes on, and what is not kept is told."""
    kernel = bench.start()
    cells = {cell.id: cell for cell in code_cells(bench.lessons()[0])}
    assert not kernel.run(RECORD.partition('recording =')[0]).error
    assert not kernel.run(FULL).error
    check = kernel.run('lesson.every_two_seconds.check()')
    assert not check.error, check.traceback
    recording = kernel.run('lab.record("day", "/chatter")')
    assert recording.error.startswith('LabError'), recording
    assert not kernel.run(FREE).error
    again = kernel.run('with lab.record("day", "/chatter") as r: r.wait_for(3)')
    assert not again.error, (recording.error, again.traceback)
    works(kernel)
    kernel.close()
    # /proc takes no new files, from nobody.
    nowhere = bench.start(**LOCALHOST, LABKIT_HOME='/proc/labkit', HOME='/proc')
    for cell in cells.values():
        result = nowhere.run(cell.source, CELL_SEC, cell_id=cell.id)
        assert not result.error or may_fail(cell), (cell.id, result.traceback)
    works(nowhere)
    nowhere.close()
    return f'{len(cells)} cells without a home'


TICKING = """
import ctypes, labkit as lab
from rclpy.node import Node
lab.stop()
ticks = []
def tick(): ticks.append(1)
node = Node('ticking')
node.create_timer(0.01, tick)
lab.spin(node)
lab.wait_until(lambda: len(ticks) > 5, timeout_sec=60)
"""
SHIFTED = """
ctypes.CDLL({library!r}).shift_wall_clock({seconds})
ticks.clear()
if {seconds} > 0:
    lab.wait_until(lambda: len(ticks) > 5, timeout_sec=60)
"""


def clock(bench: Bench) -> str:
    """Set the clock of the machine: ahead, all goes on; back, what is made anew does.

    A timer of ROS goes by the time of day: set back, it waits until that time comes again. So it
    does in a terminal.
    """
    folder = bench.start().folder
    library = str(folder / 'wall_clock.so')
    source = str(Path(__file__).with_name('wall_clock.c'))
    subprocess.run(['cc', '-shared', '-fPIC', '-o', library, source, '-ldl'], check=True)
    kernel = bench.start(**LOCALHOST, LD_PRELOAD=library)
    jumps = 20 if bench.large else 1
    for _ in range(jumps):
        for seconds in (bench.rng.randint(1, 100_000), -bench.rng.randint(1, 100_000)):
            assert not kernel.run(TICKING).error
            shifted = kernel.run(SHIFTED.format(library=library, seconds=seconds), CELL_SEC)
            assert not shifted.error, (seconds, shifted.traceback)
            works(kernel)
            for cell in code_cells(bench.lessons()[0]):
                result = kernel.run(cell.source, CELL_SEC, cell_id=cell.id)
                assert not result.error or may_fail(cell), (seconds, cell.id, result.traceback)
    kernel.close()
    return f'{jumps} jumps ahead and back, a lesson after each'
