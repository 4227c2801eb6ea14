"""What labkit relies on in rclpy and ipykernel that has no public name: a test for each."""

from __future__ import annotations

import inspect

import pytest

READY = """
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Task
from labkit.background import compat

rclpy.init()
node = Node('node')
executor = SingleThreadedExecutor()
executor.add_node(node)
"""


def test_rcl_error_is_what_rclpy_raises(script):
    result = script(
        READY
        + """
from std_msgs.msg import Int16, String
node.create_publisher(String, '/topic', 10)
try:
    node.create_publisher(Int16, '/topic', 10)
except compat.RCLError as error:
    print(isinstance(error, RuntimeError), str(error) != '')
"""
    )
    assert result.stdout == 'True True\n', result.stderr


def test_ready_callbacks_ask_for_nodes_once_a_round_and_stop_when_told(script):
    result = script(
        READY
        + """
asked = []
class Asking(SingleThreadedExecutor):
    def get_nodes(self):
        asked.append(1)
        return super().get_nodes()
asking = Asking()
asking.add_node(node)
timer = node.create_timer(0.01, lambda: print('tick'))
(task, entity, owner), = compat.ready_callbacks(asking, None, lambda: False)
print(entity is timer, owner is node, len(asked) >= 1, compat.is_queued(timer))
task()
print(compat.is_queued(timer), compat.handler_of(task), task.done())
try:
    list(compat.ready_callbacks(asking, None, lambda: True))
except Exception as error:
    print(type(error).__name__)
"""
    )
    assert result.stdout == (
        'True True True True\ntick\nFalse None True\nConditionReachedException\n'
    ), result.stderr


def test_tasks_of_an_executor(script):
    result = script(
        READY
        + """
print(compat.has_tasks(executor))
task = Task(lambda: print('done'), executor=executor)
compat.add_task(executor, task)
print(compat.has_tasks(executor), callable(compat.handler_of(task)))
executor.spin_once(timeout_sec=0)
print(task.done(), compat.is_shut_down(executor))
executor.shutdown()
print(compat.is_shut_down(executor))
"""
    )
    assert result.stdout == 'False\nTrue True\ndone\nTrue False\nTrue\n', result.stderr


def test_a_node_forgets_its_executor(script):
    result = script(
        READY
        + """
executor.remove_node(node)
print(node.executor is executor)
compat.forget_executor(node)
print(node.executor, executor.add_node(node), node.executor is executor)
"""
    )
    assert result.stdout == 'True\nNone True True\n', result.stderr


def test_logs_are_shown_and_given_back(script):
    result = script(
        READY
        + """
seen = []
give_back = compat.take_logs(lambda *record: seen.append(record))
node.get_logger().warning('one')
give_back()
node.get_logger().warning('two')
print(seen)
"""
    )
    assert result.stdout == "[(30, 'node', 'one')]\n"
    assert 'one' in result.stderr and 'two' in result.stderr


def test_streams_and_requests_of_a_kernel(kernel):
    code = """
import sys, threading
from labkit.background import compat
request = compat.running_request()
print(sorted(set(request) & {'header', 'metadata'}), compat.is_kernel_stream(sys.stdout))
"""
    first = kernel.run(code)
    assert first.text == "['header', 'metadata'] True\n"
    later = kernel.run(
        """
def speak():
    compat.set_thread_request(request)
    print('under the first cell')
thread = threading.Thread(target=speak)
thread.start()
thread.join()
"""
    )
    assert (later.error, later.text) == ('', '')
    assert 'under the first cell' in kernel.wait_for_output(first.msg_id, 'under the first cell')


def test_a_function_is_called_when_no_cell_runs(kernel):
    code = """
from labkit.background import compat
running, seen = [True], []
compat.call_in_kernel(lambda: seen.append(list(running)))
running.clear()
"""
    assert not kernel.run(code).error
    for _ in range(100):
        if kernel.run('print(seen)').text == '[[]]\n':
            break
    else:
        pytest.fail('it was not called')


def test_a_clock_is_set_without_a_word_to_the_graph(script):
    result = script(
        READY
        + """
from rclpy.time import Time
clock = node.get_clock()
before = len(list(node.subscriptions))
clock.set_ros_time_override(Time(seconds=5, clock_type=clock.clock_type))
compat.set_ros_time_is_active(clock, True)
print(clock.now().nanoseconds, clock.ros_time_is_active)
compat.set_ros_time_is_active(clock, False)
print(clock.now().nanoseconds > 10**18, clock.ros_time_is_active)
print(node.get_parameter('use_sim_time').value, len(list(node.subscriptions)) == before)
"""
    )
    assert result.stdout == '5000000000 True\nTrue False\nFalse True\n', result.stderr


def test_a_rate_is_awaited_while_a_thread_sleeps_in_it(script):
    result = script(
        READY
        + """
import os, threading, time
rate = node.create_rate(100)
(timer,) = node.timers
other = node.create_timer(1.0, lambda: None)
print(compat.rate_is_awaited(other), compat.rate_is_awaited(timer))
go, done = threading.Event(), threading.Event()

def work():
    rate.sleep()
    done.set()
    go.wait()
    while True:
        rate.sleep()

sleeper = threading.Thread(target=work, daemon=True)
sleeper.start()
while not compat.rate_is_awaited(timer):
    time.sleep(0.001)
print(compat.rate_sleepers(timer) == {sleeper.ident}, compat.rate_sleepers(other))
while not done.is_set():
    executor.spin_once(timeout_sec=0.1)
print(compat.rate_is_awaited(timer))
go.set()
while not compat.rate_is_awaited(timer):
    time.sleep(0.001)
print('asleep', flush=True)
os._exit(0)
"""
    )
    assert result.stdout == 'None False\nTrue set()\nFalse\nasleep\n', result.stderr


def test_every_private_name_is_here():
    from labkit.background import compat

    source = inspect.getsource(inspect.getmodule(test_every_private_name_is_here))
    for name in compat.__all__:
        assert f'compat.{name}' in source, f'{name} has no contract test'


def test_input_is_answered_by_a_function(kernel):
    kernel.run('from labkit.background import compat')
    kernel.run('compat.answer_input(lambda prompt: prompt.upper())')
    assert kernel.run('print(input("who? "))').text == 'WHO? \n'


def test_the_task_of_a_goal_knows_the_callback_that_does_the_work(script):
    result = script(
        READY
        + """
from rclpy.action import ActionServer
from test_msgs.action import Fibonacci
server = ActionServer(node, Fibonacci, 'count', print)
task = Task(server._execute_goal, (print, None), executor=executor)
print(compat.callback_of(task) is print, compat.callback_of(Task(len)) is len)
task.cancel()
"""
    )
    assert result.stdout == 'True True\n', result.stderr


def test_an_action_server_knows_its_node(script):
    result = script(
        READY
        + """
from rclpy.action import ActionServer
from test_msgs.action import Fibonacci
server = ActionServer(node, Fibonacci, 'count', print)
print(compat.node_of_action(server) is node)
"""
    )
    assert result.stdout == 'True\n', result.stderr
