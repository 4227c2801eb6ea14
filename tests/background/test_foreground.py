"""Spins in the foreground: what they raise comes out of them, as in a terminal."""

from __future__ import annotations

import pytest

SETUP = """
import os, signal, sys, threading, time
import labkit as lab
import rclpy
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future
from labkit.background.runtime import runtime

class Ticker(Node):
    def __init__(self, act, name='ticker', at=1):
        super().__init__(name)
        self.count, self.act, self.at = 0, act, at
        self.create_timer(0.01, self.on_timer)

    def on_timer(self):
        self.count += 1
        if self.count >= self.at:
            self.act()

def fail():
    1 / 0

def leave():
    sys.exit(3)

def press():
    raise KeyboardInterrupt

def press_when_it_waits():
    # In C, or for the background.
    def waits():
        frame = sys._current_frames()[threading.main_thread().ident]
        while frame is not None:
            if frame.f_code.co_name in ('wait_for', 'wait_for_ready_callbacks'):
                return True
            frame = frame.f_back
        return False

    def look():
        # Frames that run on while they are followed are no frames any more: no turn for others.
        usual = sys.getswitchinterval()
        sys.setswitchinterval(60)
        while not waits():
            time.sleep(0.001)
        sys.setswitchinterval(usual)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=look).start()

def tick():
    print('tick')

def names():
    spun = [entry.node for entry in runtime.nodes()]
    return [node.get_name() for node in [*spun, *runtime.unspun_nodes()]]

lab.start()
"""
OWN = 'executor = SingleThreadedExecutor()\n'
# Each way to spin `node` in the foreground.
SPINS = {
    'spin': 'rclpy.spin(node)',
    'spin_once': 'while True: rclpy.spin_once(node)',
    'until a future': 'rclpy.spin_until_future_complete(node, Future())',
    'own executor': OWN + 'executor.add_node(node)\nexecutor.spin()',
    'own executor once': OWN + 'executor.add_node(node)\nwhile True: executor.spin_once()',
    'with executor': OWN + 'rclpy.spin(node, executor)',
    'once with executor': OWN + 'while True: rclpy.spin_once(node, executor=executor)',
    'future with executor': OWN
    + 'rclpy.spin_until_future_complete(node, Future(), executor=executor)',
}
QUICK = ['spin', 'own executor']
_SLOW = pytest.mark.slow('one kernel for each way')
ALL = [each if each in QUICK else pytest.param(each, marks=_SLOW) for each in SPINS]


def tried(spin: str, rest: str) -> str:
    """Return a program with a spin in its `try`."""
    return 'try:\n' + ''.join(f'    {line}\n' for line in spin.splitlines()) + rest


def caught(spin: str, what: str) -> str:
    """Return a program that catches what comes out of a spin."""
    return tried(spin, f'except {what} as error:\n    print("caught", repr(error))\n')


@pytest.mark.parametrize('how', ALL)
def test_what_a_callback_raises_comes_out_and_nothing_runs_after_it(kernel, how):
    kernel.run(SETUP)
    result = kernel.run(
        'node = Ticker(fail, at=3)\n'
        + caught(SPINS[how], 'ZeroDivisionError')
        + 'other = lab.spin(Ticker(lambda: None, "other"))\n'
        'lab.wait_until(lambda: other.count > 3)\nprint(node.count)'
    )
    assert result.error == ''
    assert result.text == "caught ZeroDivisionError('division by zero')\n3\n"
    uncaught = kernel.run(f'node = Ticker(fail)\n{SPINS[how]}\nprint("not run")')
    assert uncaught.error == 'ZeroDivisionError: division by zero'
    assert '1 / 0' in uncaught.traceback and 'executors.py' not in uncaught.traceback
    assert 'has ended with this error. No longer spun: /ticker.' in uncaught.traceback
    assert 'not run' not in uncaught.text and 'goes on' not in uncaught.traceback


