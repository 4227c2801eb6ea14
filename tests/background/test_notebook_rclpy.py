"""The replacements of rclpy's functions: same parameters, and undone by `uninstall()`."""

from __future__ import annotations

import inspect

import pytest

from labkit.background.notebook_rclpy import ORIGINALS, REPLACED, _NotebookSafe


@pytest.mark.parametrize('name', [safe for _, _, safe in REPLACED])
def test_parameters_are_those_of_the_original(name: str) -> None:
    original = inspect.signature(ORIGINALS[name]).parameters
    safe = dict(inspect.signature(getattr(_NotebookSafe, name)).parameters)
    del safe['self']
    if '.' in ORIGINALS[name].__qualname__:
        # A method: the object itself comes first, under a name that says what it is.
        safe.pop(next(iter(safe)))
        original = {key: value for key, value in original.items() if key != 'self'}
    rest = {key for key, value in safe.items() if value.kind in (value.VAR_POSITIONAL,)}
    passes_on = bool(rest)
    named = {
        key: value
        for key, value in safe.items()
        if value.kind not in (value.VAR_POSITIONAL, value.VAR_KEYWORD)
    }
    for key, value in named.items():
        assert key in original, f'{name} has no parameter {key}'
        assert (value.kind, value.default) == (original[key].kind, original[key].default), key
    # Parameters without a name are passed on; those with one come first.
    assert list(named) == list(original)[: len(named)]
    assert passes_on or len(named) == len(original)


def test_originals_come_back(kernel):
    kernel.run('import rclpy, rclpy.client, rclpy.executors, rclpy.node\nbefore = rclpy.init')
    code = """
import labkit as lab, sys
def replaced():
    notebook_rclpy = sys.modules['labkit.background.notebook_rclpy']
    return [getattr(getattr(owner, name), '_labkit', False)
            for owner, name, _ in notebook_rclpy.REPLACED]
print(replaced())
from labkit.background import notebook_rclpy
notebook_rclpy.uninstall()
print(replaced(), rclpy.init is before)
lab.stop()
lab.start()
print(replaced())
"""
    assert kernel.run(code).text.splitlines() == [
        str([True] * len(REPLACED)),
        f'{[False] * len(REPLACED)} True',
        str([True] * len(REPLACED)),
    ]


def test_what_somebody_else_has_replaced_since_stays(kernel):
    code = """
import labkit as lab, rclpy
from labkit.background import notebook_rclpy
lab.start()
mine = rclpy.spin = lambda node: None
notebook_rclpy.uninstall()
print(rclpy.spin is mine)
"""
    assert kernel.run(code).text == 'True\n'


def test_the_newest_official_example_is_explained(kernel):
    kernel.run('import labkit as lab\nlab.start()\nimport rclpy')
    result = kernel.run(
        'def main(args=None):\n    with rclpy.init(args=args):\n        pass\nmain()'
    )
    assert result.error.startswith(('TypeError', 'AttributeError'))
    assert 'with rclpy.init(args=args):' in result.traceback
    assert 'written for a newer release of ROS 2' in result.traceback
    assert 'rclpy.shutdown()' in result.traceback
    # Another mistake with `with` is another matter.
    other = kernel.run('with None:\n    pass')
    assert 'newer release' not in other.traceback


HEAP = """
import gc, time
import labkit as lab
from rclpy.node import Node
lab.start()
looked = []
get_objects = gc.get_objects
gc.get_objects = lambda *args: looked.append(1) or get_objects(*args)
for number in range(20):
    node = lab.spin(Node(f'node_{number % 5}'))
lab.doctor()
print(len(looked))
from labkit.background.nodes import existing_nodes
print(sorted(n.get_name() for n in existing_nodes() if not n.get_name().startswith('_')))
"""


def test_a_new_node_does_not_look_through_the_heap(kernel):
    result = kernel.run(HEAP)
    names = [f'node_{number}' for number in range(5)]
    assert (result.error, result.text) == ('', f'0\n{names}\n')


