"""Action servers and clients of rclpy in a notebook's cells."""

from __future__ import annotations

import pytest

NODES = """
import labkit as lab
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.action.server import GoalStatus
from rclpy.node import Node
from rclpy.task import Future
from test_msgs.action import Fibonacci

lab.start()


class Counter(Node):
    def __init__(self):
        super().__init__('counter')
        self.goals = 0
        self.tick = None
        accept = lambda handle: CancelResponse.ACCEPT
        ActionServer(self, Fibonacci, 'count', self.execute, cancel_callback=accept)
        self.create_timer(0.02, self.on_timer)

    def on_timer(self):
        if self.tick is not None:
            self.tick.set_result(None)

    async def execute(self, handle):
        self.goals += 1
        sequence = []
        while len(sequence) < handle.request.order:
            self.tick = Future()
            await self.tick
            if handle.is_cancel_requested:
                handle.canceled()
                return Fibonacci.Result(sequence=sequence)
            sequence.append(len(sequence))
            handle.publish_feedback(Fibonacci.Feedback(sequence=sequence))
        handle.succeed()
        return Fibonacci.Result(sequence=sequence)


class Asker(Node):
    def __init__(self):
        super().__init__('asker')
        self.client = ActionClient(self, Fibonacci, 'count')
        self.feedback = []

    def on_feedback(self, message):
        self.feedback.append(len(message.feedback.sequence))
"""
START = 'counter, asker = lab.spin(Counter()), lab.spin(Asker())'


def test_a_goal_is_sent_and_its_result_awaited_in_one_line(kernel):
    kernel.run(NODES)
    kernel.run(START)
    result = kernel.run(
        'answer = asker.client.send_goal(Fibonacci.Goal(order=3), '
        'feedback_callback=asker.on_feedback)\n'
        'lab.wait_until(lambda: len(asker.feedback) == 3, timeout_sec=60)\n'
        'print(answer.status, list(answer.result.sequence), asker.feedback)'
    )
    assert result.text == '4 [0, 1, 2] [1, 2, 3]\n', result.traceback


def test_a_goal_is_canceled_on_the_way(kernel):
    kernel.run(NODES)
    kernel.run(START)
    result = kernel.run("""
sent = asker.client.send_goal_async(Fibonacci.Goal(order=10**6), asker.on_feedback)
lab.wait_until(lambda: len(asker.feedback) >= 2, timeout_sec=60)
handle = sent.result()
answer = handle.cancel_goal()
print(len(answer.goals_canceling), handle.get_result().status == GoalStatus.STATUS_CANCELED)
""")
    assert result.text == '1 True\n', result.traceback


def test_cells_that_are_run_again_leave_one_server_and_one_client(kernel):
    kernel.run(NODES)
    for _ in range(5):
        kernel.run(START)
    result = kernel.run("""
from labkit.background.runtime import runtime
from labkit.rosgraph.servers import action_ends
print(action_ends(runtime.helper, '/count'))
print(runtime.helper.count_publishers('/count/_action/feedback'))
print(runtime.helper.count_services('/count/_action/send_goal'))
print(asker.client.send_goal(Fibonacci.Goal(order=1)).status, counter.goals)
""")
    types = "['test_msgs/action/Fibonacci']"
    assert result.text == (
        f"ActionEnds(servers=[('/counter', {types})], clients=[('/asker', {types})])\n1\n1\n4 1\n"
    ), result.traceback


@pytest.mark.slow('waits for what does not return')
def test_a_goal_under_way_ends_with_its_node(kernel):
    kernel.run(NODES)
    kernel.run(START)
    result = kernel.run("""
sent = asker.client.send_goal_async(Fibonacci.Goal(order=10**6), asker.on_feedback)
lab.wait_until(lambda: asker.feedback, timeout_sec=60)
lab.remove(counter)
from labkit.background import compat
from labkit.background.runtime import runtime
print(lab.wait_until(lambda: runtime.executor.awaiting == 0, timeout_sec=60) is not False)
print(asker.client.server_is_ready())
""")
    assert result.text == 'True\nFalse\n', result.traceback


def test_what_the_execute_callback_raises_is_shown_at_its_cell(kernel):
    kernel.run(NODES)
    kernel.run("""
class Broken(Node):
    def __init__(self):
        super().__init__('broken')
        ActionServer(self, Fibonacci, 'count', self.execute)

    def execute(self, handle):
        return 1 / 0
""")
    cell = kernel.run('broken, asker = lab.spin(Broken()), lab.spin(Asker())')
    result = kernel.run('print(asker.client.send_goal(Fibonacci.Goal(order=1)).status)')
    assert result.text.endswith('6\n'), result.traceback
    shown = kernel.wait_for_output(cell.msg_id, 'ZeroDivisionError')
    assert 'The callback execute of /broken failed.' in shown
    assert 'return 1 / 0' in shown and 'rclpy' not in shown.split('ZeroDivisionError')[0]
    again = kernel.run(
        'asker.client.send_goal(Fibonacci.Goal(order=1))\n'
        'print([(e.callback, e.count) for e in lab.background.runtime.runtime.console.errors])'
    )
    assert "[('execute', 2)]" in again.text