def test_an_error_of_labkit_says_that_it_has_ended_a_spin(kernel):
    kernel.run(SETUP + 'def refuse(): raise lab.LabError("seen", todo="do")')
    goes_on = '/ticker goes on in the background, where lab.spin() runs it.'
    for node, fate in (
        ('Ticker(refuse)', 'No longer spun: /ticker.'),
        ('lab.spin(Ticker(refuse))', goes_on),
    ):
        _, *said, end = kernel.run(f'node = {node}\nrclpy.spin(node)').traceback.split('\n', 3)
        assert said == ['LabError: seen', 'do']
        assert ' '.join(end.split()) == f'rclpy.spin() has ended with this error. {fate}'
    assert kernel.run('refuse()').traceback.splitlines()[1:] == ['LabError: seen', 'do']


@pytest.mark.parametrize('how', ALL)
def test_the_stop_button_is_seen_and_ends_the_cell_with_one_line(kernel, how):
    kernel.run(SETUP)
    program = 'node = Ticker(tick)\n' + caught(SPINS[how], 'KeyboardInterrupt')
    cell = kernel.start(program + 'print("the end")')
    kernel.wait_for_output(cell, 'tick')
    kernel.interrupt()
    result = kernel.finish(cell)
    assert result.error == ''
    assert result.text.endswith('caught KeyboardInterrupt()\nthe end\n')
    # A node without callbacks: nothing else would end a wait in C.
    result = kernel.run(
        'node = Node("idle")\npress_when_it_waits()\n'
        + tried(SPINS[how], 'finally:\n    print("finally")\n')
        + 'print("not run")'
    )
    assert (result.error, result.text) == ('KeyboardInterrupt: ', 'finally\n')
    assert result.traceback.endswith('() was interrupted. No longer spun: /idle.')
    assert len(result.traceback.splitlines()) == 1
    assert kernel.run('print(node.get_name())').text == 'idle\n'


@pytest.mark.parametrize('how', ALL)
def test_a_program_that_ends_in_a_callback_ends_its_spin_and_its_node(kernel, how):
    kernel.run(SETUP + 'other = lab.spin(Ticker(lambda: None, "other"))')
    result = kernel.run(
        'node = Ticker(leave, at=3)\n'
        + caught(SPINS[how], 'SystemExit')
        + 'print(node.get_name(), node.count)\nnode.destroy_node()'
    )
    assert (result.error, result.text) == ('', 'caught SystemExit(3)\nticker 3\n')
    result = kernel.run(f'node = Ticker(leave)\n{SPINS[how]}\nprint("not run")')
    assert (result.error, result.text) == ('SystemExit: 3', '')
    (line,) = result.traceback.splitlines()
    assert 'has ended its program (SystemExit: 3). In a notebook that ends ' in line
    assert line.endswith('() and /ticker alone.')
    assert kernel.run('print(names())').text == "['other']\n"


def test_a_node_of_lab_spin_goes_on_after_an_error_in_the_foreground(kernel):
    kernel.run(SETUP)
    cell = kernel.run('node = lab.spin(Ticker(fail))')
    assert 'The node goes on' in kernel.wait_for_output(cell.msg_id, 'ZeroDivisionError')
    for spin in ('rclpy.spin_once(node)', OWN + 'rclpy.spin_once(node, executor=executor)'):
        result = kernel.run(caught(spin, 'ZeroDivisionError') + 'print(names())')
        assert 'caught' in result.text and result.text.endswith("['ticker']\n")
        before = 'before = node.count\nlab.wait_until(lambda: node.count > before + 2)'
        assert kernel.run(before).error == ''
    for spin in ('rclpy.spin(node)', OWN + 'rclpy.spin(node, executor)'):
        uncaught = kernel.run(spin)
        assert 'rclpy.spin() has ended with this error. /ticker goes on' in uncaught.traceback
    kernel.run('node.act = tick')
    cell = kernel.start('print("begun", flush=True)\nrclpy.spin(node)')
    kernel.wait_for_output(cell, 'begun')
    kernel.interrupt()
    assert kernel.finish(cell).error == 'KeyboardInterrupt: '
    assert kernel.run(before).error == ''