def test_nodes_made_before_labkit_are_known(kernel):
    kernel.run(
        'import rclpy\nfrom rclpy.context import Context\nfrom rclpy.node import Node\n'
        'context = Context()\nrclpy.init(context=context)\nearly = Node("early", context=context)'
    )
    result = kernel.run(
        'import labkit as lab\nlab.start()\n'
        'from labkit.background.nodes import existing_nodes\n'
        'print(early in existing_nodes())\nearly.destroy_node()\nrclpy.shutdown(context=context)'
    )
    assert (result.error, result.text) == ('', 'True\n')


NODES = """
import sys
import labkit as lab
import rclpy
from rclpy.node import Node
from labkit.background.runtime import runtime

class Ticker(Node):
    def __init__(self, name='other'):
        super().__init__(name)
        self.ticks = 0
        self.create_timer(0.02, self.on_timer)

    def on_timer(self):
        self.ticks += 1

other = lab.spin(Ticker())

def goes_on():
    before = other.ticks
    lab.wait_until(lambda: other.ticks > before + 3)
    return [entry.name for entry in runtime.nodes()]
"""
ENDING = """
class Ending(Ticker):
    def on_timer(self):
        super().on_timer()
        if self.ticks == 2:
            {how}

ending = lab.spin(Ending('ending'))
"""


# It is the end of it that is waited for, whatever that raises.
ENDED = ENDING.replace(
    '            {how}\n',
    '            try:\n                {how}\n            finally:\n                ended.set()\n',
)


@pytest.mark.parametrize('how', ['rclpy.shutdown()', 'rclpy.try_shutdown()'])
def test_shutdown_in_a_callback_ends_its_node_alone(kernel, how):
    kernel.run(NODES)
    for _ in range(2):
        cell = kernel.run(ENDING.format(how=how))
        shown = kernel.wait_for_output(cell.msg_id, 'it ends /ending alone')
        assert 'on_timer of /ending has called rclpy.shutdown().' in shown
        assert 'Traceback' not in shown
        assert kernel.run('print(goes_on(), runtime.ended)').text == (
            "['/other'] {'/ending': 'on_timer called rclpy.shutdown()'}\n"
        )
    again = kernel.run(
        'new = lab.spin(Ticker("ending"))\nlab.wait_until(lambda: new.ticks > 3)\n'
        'print(goes_on(), runtime.ended)\nrclpy.shutdown()\nprint(rclpy.ok())'
    )
    said = again.text.splitlines()
    assert (again.error, said[0], said[-1]) == ('', "['/other', '/ending'] {}", 'False')
    assert said[1].startswith('rclpy.shutdown() has ended /other, started by other cells.')


def test_shutdown_in_a_callback_ends_spin_in_the_cell(kernel):
    kernel.run(NODES)
    program = ENDING.format(how='rclpy.shutdown()').replace('lab.spin', '') + (
        "rclpy.spin(ending)\nprint('spin has ended')\nending.destroy_node()"
    )
    for _ in range(2):
        result = kernel.run(program)
        assert result.error == ''
        assert 'spin has ended' in result.text
        assert kernel.run('print(goes_on())').text == "['/other']\n"


@pytest.mark.parametrize(
    'how',
    [
        'raise SystemExit',
        'sys.exit(1)',
        'self.destroy_node()',
        'self.context.shutdown()',
        'self.executor.shutdown()',
        'rclpy.utilities.shutdown()',
        'lab.stop()',
    ],
)
def test_nodes_can_be_spun_again_whatever_a_callback_has_ended(kernel, how):
    kernel.run(NODES)
    for _ in range(2):
        cell = kernel.run(f'import threading\nended = threading.Event()\n{ENDED.format(how=how)}')
        assert kernel.run('ended.wait(50)').text == 'True\n'
        result = kernel.run('other = lab.spin(Ticker())\nprint(goes_on())')
        assert (result.error, "'/other'" in result.text) == ('', True)
        assert 'labkit itself' not in result.text
        kernel.run('if "ending" in str(runtime.nodes()):\n    lab.remove("ending")')
        assert 'labkit itself' not in kernel.wait_for_output(cell.msg_id, '')


