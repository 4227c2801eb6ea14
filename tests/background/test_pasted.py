"""Code of tutorials, pasted into a cell: rclpy's own functions in a kernel."""

from __future__ import annotations

import pytest

from tests.background.cells import SETUP, TALKER

PASTED = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

class Minimal(Node):
    def __init__(self):
        super().__init__('minimal')
        self.publisher = self.create_publisher(String, 'topic', 10)
        self.timer = self.create_timer(0.02, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data='tick'))
        self.get_logger().info('tick')

def main(args=None):
    rclpy.init(args=args)
    node = Minimal()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()

main()
print('the end')
"""


def test_pasted_tutorial_works_twice_and_labkit_after_it(kernel):
    kernel.run('import labkit as lab\nlab.start()')
    for _ in range(2):
        cell = kernel.start(PASTED)
        kernel.wait_for_output(cell, '[INFO] [minimal]: tick')
        kernel.interrupt()
        result = kernel.finish(cell)
        assert (result.error, 'the end' in result.text) == ('KeyboardInterrupt: ', False)
        assert result.traceback == 'rclpy.spin() was interrupted. No longer spun: /minimal.'
    result = kernel.run(SETUP + TALKER + 'lab.wait_until(lambda: talker.count >= 2)')
    assert result.error == ''


def test_functions_of_rclpy_do_what_their_documentation_says(kernel):
    kernel.run(SETUP + 'import rclpy\nlab.start()')
    kernel.run(TALKER.replace('lab.spin(Talker())', 'Talker()'))
    counts = kernel.run(
        'rclpy.init()\n'
        'for _ in range(3):\n'
        '    rclpy.spin_once(talker)\n'
        'print(talker.count)\n'
        'while talker.count < 5:\n'
        '    rclpy.spin_once(talker, timeout_sec=0)\n'
        'print(talker.count)'
    )
    assert (counts.error, counts.text) == ('', '3\n5\n')
    future = kernel.run(
        'from std_srvs.srv import Trigger\n'
        'server = lab.spin(Node("server"))\n'
        'server.create_service(Trigger, "fire", lambda request, response: response)\n'
        'client = talker.create_client(Trigger, "fire")\n'
        'future = client.call_async(Trigger.Request())\n'
        'rclpy.spin_until_future_complete(talker, future)\n'
        'print(future.result())'
    )
    assert 'Trigger_Response' in future.text
    ended = kernel.run('rclpy.shutdown()\nprint(rclpy.ok())\nrclpy.init()\nprint(rclpy.ok())')
    assert (ended.error, ended.text.splitlines()[1:]) == ('', ['False', 'True'])
    assert 'rclpy.shutdown() has ended /server, started by other cells.' in ended.text
    assert kernel.run('%ros2 node list').text == '/talker\n'


def test_pasted_threads_and_executors_work_and_end_with_the_kernel(kernel):
    kernel.run(SETUP + 'lab.start()')
    thread = kernel.run(
        TALKER.replace('lab.spin(Talker())', 'Talker()') + 'import rclpy, threading\n'
        'threading.Thread(target=rclpy.spin, args=(talker,), daemon=True).start()\n'
        'lab.wait_until(lambda: talker.count > 3)'
    )
    assert thread.error == ''
    executor = kernel.run(
        'from rclpy.executors import MultiThreadedExecutor\n'
        'ticks, other = [], Node("other")\n'
        'other.create_timer(0.01, lambda: ticks.append(1))\n'
        'executor = MultiThreadedExecutor()\n'
        'executor.add_node(other)\n'
        'threading.Thread(target=executor.spin, daemon=True).start()\n'
        'lab.wait_until(lambda: len(ticks) > 3)'
    )
    assert executor.error == ''
    assert kernel.shutdown() == 0


BARE = """
import rclpy
from rclpy.node import Node