PRESS = """
def pressed_at(step, call):
    # Press the stop button at a line of labkit. Return whether it has so many, and what came.
    left = [step]
    def trace(frame, event, arg):
        if '/labkit/' not in frame.f_code.co_filename:
            return None
        if event == 'line':
            left[0] -= 1
            if left[0] == 0:
                signal.raise_signal(signal.SIGINT)
        return trace
    error = None
    sys.settrace(trace)
    try:
        call()
    except BaseException as raised:
        error = raised
    finally:
        sys.settrace(None)
    return left[0] <= 0, error

def press_everywhere(call):
    step, swallowed, kept = 1, [], []
    while True:
        reached, error = pressed_at(step, call)
        if not reached:
            return step, swallowed, kept
        if not isinstance(error, KeyboardInterrupt):
            swallowed.append(step)
        if runtime.entry_of(node) is not None:
            kept.append(step)
        step += 1
"""


@pytest.mark.slow('tries every line')
def test_the_stop_button_between_any_two_lines_is_seen_and_leaves_nothing(kernel):
    kernel.run(SETUP + PRESS + 'node = Node("idle")')
    result = kernel.run(
        'steps, *wrong = press_everywhere(lambda: rclpy.spin_once(node, timeout_sec=0))\n'
        'print(steps > 50, wrong)\nlab.spin(Ticker(tick))\n'
        'rclpy.spin_once(node, timeout_sec=0)'
    )
    assert (result.error, result.text.splitlines()[0]) == ('', 'True [[], []]')


def test_the_stop_button_finds_a_loop_whose_callbacks_fail(kernel):
    kernel.run(SETUP)
    cell = kernel.start(
        'node = Ticker(fail)\nwhile True:\n    try:\n        rclpy.spin_once(node)\n'
        '    except ZeroDivisionError:\n        if node.count == 3: print("three", flush=True)\n'
    )
    kernel.wait_for_output(cell, 'three')
    kernel.interrupt()
    assert kernel.finish(cell).error == 'KeyboardInterrupt: '


def test_an_executor_keeps_the_nodes_that_it_had(kernel):
    kernel.run(SETUP)
    result = kernel.run(
        'node = Ticker(tick)\n' + OWN + 'executor.add_node(node)\n'
        'for _ in range(2):\n    rclpy.spin_once(node, executor=executor)\n'
        'print(executor.get_nodes() == [node])'
    )
    assert (result.error, result.text) == ('', 'tick\ntick\nTrue\n')


def test_an_interrupt_in_a_callback_ends_the_spin_and_the_node(kernel):
    kernel.run(SETUP)
    text = kernel.run('node = Ticker(press)\n' + caught(SPINS['spin'], 'KeyboardInterrupt')).text
    assert text == 'caught KeyboardInterrupt()\n'
    result = kernel.run('node = Ticker(press)\nrclpy.spin(node)')
    assert result.traceback == (
        'on_timer of /ticker has ended its program (KeyboardInterrupt). '
        'In a notebook that ends rclpy.spin() and /ticker alone.'
    )
    assert kernel.run('print(names())').text == '[]\n'


COROUTINE = """
class Waiting(Node):
    def __init__(self):
        super().__init__('waiting')
        self.begun, self.future = 0, Future()
        self.create_timer(0.01, self.on_timer)

    async def on_timer(self):
        self.begun += 1
        await self.future
        {act}()

node = Waiting()
while not node.begun:
    rclpy.spin_once(node)
node.future.set_result(None)
"""