def test_a_rate_in_a_callback_is_refused_and_everything_goes_on(kernel):
    kernel.run(NODES)
    wrong = """
class Slow(Ticker):
    def __init__(self):
        super().__init__('slow')
        self.rate = self.create_rate(50)

    def on_timer(self):
        super().on_timer()
        self.rate.sleep()

slow = lab.spin(Slow())
"""
    cell = kernel.run(wrong)
    shown = kernel.wait_for_output(cell.msg_id, 'LabError')
    assert 'The callback on_timer of /slow failed.' in shown
    assert 'in on_timer\n    self.rate.sleep()' in shown
    assert 'sleep() of a rate inside a callback would wait for ever' in shown
    assert 'self.create_timer(0.1, self.on_timer)' in shown
    assert kernel.run('print(goes_on())').text == "['/other', '/slow']\n"
    broken = wrong.replace('self.rate.sleep()', '1 / 0')
    corrected = kernel.run(broken)
    assert 'ZeroDivisionError' in kernel.wait_for_output(corrected.msg_id, 'Zero')
    right = kernel.run(
        wrong.replace('self.rate.sleep()', '') + 'lab.wait_until(lambda: slow.ticks > 3)'
    )
    assert (right.error, right.text) == ('', '')


def test_a_rate_in_a_thread_or_a_cell_works(kernel):
    kernel.run(NODES)
    result = kernel.run(
        'import threading\n'
        'rate, slept = other.create_rate(100), []\n'
        'def work():\n'
        '    for _ in range(3):\n'
        '        rate.sleep()\n'
        '        slept.append(1)\n'
        'thread = threading.Thread(target=work)\n'
        'thread.start()\n'
        'thread.join()\n'
        'work()\n'
        'print(len(slept))'
    )
    assert (result.error, result.text) == ('', '6\n')


STATE = """
import time
from labkit.rosgraph.snapshot import node_names
before = ticker.ticks
goes_on()
print(ticker.ticks > before, runtime.entry_of(ticker) is not None, ticker.executor is not None,
      ticker in runtime.unspun_nodes(), '/ticker' in [e.name for e in runtime.nodes()])
"""


@pytest.mark.parametrize('spun', [False, True])
def test_after_the_stop_button_a_node_is_counted_as_what_it_is(kernel, spun):
    kernel.run(NODES)
    # Where the callback speaks, the node is being spun.
    kernel.run(
        'class Loud(Ticker):\n'
        '    def on_timer(self):\n'
        '        super().on_timer()\n'
        '        if self.ticks == 1:\n'
        '            print("tick")'
    )
    make = "ticker = Loud('ticker')\n" + ('lab.spin(ticker)\n' if spun else '')
    for _ in range(2):
        cell = kernel.start(f'{make}rclpy.spin(ticker)')
        kernel.wait_for_output(cell, 'tick')
        kernel.interrupt()
        assert kernel.finish(cell).error.split(':')[0] in ('', 'KeyboardInterrupt')
        state = kernel.run(STATE)
        assert (state.error, state.text) == ('', f'{spun} {spun} {spun} {not spun} {spun}\n')
    names = kernel.run('lab.wait_until(lambda: node_names(ticker).count("/ticker") == 1)')
    assert names.error == ''


HIDING = """
class Hiding(Node):
    {name} = lambda self: 1
    def __init__(self):
        super().__init__('hiding')
"""


@pytest.mark.parametrize('name', ['handle', 'timers', 'publishers', 'context'])
def test_a_class_that_hides_what_a_node_has_is_refused_and_all_else_works(kernel, name):
    kernel.run(NODES)
    refused = kernel.run(HIDING.format(name=name) + 'lab.spin(Hiding())')
    assert f'Hiding has something called {name}' in refused.error
    assert kernel.run('print(goes_on())').text == "['/other']\n"
    done = kernel.run('lab.graph()\nlab.spin(Ticker("third"))\nlab.stop()')
    assert done.error == ''