rclpy.init()
node = Node('x')
node.create_timer(0.02, lambda: print('tick'))
rclpy.spin(node)
print('the end')
"""
IMPORTED = {
    'before rclpy': 'import labkit as lab',
    'after rclpy': 'import rclpy\nimport labkit as lab',
    'with a part of it': 'import labkit as lab\nimport labkit.rosgraph.matching',
    'with another part of it': 'import labkit as lab\nimport labkit.background.notebook_rclpy',
    'with a command': 'import labkit as lab\n%ros2 interface show std_msgs/msg/String',
}


@pytest.mark.parametrize('how', IMPORTED)
def test_the_import_of_labkit_is_enough_for_a_tutorial(kernel, how):
    assert kernel.run(IMPORTED[how]).error == ''
    cell = kernel.start(BARE)
    kernel.wait_for_output(cell, 'tick')
    kernel.interrupt()
    result = kernel.finish(cell)
    assert result.traceback == 'rclpy.spin() was interrupted. No longer spun: /x.'
    after = kernel.run(
        'rclpy.init()\nlab.spin(Node("y"))\n%ros2 node list\nprint(rclpy.ok(), node.get_name())'
    )
    assert (after.error, after.text) == ('', '/x\n/y\nTrue x\n')


def test_the_import_of_labkit_does_not_load_rclpy(kernel):
    result = kernel.run('import labkit as lab, sys\nprint("rclpy" in sys.modules)')
    assert (result.error, result.text) == ('', 'False\n')


SERVER = """
import labkit as lab
import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger

class Server(Node):
    def __init__(self):
        super().__init__('server')
        self.count = 0
        self.create_service(Trigger, 'fire', self.on_fire)

    def on_fire(self, request, response):
        self.count += 1
        return response

server = lab.spin(Server())
"""
CLIENT = """
def main():
    rclpy.init()
    node = Node('client')
    client = node.create_client(Trigger, 'fire')
    while not client.wait_for_service(timeout_sec=1.0):
        print('service not available, waiting again...')
    future = client.call_async(Trigger.Request())
    rclpy.spin_until_future_complete(node, future)
    print(server.count, future.done(), rclpy.ok())
    {end}

main()
print(rclpy.ok())
"""


@pytest.mark.parametrize(
    'end',
    [
        'rclpy.shutdown()',
        'node.destroy_node(); rclpy.shutdown()',
        'rclpy.try_shutdown(); rclpy.try_shutdown()',
        'rclpy.shutdown()\n    if rclpy.ok(): rclpy.shutdown()',
    ],
)
def test_a_program_ends_what_it_has_made(kernel, end):
    kernel.run(SERVER)
    for count in (1, 2):
        result = kernel.run(CLIENT.format(end=end))
        assert (result.error, result.text) == ('', f'{count} True True\nFalse\n')
        assert kernel.run('%ros2 node list').text == '/server\n'
    again = kernel.run('print(rclpy.ok())\nrclpy.shutdown()\nprint(rclpy.ok())')
    assert again.error == ''
    assert again.text.splitlines()[0] == 'True'
    assert 'rclpy.shutdown() has ended /server, started by other cells.' in again.text
    assert again.text.splitlines()[-1] == 'False'


def test_a_second_shutdown_in_a_program_is_refused(kernel):
    kernel.run(SERVER)
    result = kernel.run('rclpy.init()\nrclpy.shutdown()\nrclpy.shutdown()')
    assert 'rclpy.shutdown() was called already.' in result.error
    assert 'call lab.stop()' in result.error
    assert kernel.run('%ros2 node list').text == '/server\n'


def test_a_program_is_all_that_other_cells_made_since_its_init_too(kernel):
    kernel.run('import labkit as lab\nimport rclpy\nrclpy.init()')
    kernel.run(SERVER)
    result = kernel.run('rclpy.shutdown()\nprint(rclpy.ok())')
    assert result.error == ''
    assert 'has ended /server, started by other cells' in result.text
    assert result.text.splitlines()[-1] == 'False'


THREADS = """
import threading
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

rclpy.init()
node = Node('threaded')
ticks = []
node.create_timer(0.01, lambda: ticks.append(1))
executor = MultiThreadedExecutor()
executor.add_node(node)
spins = threading.Thread(target=executor.spin)
spins.start()
looks = threading.Thread(target=lambda: [ticks.append(1) or rclpy.ok() for _ in iter(rclpy.ok, 0)])
looks.start()
while len(ticks) < 5:
    pass
"""


def test_threads_of_a_program_end_with_it_and_only_with_it(kernel):
    kernel.run(SERVER)
    assert kernel.run(THREADS).error == ''
    client = kernel.run(CLIENT.format(end='rclpy.shutdown()'))
    assert (client.error, client.text) == ('', '1 True True\nFalse\n')
    assert kernel.run('print(spins.is_alive(), looks.is_alive())').text == 'True True\n'
    kernel.run('lab.remove("threaded")')
    ended = kernel.run(
        THREADS + 'rclpy.shutdown()\nspins.join()\nlooks.join()\nprint("joined")\n%ros2 node list'
    )
    assert (ended.error, ended.text) == ('', 'joined\n/server\n')
    kernel.run('lab.stop()')


def test_spin_once_sees_a_callback_that_was_run_before_it_waits(kernel):
    kernel.run(
        """