@pytest.mark.parametrize(
    ('act', 'error'),
    [('fail', "ZeroDivisionError('division by zero')"), ('leave', 'SystemExit(3)')],
)
def test_a_coroutine_that_was_begun_in_an_earlier_spin_raises_in_this_one(kernel, act, error):
    kernel.run(SETUP)
    for spin in ('rclpy.spin(node)', 'rclpy.spin_once(node)'):
        result = kernel.run(COROUTINE.format(act=act) + caught(spin, 'BaseException'))
        assert (result.error, result.text) == ('', f'caught {error}\n')


def test_a_function_that_waits_for_a_future_raises_in_the_spin(kernel):
    kernel.run(SETUP + 'from std_srvs.srv import Trigger')
    kernel.run(
        'server = lab.spin(Node("server"))\n'
        'server.create_service(Trigger, "fire", lambda request, response: response)\n'
        'node = Node("client")\nclient = node.create_client(Trigger, "fire")'
    )
    for act, error in (('fail', 'ZeroDivisionError'), ('leave', 'SystemExit')):
        result = kernel.run(
            'sent = client.call_async(Trigger.Request())\n'
            f'sent.add_done_callback(lambda future: {act}())\n'
            + caught('rclpy.spin(node)', 'BaseException')
        )
        assert result.error == '' and f'caught {error}(' in result.text


# What runs `node` in a thread.
IN_THREAD = {
    'rclpy.spin': 'rclpy.spin()',
    'lambda node: rclpy.spin_once(node)': 'rclpy.spin_once()',
    'own_executor': 'executor.spin()',
    'many_threads': 'executor.spin()',
}


def test_a_spin_in_a_thread_ends_with_what_a_callback_raises(kernel):
    kernel.run(
        SETUP + 'def own_executor(node, kind=SingleThreadedExecutor):\n'
        '    executor = kind()\n    executor.add_node(node)\n    executor.spin()\n'
        'def many_threads(node):\n    own_executor(node, MultiThreadedExecutor)\n'
    )
    start = (
        'node = Ticker({act})\nthread = threading.Thread(target={spin}, args=(node,))\n'
        'thread.start()\nthread.join()\nprint(names())'
    )
    for spin, what in IN_THREAD.items():
        failed = kernel.run(start.format(act='fail', spin=spin))
        shown = kernel.wait_for_output(failed.msg_id, 'ZeroDivisionError')
        assert "['ticker']" in shown and 'An error has ended Thread-' in shown
        for act, error in (('leave', 'SystemExit: 3'), ('press', 'KeyboardInterrupt')):
            left = kernel.run(start.format(act=act, spin=spin))
            shown = kernel.wait_for_output(left.msg_id, '[]')
            assert f'has ended its program ({error}). In a notebook that ends {what} and' in shown
            assert 'Thread-' not in shown


def test_a_thread_goes_on_that_catches_the_end_of_its_program(kernel):
    kernel.run(SETUP)
    work = caught('rclpy.spin(node)', 'SystemExit').replace('\n', '\n    ')
    result = kernel.run(
        f'node = Ticker(leave)\ndef work():\n    {work}\n'
        'thread = threading.Thread(target=work)\nthread.start()\nthread.join()\nprint(names())'
    )
    assert kernel.wait_for_output(result.msg_id, "['ticker']") == (
        "caught SystemExit(3)\n['ticker']\n"
    )


# A file as `ros2 run` starts it.
FILE = """
import sys
import rclpy
from rclpy.node import Node

class Leaving(Node):
    def __init__(self):
        super().__init__('leaving')
        self.create_timer(0.01, self.on_timer)

    def on_timer(self):
        {act}

def main():
    rclpy.init()
    rclpy.spin(Leaving())
    rclpy.shutdown()

if __name__ == '__main__':
    {main}
"""


