"""The background thread: nothing ends it, and no wait for it is in vain."""

from __future__ import annotations

import pytest

SETUP = """
import sys, threading
import labkit as lab
from labkit.background.runtime import runtime
from rclpy.node import Node
from std_msgs.msg import String

class Ticker(Node):
    def __init__(self, act, name='ticker', period=0.01):
        super().__init__(name)
        self.count, self.act = 0, act
        self.create_timer(period, self.on_timer)

    def on_timer(self):
        self.count += 1
        self.act(self)
"""


def test_whatever_a_callback_raises_is_shown_and_spinning_goes_on(kernel):
    kernel.run(SETUP + 'def throw(error):\n    raise error\n')
    cell = kernel.run('ticker = lab.spin(Ticker(lambda node: throw(GeneratorExit())))')
    assert not kernel.run('lab.wait_until(lambda: ticker.count >= 3)').error
    said = kernel.wait_for_output(cell.msg_id, 'GeneratorExit')
    assert said.count('The callback on_timer of /ticker failed. The node goes on') == 1
    assert not kernel.run(
        'other = lab.spin(Ticker(lambda node: None, "other"))\n'
        'lab.wait_until(lambda: other.count >= 3)'
    ).error


def test_what_a_task_of_a_cell_raises_has_no_name_of_labkits(kernel):
    kernel.run(SETUP + 'def fail():\n    raise ValueError("lost")\n')
    kernel.run('ticker = lab.spin(Ticker(lambda node: None))')
    cell = kernel.run('ticker.executor.create_task(fail);')
    said = kernel.wait_for_output(cell.msg_id, 'ValueError: lost')
    assert 'The callback fail of the executor failed.' in said
    assert '_labkit' not in said


@pytest.mark.parametrize(
    ('leave', 'shown'),
    [('sys.exit(3)', 'SystemExit: 3'), ('exit_now()', "KeyboardInterrupt: 'enough'")],
)
def test_a_program_that_ends_in_a_callback_ends_its_node_and_spinning_goes_on(
    kernel, leave, shown
):
    kernel.run(SETUP + 'def exit_now():\n    raise KeyboardInterrupt("enough")')
    kernel.run('other = lab.spin(Ticker(lambda node: None, "other"))')
    for _ in range(2):
        cell = kernel.run(f'ticker = lab.spin(Ticker(lambda node: {leave}))')
        said = kernel.wait_for_output(cell.msg_id, 'it ends /ticker alone')
        assert f'on_timer of /ticker has ended its program ({shown}).' in said
        assert kernel.run(
            'before = other.count\nlab.wait_until(lambda: other.count >= before + 3)\n'
            'print(ticker.count, [entry.name for entry in runtime.nodes()])'
        ).text == ("1 ['/other']\n")


def test_a_program_that_ends_in_a_callback_is_not_ended_by_it(script):
    result = script(
        SETUP
        + 'ticker = lab.spin(Ticker(lambda node: sys.exit(3)))\n'
        + 'lab.wait_until(lambda: not runtime.nodes())\nprint("goes on")\nsys.exit(4)\n'
    )
    assert (result.exit_code, result.stderr) == (4, '')
    assert result.stdout.splitlines()[-1] == 'goes on'
    assert 'on_timer of /ticker has ended its program (SystemExit: 3).' in result.stdout


def test_a_thread_that_has_ended_is_made_up_for_by_the_next_start(kernel):
    kernel.run(SETUP + 'lab.start()')
    # Nothing that is known ends it; should something do so, the next cell works again.
    ended = kernel.run(
        'executor = runtime._executor; executor._closing = True; executor.wake()\n'
        'executor.thread.join(); executor._closing = False\nprint(runtime.started)'
    )
    assert (ended.error, ended.text) == ('', 'False\n')
    again = 'ticker = lab.spin(Ticker(lambda node: None))\nlab.wait_until(lambda: ticker.count)'
    assert not kernel.run(again).error


# A callback that makes a node when a cell is about to replace its own node, or to move ROS.
MAKES_A_NODE = (
    SETUP
    + """
in_callback, go_on = threading.Event(), threading.Event()
def make(node):
    in_callback.set()
    go_on.wait(60)
    made.append(Node(f'made_{len(made)}'))
made = []
waited = []
from labkit.background import executor as module
class Watched(threading.Condition):
    def wait_for(self, predicate, timeout=None):
        done = super().wait_for(predicate, timeout)
        waited.append(done)
        return done
"""
)


def test_a_cell_run_again_does_not_wait_for_a_callback_that_makes_a_node(kernel):
    kernel.run(MAKES_A_NODE)
    result = kernel.run(
        """
ticker = lab.spin(Ticker(make))
runtime.executor._round_begun = Watched()
in_callback.wait(60)
threading.Timer(0.2, go_on.set).start()
ticker = lab.spin(Ticker(lambda node: None))
print(waited, len(made))
"""
    )
    # The round came: nobody gave up waiting for it.
    assert (result.error, result.text) == ('', '[True] 1\n')