import rclpy, time
from labkit.background.runtime import runtime
from rclpy.node import Node
from std_msgs.msg import String
rclpy.init()
node, heard, add = Node('once'), [], runtime.add
node.create_subscription(String, 'topic', heard.append, 10)
node.create_publisher(String, 'topic', 10).publish(String())

def slow(*args, **options):
    entry = add(*args, **options)
    while not entry.callbacks:
        time.sleep(0.001)
    return entry

runtime.add = slow
"""
    )
    result = kernel.run('rclpy.spin_once(node, timeout_sec=600)\nprint(len(heard))')
    assert (result.error, result.text) == ('', '1\n')


ARGUMENTS = """
from rclpy.node import Node
rclpy.init(args=['program', '--ros-args', *{args!r}])
class Given(Node):
    def __init__(self):
        super().__init__('given')
        self.publisher = self.create_publisher(Trigger.Event, 'fire_events', 10)
        self.declare_parameter('speed', 1.0)
        self.get_logger().debug('made')
given = Given()
print(given.get_fully_qualified_name(), given.publisher.topic_name,
      given.get_parameter('speed').value)
"""
GIVEN = [
    ([], '/given /fire_events 1.0\n'),
    (['-r', '__node:=other', '-r', '__ns:=/robot'], '/robot/other /robot/fire_events 1.0\n'),
    (['--remap', 'fire_events:=seen', '-p', 'speed:=2.5'], '/given /seen 2.5\n'),
    (['-p', 'another:speed:=2.5', '-r', 'another:__ns:=/b'], '/given /fire_events 1.0\n'),
    (['--params-file', 'speed.yaml'], '/given /fire_events 7.0\n'),
    (['--log-level', 'debug'], '[DEBUG] [given]: made\n/given /fire_events 1.0\n'),
    (['--log-level', 'given:=debug'], '[DEBUG] [given]: made\n/given /fire_events 1.0\n'),
    ([], '/given /fire_events 1.0\n'),
]


@pytest.mark.parametrize('running', [False, True])
def test_arguments_of_init_are_about_the_nodes_of_the_program(kernel, running):
    kernel.run(SERVER)
    kernel.run(
        'from pathlib import Path\nTrigger.Event = __import__("std_msgs.msg").msg.String\n'
        'Path("speed.yaml").write_text("/given: {ros__parameters: {speed: 7.0}}")'
    )
    for args, shown in GIVEN:
        if not running:
            kernel.run('lab.stop()')
        result = kernel.run(ARGUMENTS.format(args=args))
        assert (result.error, result.text) == ('', shown), args
        kernel.run('rclpy.shutdown()')
    if running:
        assert kernel.run('%ros2 node list').text == '/server\n'


def test_arguments_of_init_replace_a_node_of_the_name_that_they_give(kernel):
    kernel.run(SERVER)
    renamed = ['-r', '__node:=other']
    for _ in range(2):
        assert kernel.run(ARGUMENTS.format(args=renamed)).error == ''
    assert kernel.run('%ros2 node list').text == '/other\n/server\n'


@pytest.mark.slow('a kernel for each argument')
@pytest.mark.parametrize(
    ('args', 'words'),
    [
        (['--enclave', '/a'], 'says --enclave /a. That holds for a whole process'),
        (['--disable-stdout-logs'], 'says --disable-stdout-logs. That holds'),
        (['--log-level', 'loud'], 'loud'),
        (['--bogus'], '--bogus'),
        (['--params-file', 'missing.yaml'], 'missing.yaml'),
        (['--params-file', 'pipe.yaml'], 'Not a regular file'),
        (['--params-file', 'deep.yaml'], 'nested too deep'),
    ],
)
def test_arguments_that_do_not_hold_are_refused(kernel, args, words):
    kernel.run(SERVER)
    kernel.run('import os; os.mkfifo("pipe.yaml"); open("deep.yaml", "w").write("[" * 100_000)')
    given = ['--ros-args', *args]
    result = kernel.run(f'rclpy.init(args={given!r})')
    assert words in result.error
    if args[0] == '--params-file':
        result = kernel.run(f"Node('reader', cli_args={given!r})")
        assert words in result.error
    assert kernel.run(CLIENT.format(end='rclpy.shutdown()')).text == '1 True True\nFalse\n'


CAUGHT = """
def main():
    rclpy.init()
    node = Node('careful')
    node.create_timer(0.02, lambda: print('tick'))
    {before}
    try:
        {spin}
    except {what}:
        print('stopping the robot')
    {after}