@pytest.mark.parametrize('how', ['%run', '%run -e', '%run -m', 'paste'])
def test_a_file_that_is_run_leaves_what_a_pasted_program_leaves(kernel, how):
    kernel.run('import labkit as lab')
    for name, (act, said) in enumerate(
        {
            'sys.exit()': 'on_timer of /leaving has ended its program (SystemExit).',
            'sys.exit(3)': 'on_timer of /leaving has ended its program (SystemExit: 3).',
            'raise KeyboardInterrupt': 'on_timer of /leaving has ended its program (Keyboard',
            '1 / 0': 'rclpy.spin() has ended with this error. No longer spun: /leaving.',
        }.items()
    ):
        code = FILE.format(act=act, main='main()')
        (kernel.folder / f'prog{name}.py').write_text(code)
        file = f'prog{name}' if how.endswith('-m') else f'prog{name}.py'
        result = kernel.run(code if how == 'paste' else f'{how} {file}')
        assert said in result.text + result.traceback
        left = kernel.run(
            'from labkit.background.runtime import runtime\n'
            'print([each.get_name() for each in runtime.unspun_nodes()], runtime.nodes())'
        )
        assert left.text == f'{["leaving"] * (act == "1 / 0")} []\n'
    caught = FILE.format(
        act='sys.exit()', main='try: main()\n    except SystemExit: print("caught")'
    )
    # By a name, so that it stays whenever Python collects what nothing holds.
    held = caught.replace('spin(Leaving())', 'spin(node)').replace(
        '    rclpy.init()\n', '    global node\n    rclpy.init()\n    node = Leaving()\n'
    )
    (kernel.folder / 'caught.py').write_text(held)
    assert kernel.run('%run caught.py').text == 'caught\n'
    left = 'import gc; gc.collect(); print([each is node for each in runtime.unspun_nodes()])'
    assert kernel.run(left).text == '[True]\n'


@pytest.mark.parametrize('how', ['spin', 'own executor', 'with executor'])
def test_what_a_program_raises_again_without_its_traceback_is_known(kernel, how):
    kernel.run(SETUP)
    again = 'except BaseException as error:\n    raise error.with_traceback(None)'
    result = kernel.run('node = Ticker(leave)\n' + tried(SPINS[how], again))
    assert result.error == 'SystemExit: 3'
    assert result.traceback.endswith('spin() and /ticker alone.')
    assert kernel.run('print(names())').text == '[]\n'


def test_the_last_cell_of_a_program_that_exits_says_so_only_of_a_spin(kernel):
    kernel.run(SETUP)
    assert kernel.run('sys.exit(4)').error == 'SystemExit: 4'
    assert 'use %tb to see' in kernel.run('sys.exit(4)').traceback


@pytest.mark.parametrize('how', QUICK)
def test_a_handler_of_the_learners_own_hears_the_stop_button(kernel, how):
    kernel.run(SETUP)
    cell = kernel.start(
        'def stop(number, frame):\n    print("stop", flush=True)\n    rclpy.shutdown()\n'
        'rclpy.init()\nnode = Ticker(tick)\nsignal.signal(signal.SIGINT, stop)\n'
        f'{SPINS[how]}\nprint("the end")'
    )
    kernel.wait_for_output(cell, 'tick')
    kernel.interrupt()
    result = kernel.finish(cell)
    assert result.error == '' and 'stop\n' in result.text and result.text.endswith('the end\n')


def test_an_error_on_top_of_what_a_callback_raised_shows_the_learners_lines_alone(kernel):
    kernel.run(SETUP)
    for after in (
        'except ZeroDivisionError as error:\n    raise ValueError("stopped") from error',
        'finally:\n    raise ValueError("stopped")',
    ):
        result = kernel.run('node = Ticker(fail)\n' + tried('rclpy.spin(node)', after))
        assert result.error == 'ValueError: stopped'
        assert 'ZeroDivisionError: division by zero' in result.traceback
        assert 'labkit' not in result.traceback and 'executors.py' not in result.traceback