@pytest.mark.parametrize(
    ('method', 'refused'),
    [
        ('get_name(self, msg): ...', True),
        ('create_timer(self): ...', True),
        ('get_parameter(self, msg): ...', True),
        ('get_parameter(self, key): return super().get_parameter(key)', False),
        ('create_rate(self, frequency): ...', False),
        ('destroy_node(self, *more): ...', False),
        ('create_client(self, *args, **rest): ...', False),
    ],
)
def test_a_method_that_is_no_stand_in_for_one_of_rclpy_is_refused(kernel, method, refused):
    kernel.run(NODES)
    kernel.run(f'class Own(Ticker):\n    def {method}')
    name = method.partition('(')[0]
    assert (f'Own has something called {name}' in kernel.run('own = Own("own")').error) is refused


@pytest.mark.parametrize('name', ['handle', 'timers'])
def test_a_name_that_a_node_has_is_told_to_be_taken(kernel, name):
    kernel.run(NODES)
    said = f'rclpy uses the name {name} in each node'
    assert said in kernel.run(f'other.{name} = 1').traceback
    cell = kernel.run(
        'class Wrong(Ticker):\n'
        '    def on_timer(self):\n'
        f'        self.{name} = 1\n'
        "wrong = lab.spin(Wrong('wrong'))"
    )
    assert said in kernel.wait_for_output(cell.msg_id, 'rclpy uses')


def test_a_name_of_something_else_than_a_node_is_not_told_to_be_taken(kernel):
    kernel.run(
        'class Box:\n'
        '    @property\n'
        '    def context(self): return 1\n'
        '    def set(self): self.context = 2\n'
        '    def __getattr__(self, name): raise AttributeError(name)\n'
    )
    for code in ('Box().set()', 'Box().timers'):
        result = kernel.run(f'import labkit as lab\nlab.start()\n{code}')
        assert result.error.startswith('AttributeError')
        assert 'rclpy' not in result.traceback


def test_a_node_without_a_name_is_told_so_in_words_of_rclpy(kernel):
    kernel.run(NODES)
    error = kernel.run('class Bare(Node): ...\nBare()').error
    assert "Node.__init__() missing 1 required positional argument: 'node_name'" in error
    assert '_NotebookSafe' not in error


def test_what_was_set_on_a_class_of_messages_is_undone(kernel):
    kernel.run(NODES)
    assert kernel.run('from std_msgs.msg import Int16\nmsg = Int16\nmsg.data = 1').error == ''
    told = kernel.run('msg = Int16()\nmsg.data = 1')
    assert 'An earlier cell has set data on the class Int16 itself' in told.traceback
    again = kernel.run('msg = Int16()\nmsg.data = 1\nprint(msg.data, Int16(data=2).data)')
    assert (again.error, again.text) == ('', '1 2\n')


def test_subscribers_can_be_waited_for_in_a_callback(kernel):
    kernel.run(NODES)
    found = kernel.run(
        'from std_msgs.msg import String\n'
        'said = []\n'
        'hear = lambda msg: said.append(msg.data)\n'
        "heard = other.create_subscription(String, 'news', hear, 10)\n"
        'class Late(Ticker):\n'
        '    def on_timer(self):\n'
        '        super().on_timer()\n'
        '        if self.ticks > 1:\n'
        '            return\n'
        "        publisher = self.create_publisher(String, 'news', 10)\n"
        '        lab.wait_for_subscribers(publisher)\n'
        "        publisher.publish(String(data='late'))\n"
        "late = lab.spin(Late('late'))\n"
        'lab.wait_until(lambda: said)\n'
        'print(said)'
    )
    assert (found.error, found.text) == ('', "['late']\n")