def test_waiting_for_a_result_in_a_callback_is_refused_in_words(kernel):
    kernel.run(NODES)
    cell = kernel.run("""
class Waiter(Asker):
    def __init__(self):
        super().__init__()
        self.create_timer(0.02, self.on_timer)
        self.count = 0

    def on_timer(self):
        self.count += 1
        self.client.send_goal(Fibonacci.Goal(order=1))

counter, waiter = lab.spin(Counter()), lab.spin(Waiter())
""")
    kernel.run('lab.wait_until(lambda: waiter.count >= 2, timeout_sec=60)')
    shown = kernel.wait_for_output(cell.msg_id, 'send_goal_async() and add_done_callback()')
    assert 'Sending a goal with send_goal() inside a callback would wait for ever' in shown


@pytest.mark.slow('a server that never comes')
def test_a_server_that_is_not_there_is_not_waited_for_when_nobody_is_there(start_kernel):
    kernel = start_kernel(LABKIT_HEADLESS='1')
    kernel.run(NODES)
    kernel.run('asker = lab.spin(Asker())')
    result = kernel.run('asker.client.send_goal(Fibonacci.Goal(order=1))')
    assert result.error.startswith('LabTimeout')
    assert 'Does a node serve the action' in result.traceback
    assert kernel.run('print(asker.client.wait_for_server(timeout_sec=0.1))').text == 'False\n'


def test_a_script_has_the_functions_of_rclpy(script):
    result = script("""
import labkit as lab
lab.start()
from rclpy.action import ActionClient
print(ActionClient.send_goal.__module__, hasattr(ActionClient.send_goal, '_labkit'))
""")
    assert result.stdout == 'rclpy.action.client False\n', result.stderr


@pytest.mark.slow('hundreds of goals')
def test_no_answer_is_lost_when_goals_are_sent_while_callbacks_run(kernel):
    kernel.run(NODES)
    kernel.run("""
class Quick(Node):
    def __init__(self):
        super().__init__('quick')
        ActionServer(self, Fibonacci, 'count', self.execute)

    def execute(self, handle):
        handle.succeed()
        return Fibonacci.Result(sequence=[handle.request.order])

quick, asker = lab.spin(Quick()), lab.spin(Asker())
""")
    result = kernel.run("""
import sys, threading
# Others want to run all the time: so an answer may come before its question is noted.
sys.setswitchinterval(1e-6)
done = threading.Event()

def work():
    while not done.is_set():
        pass

for _ in range(3):
    threading.Thread(target=work, daemon=True).start()
results = []
for order in range(60):
    sent = asker.client.send_goal_async(Fibonacci.Goal(order=order))
    lab.wait_until(sent.done, timeout_sec=60)
    answer = sent.result().get_result_async()
    lab.wait_until(answer.done, timeout_sec=60)
    results.append(answer.result().result.sequence[0])
done.set()
print(results == list(range(60)))
""")
    assert result.text == 'True\n', result.traceback


DESTROYED = """
import threading
import labkit as lab
from action_msgs.msg import GoalStatusArray
from labkit.background.runtime import runtime
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.qos import qos_profile_action_status_default
from test_msgs.action import Fibonacci

seen = threading.Event()

class Client(ActionClient):
    def is_ready(self, wait_set):
        ready = super().is_ready(wait_set)
        if ready:
            seen.set()
        return ready

node = lab.spin(Node('asker'))
client = Client(node, Fibonacci, 'count')
server = node.create_publisher(
    GoalStatusArray, 'count/_action/status', qos_profile_action_status_default
)
with runtime.executor.between_callbacks():
    server.publish(GoalStatusArray())
    print(seen.wait(60))
    client.destroy()
print(runtime.executor.settle(60))
"""


def test_a_client_that_is_destroyed_when_something_waits_for_it_is_no_error(script):
    result = script(DESTROYED)
    assert (result.stdout, result.stderr) == ('True\nTrue\n', '')


@pytest.mark.slow('waits for what does not return')
def test_ros_stops_while_an_action_executes(kernel):
    kernel.run(NODES)
    kernel.run(
        'import threading, time\n'
        'begun, ends = threading.Event(), threading.Event()\n'
        'class Busy(Counter):\n'
        '    def execute(self, handle):\n'
        '        begun.set()\n'
        '        ends.wait()\n'
        '        return Fibonacci.Result()'
    )
    kernel.run('busy, asker = lab.spin(Busy()), lab.spin(Asker())')
    stopped = kernel.run(
        'lab.wait_until(asker.client.server_is_ready)\n'
        'asker.client.send_goal_async(Fibonacci.Goal(order=3))\n'
        'begun.wait()\n'
        'lab.stop()\n'
        'ends.set()'
    )
    assert (stopped.error, stopped.text) == ('', '')
    again = kernel.run(
        START + '\nprint(list(asker.client.send_goal(Fibonacci.Goal(order=3)).result.sequence))'
    )
    assert (again.error, again.text) == ('', '[0, 1, 2]\n')