@pytest.mark.parametrize('end', ['leave', 'fail'])
def test_what_a_callback_raises_after_its_shutdown_comes_out(kernel, end):
    kernel.run(SETUP + f'def end():\n    rclpy.shutdown()\n    {end}()\n')
    kernel.run('other = lab.spin(Ticker(lambda: None, "other"))')
    error = {'leave': 'SystemExit(3)', 'fail': "ZeroDivisionError('division by zero')"}[end]
    for _ in range(2):
        result = kernel.run(
            'rclpy.init()\nnode = Ticker(end)\n' + caught(SPINS['spin'], 'BaseException')
        )
        assert result.error == '' and result.text.endswith(f'caught {error}\n')
    assert kernel.run('print(names())').text == "['other']\n"


@pytest.mark.parametrize('leave', ['sys.exit(3)', 'signal.raise_signal(signal.SIGINT)'])
def test_a_program_that_ends_in_a_thread_of_an_executor_ends_its_spin(kernel, leave):
    kernel.run(SETUP)
    result = kernel.run(
        f'node = Ticker(lambda: {leave})\nexecutor = MultiThreadedExecutor(2)\n'
        'executor.add_node(node)\nexecutor.spin()'
    )
    assert result.error in ('SystemExit: 3', 'KeyboardInterrupt: ')
    assert len(result.traceback.splitlines()) == 1


def test_what_a_callback_raises_after_the_timeout_comes_out(kernel):
    kernel.run(SETUP)
    kernel.run(
        'begun = threading.Event()\n'
        'def slow():\n    begun.set()\n    time.sleep(0.2)\n    fail()\n'
        'def begin(node):\n    begun.clear()\n'
    )
    for spin in (
        'while True: rclpy.spin_once(node, timeout_sec=0.05)',
        'while True: rclpy.spin_until_future_complete(node, Future(), timeout_sec=0.05)',
    ):
        result = kernel.run('node = Ticker(slow)\n' + caught(spin, 'ZeroDivisionError'))
        assert (result.error, result.text) == (
            '',
            "caught ZeroDivisionError('division by zero')\n",
        )


def test_the_words_name_no_node_when_the_executor_is_shut_down(kernel):
    kernel.run(SETUP)
    for act, words in (
        ('fail', 'executor.spin_once() has ended with this error.'),
        (
            'leave',
            'A callback has ended its program (SystemExit: 3). '
            'In a notebook that ends executor.spin_once() alone.',
        ),
    ):
        result = kernel.run(
            f'node = Ticker({act})\n'
            + tried(SPINS['own executor once'], 'finally:\n    executor.shutdown()')
        )
        assert result.traceback.splitlines()[-1] == words


@pytest.mark.slow('a callback is waited for')
def test_the_stop_button_says_which_callback_it_can_not_interrupt(kernel):
    kernel.run(SETUP + 'free = threading.Event()')
    cell = kernel.start(
        'node = Ticker(lambda: (print("busy", flush=True), free.wait()))\nrclpy.spin(node)'
    )
    kernel.wait_for_output(cell, 'busy')
    kernel.interrupt()
    assert kernel.finish(cell).traceback == (
        'rclpy.spin() was interrupted. No longer spun: /ticker. '
        'on_timer still runs, and until it has returned, no other callback does.'
    )
    kernel.run('free.set()')


@pytest.mark.parametrize('how', QUICK)
def test_a_node_made_after_the_end_of_another_cells_program_is_spun(kernel, how):
    kernel.run(SETUP + 'other = lab.spin(Ticker(lambda: None, "other"))')
    kernel.run('rclpy.init()\nNode("ended")\nrclpy.shutdown()')
    result = kernel.run('node = Ticker(leave)\n' + caught(SPINS[how], 'SystemExit'))
    assert (result.error, result.text) == ('', 'caught SystemExit(3)\n')
    result = kernel.run(
        'rclpy.init()\nnode = Ticker(leave)\n' + OWN + 'executor.add_node(node)\n'
        'rclpy.shutdown()\nexecutor.spin()\nprint("the end")'
    )
    assert (result.error, result.text) == ('', 'the end\n')