def test_a_move_to_another_domain_does_not_wait_for_a_callback_that_makes_a_node(kernel):
    kernel.run(MAKES_A_NODE)
    result = kernel.run(
        """
lab.start()
executor, here = runtime.executor, runtime.domain_id
close, closed = executor.close, []
executor.close = lambda timeout_sec: closed.append(close(timeout_sec))
timer = runtime.helper.create_timer(0.01, lambda: make(None))
in_callback.wait(60)
threading.Timer(0.2, go_on.set).start()
lab.start(domain_id=here + 1 if here < 101 else 1)
print(closed, runtime.domain_id != here, len(made))
"""
    )
    assert (result.error, result.text) == ('', '[True] True 1\n')


@pytest.mark.parametrize(
    'waiting',
    [
        'lab.wait_for_message("/ticks", String)',
        'lab.listen("/ticks", String, count=1)',
        'lab.wait_until(lambda: True)',
        '__import__("rclpy").spin_once(ticker)',
    ],
)
def test_a_condition_that_waits_itself_is_refused(kernel, waiting):
    kernel.run(SETUP + 'ticker = lab.spin(Ticker(lambda node: None))')
    result = kernel.run(f'lab.wait_until(lambda: {waiting})')
    assert result.error.startswith('LabError')
    assert 'inside the condition of a wait can not work' in result.traceback
    assert 'call lab.wait_for_message(...) on its own' in result.traceback
    assert not kernel.run('lab.wait_until(lambda: ticker.count > 2)').error


def test_a_coroutine_that_waits_for_itself_lets_the_executor_settle(script):
    # Client and timer are in one callback group: the response can not be taken.
    result = script(
        SETUP
        + """
from std_srvs.srv import Trigger

class Deadlock(Node):
    def __init__(self):
        super().__init__('deadlock')
        self.asked = 0
        self.client = self.create_client(Trigger, 'answer')
        self.timer = self.create_timer(0.01, self.on_timer)

    async def on_timer(self):
        self.asked += 1
        await self.client.call_async(Trigger.Request())

server = lab.spin(Node('server'))
server.create_service(Trigger, 'answer', lambda request, response: response)
deadlock = lab.spin(Deadlock())
lab.wait_until(lambda: deadlock.asked)
ticker = lab.spin(Ticker(lambda node: node.timers.__next__().cancel()))
lab.wait_until(lambda: ticker.count)
print(runtime.executor.settle(5.0), deadlock.asked)
"""
    )
    assert (result.exit_code, result.stdout) == (0, 'True 1\n'), result.stderr


def test_a_coroutine_goes_on_before_the_executor_has_settled(script):
    result = script(
        SETUP
        + """
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from std_srvs.srv import Trigger

node, heard = lab.spin(Node('asker')), []
server = lab.spin(Node('server'))
server.create_service(Trigger, 'answer', lambda request, response: response)
group = MutuallyExclusiveCallbackGroup()
client = node.create_client(Trigger, 'answer', callback_group=group)

async def on_message(msg):
    for _ in range(3):
        await client.call_async(Trigger.Request())
    heard.append(msg.data)

node.create_subscription(String, 'ask', on_message, 10)
publisher = node.create_publisher(String, 'ask', 10)
lab.wait_until(lambda: publisher.get_subscription_count() and client.service_is_ready())
publisher.publish(String(data='a'))
print(runtime.executor.settle(5.0), heard)
"""
    )
    assert (result.exit_code, result.stdout) == (0, "True ['a']\n"), result.stderr


def test_no_one_who_waits_for_quiet_is_forgotten(script):
    out = script("""
import sys, threading
import labkit as lab
from labkit.background.runtime import runtime
lab.start()
sys.setswitchinterval(1e-6)
done = threading.Event()

def ask_in_passing():
    while not done.is_set():
        runtime.executor.settle(2e-5)

thread = threading.Thread(target=ask_in_passing)
thread.start()
try:
    print({runtime.executor.settle(5) for _ in range(2000)})
finally:
    done.set()
    thread.join()
""")
    assert (out.exit_code, out.stdout) == (0, '{True}\n'), out.stderr


def test_it_is_known_for_how_long_others_ran_instead(script):
    """On one processor beside a program that never rests, the thread has to wait now and then."""
    result = script("""
import os, subprocess, sys
from labkit.background.executor import _waits_for_a_processor
os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
other = subprocess.Popen([sys.executable, '-c', 'while True: pass'])
before = _waits_for_a_processor()
while _waits_for_a_processor() < before + 0.02:
    pass
other.kill()
print('known')
""")
    assert result.stdout == 'known\n', result.stderr