main()
print('the end')
"""


@pytest.mark.parametrize('spin', ['rclpy.spin(node)', 'executor.spin()'])
@pytest.mark.parametrize(
    ('what', 'is_caught'),
    [
        ('KeyboardInterrupt', True),
        ('(KeyboardInterrupt, rclpy.executors.ExternalShutdownException)', True),
        ('BaseException', True),
        ('Exception', False),
    ],
)
def test_the_branch_for_the_stop_button_is_reached(kernel, spin, what, is_caught):
    kernel.run('import labkit as lab\nimport rclpy, rclpy.executors\nfrom rclpy.node import Node')
    executor = (
        'executor = rclpy.executors.SingleThreadedExecutor(); executor.add_node(node)'
        if 'executor' in spin
        else ''
    )
    cell = kernel.start(
        CAUGHT.format(before=executor, spin=spin, what=what, after='rclpy.shutdown()')
    )
    kernel.wait_for_output(cell, 'tick')
    kernel.interrupt()
    result = kernel.finish(cell)
    assert (result.error == '', result.text.endswith('the end\n')) == (is_caught, is_caught)
    assert ('stopping the robot' in result.text) == is_caught


ENDING = """
import asyncio, sys
import rclpy
from rclpy.node import Node

class Ending(Node):
    def __init__(self, end):
        super().__init__('ending')
        self.count, self.end = 0, end
        self.create_timer(0.01, self.on_timer)

    def on_timer(self):
        self.count += 1
        self.end()

def names():
    from labkit.background.runtime import runtime
    spun = [entry.node for entry in runtime.nodes()]
    return [node.get_name() for node in [*spun, *runtime.unspun_nodes()]]
"""


def test_a_loop_ends_whose_callback_calls_shutdown(kernel):
    kernel.run('import labkit as lab' + ENDING + 'other = lab.spin(Node("other"))')
    for made, work in (
        ('Ending(rclpy.shutdown)', 'rclpy.spin_once(node)'),
        ('lab.spin(Ending(rclpy.shutdown))', 'lab.wait_until(lambda: node.count)'),
    ):
        result = kernel.run(
            f'rclpy.init()\nnode = {made}\nwhile rclpy.ok():\n    {work}\nprint("the end")'
        )
        assert result.error == '' and result.text.endswith('the end\n'), result.traceback
        # In another cell the notebook goes on.
        assert kernel.run('print(rclpy.ok(), names())').text == "True ['other']\n"
    thread = kernel.run(
        'import threading\nrclpy.init()\nnode = Ending(rclpy.shutdown)\n'
        'def work():\n    while rclpy.ok(): rclpy.spin_once(node)\n'
        'thread = threading.Thread(target=work)\nthread.start()\nthread.join(30)\n'
        'print(thread.is_alive())'
    )
    assert 'False\n' in thread.text and thread.error == ''


def test_sys_exit_ends_what_its_program_has_made(kernel):
    kernel.run('import labkit as lab' + ENDING + 'other = lab.spin(Node("other"))')
    result = kernel.run('rclpy.init()\nnode = Node("own")\nsys.exit("no robot")')
    assert result.error == 'SystemExit: no robot'
    assert 'The end of this program has ended /own.\n' in result.text
    assert kernel.run('print(names())').text == "['other']\n"
    # Not what an earlier cell has begun, and not what has ended already.
    kernel.run('rclpy.init()\nnode = Node("own")')
    assert 'has ended /own' not in kernel.run('sys.exit(1)').text
    result = kernel.run('rclpy.init()\nmine = Node("mine")\nrclpy.shutdown()\nsys.exit(0)')
    assert 'has ended' not in result.text
    assert kernel.run('print(names())').text == "['other', 'own']\n"
    with_spin = kernel.run('rclpy.init()\nrclpy.spin(Ending(sys.exit))')
    assert 'The end of' not in with_spin.text


def test_a_cell_awaits_where_a_program_calls_asyncio_run(kernel):
    kernel.run('import labkit as lab' + ENDING)
    kernel.run(
        'async def spin_for_a_while(node):\n    while node.count < 3:\n'
        '        rclpy.spin_once(node, timeout_sec=0)\n        await asyncio.sleep(0.01)\n'
        'node = Ending(lambda: None)'
    )
    run = kernel.run('asyncio.run(spin_for_a_while(node))')
    assert 'A cell runs in an event loop already.' in run.traceback
    assert kernel.run('await spin_for_a_while(node)\nprint(node.count)').text == '3\n'
