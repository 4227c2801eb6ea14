"""Contract tests for the private names of rclpy and ipykernel that labkit uses."""

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


def test_an_entity_is_taken_from_and_its_callback_run(script):
    result = script(
        READY
        + """
from rclpy.waitable import NumberOfEntities
from std_msgs.msg import String
heard = []
subscription = node.create_subscription(String, '/topic', lambda msg: heard.append(msg.data), 10)
guard = node.create_guard_condition(lambda: heard.append('guard'))
timer = node.create_timer(0.001, lambda: heard.append('timer'))
publisher = node.create_publisher(String, '/topic', 10)
publisher.publish(String(data='hello'))
guard.trigger()
take = compat.takers(executor)
print(sorted(take))

count = NumberOfEntities(1, 3, 1)
wait_set = compat.new_wait_set(executor.context.handle, count)
own = compat.own_guards(executor)
executor.wake()
ready = {}
while len(ready) < 4:
    wait_set.clear_entities()
    wait_set.add_subscription(subscription.handle)
    wait_set.add_timer(timer.handle)
    for each in (guard, *own):
        wait_set.add_guard_condition(each.handle)
    wait_set.wait(10**9)
    for kind in ('subscription', 'timer', 'guard_condition'):
        for pointer in wait_set.get_ready_entities(kind):
            ready[pointer] = kind
print(own[0].handle.pointer in ready, own[1].handle.pointer in ready)
for entity, kind in ((subscription, 'subscription'), (timer, 'timer'), (guard, 'guard_condition')):
    try:
        take[kind](entity)().send(None)
    except StopIteration:
        pass
print(heard, take['subscription'](subscription))
subscription.destroy()
print(take['subscription'](subscription))
executor.shutdown()
print(compat.own_guards(executor))
"""
    )
    assert result.stdout == (
        "['client', 'guard_condition', 'service', 'subscription', 'timer', 'waitable']\n"
        "True False\n['hello', 'timer', 'guard'] None\nNone\n[]\n"
    ), result.stderr


def test_requests_and_responses_are_taken(script):
    result = script(
        READY
        + """
from std_srvs.srv import Trigger
def serve(request, response):
    response.message = 'served'
    return response
service = node.create_service(Trigger, 'ask', serve)
client = node.create_client(Trigger, 'ask')
while not client.service_is_ready():
    pass
future = client.call_async(Trigger.Request())
take = compat.takers(executor)
def run(kind, entity):
    try:
        take[kind](entity)().send(None)
    except StopIteration:
        pass
while not future.done():
    run('service', service)
    run('client', client)
print(future.result().message)
"""
    )
    assert result.stdout == 'served\n', result.stderr


def test_a_task_knows_what_it_runs(script):
    result = script(
        READY
        + """
task = executor.create_task(print, 'done')
print(compat.handler_of(task) is print)
executor.spin_once(timeout_sec=0)
print(compat.handler_of(task), compat.is_shut_down(executor))
executor.shutdown()
print(compat.is_shut_down(executor))
"""
    )
    assert result.stdout == 'True\ndone\nNone False\nTrue\n', result.stderr


def test_an_executor_knows_its_tasks(script):
    result = script(
        READY
        + """
def tick():
    print([(each is timer, owner is node) for _, each, owner in compat.tasks_of(executor)])
timer = node.create_timer(0.001, tick)
executor.spin_once()
timer.cancel()
print(compat.tasks_of(executor))
executor.create_task(print)
print([(each, owner) for _, each, owner in compat.tasks_of(executor)])
"""
    )
    assert result.stdout == '[(True, True)]\n[]\n[(None, None)]\n', result.stderr


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
    number = 'print(len(In) - 1, compat.running_number())'
    assert kernel.run(number).text == '2 2\n'
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


def test_a_page_is_heard_while_a_cell_runs(kernel):
    subshell = kernel.new_subshell()
    code = """
import threading
from comm import create_comm
from labkit.background import compat
heard = threading.Event()
comm = create_comm(target_name='a view')
compat.hear_while_cells_run(comm)
comm.on_msg(lambda message: heard.set())
thread = threading.Thread(target=comm.send, args=({},))  # as the background does
thread.start()
thread.join()
print(comm.comm_id)
"""
    made = kernel.run(code)
    running = kernel.start("print('running', flush=True)\nprint(heard.wait(20))")
    kernel.wait_for_output(running, 'running')
    kernel.say(made.text.strip(), {}, subshell)
    assert kernel.finish(running).text == 'running\nTrue\n'


def test_what_a_page_says_shows_no_figure_that_a_cell_still_draws(kernel):
    subshell = kernel.new_subshell()
    code = """
import threading
import matplotlib.pyplot as plt
from comm import create_comm
import labkit
from labkit.background import compat
heard = threading.Semaphore(0)
comm = create_comm(target_name='a view')
compat.hear_while_cells_run(comm)
comm.on_msg(lambda message: heard.release())
print(comm.comm_id)
"""
    made = kernel.run(code)
    drawing = """
figure = plt.figure()
print('drawing', flush=True)
print(all(heard.acquire(timeout=20) for _ in range(2)), plt.get_fignums())
"""
    running = kernel.start(drawing)
    kernel.wait_for_output(running, 'drawing')
    # The events of the first message are over when the second one is heard.
    for _ in range(2):
        kernel.say(made.text.strip(), {}, subshell)
    result = kernel.finish(running)
    assert result.text.startswith('drawing\nTrue [1]\n')
    assert [each['output_type'] for each in result.outputs] == ['stream', 'display_data']


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


def test_every_private_name_is_here():
    from labkit.background import compat

    source = inspect.getsource(inspect.getmodule(test_every_private_name_is_here))
    for name in compat.__all__:
        assert f'compat.{name}' in source, f'{name} has no contract test'


def test_what_forked_processes_print_comes_by_no_port(kernel):
    code = """
import multiprocessing, os, psutil, sys
own = psutil.Process().net_connections('inet')
print([connection.laddr for connection in own])
sys.stdout.flush()
child = multiprocessing.get_context('fork').Process(target=print, args=('printed by a child',))
child.start(); child.join()
if os.fork() == 0:
    print('and by another', flush=True)
    os._exit(0)
"""
    request = kernel.start(code)
    kernel.finish(request)
    shown = kernel.wait_for_output(request, 'and by another')
    assert shown.startswith('[]\n') and 'printed by a child\n' in shown


def test_text_is_written_for_a_request(kernel):
    kernel.run('import sys\nfrom labkit.background import compat')
    write = 'compat.write_for(compat.running_request(), {}, "word\\n")'
    stream = 'getattr(sys.stdout, "target", sys.stdout)'
    assert kernel.run(write.format(stream)).text == 'word\n'
    # As with the ipykernel of Google Colab; tests/setup/test_kernel.py has that one itself.
    kernel.run(
        'class Old:\n    name, topic = "stdout", b"stream.stdout"\n'
        'compat.is_kernel_stream = lambda stream: True'
    )
    assert kernel.run(write.format('Old()')).text == 'word\n'


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


def test_the_event_that_a_handler_waits_for_is_known(script):
    result = script(
        READY
        + """
from rclpy.action import ActionClient
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.waitable import NumberOfEntities
from std_msgs.msg import String
from test_msgs.action import Fibonacci
events = PublisherEventCallbacks(matched=print)
publisher = node.create_publisher(String, '/topic', 10, event_callbacks=events)
[*_, matched] = [one for one in publisher.event_handlers if one.callback is print]
event = compat.event_of(matched)
count = NumberOfEntities()
count.num_events = 1
wait_set = compat.new_wait_set(executor.context.handle, count)
for add in (lambda: matched.add_to_wait_set(wait_set), lambda: wait_set.add_event(event)):
    node.create_subscription(String, '/topic', print, 10)
    wait_set.clear_entities()
    add()
    wait_set.wait(10**9)
    print(wait_set.is_ready('event', 0), matched.is_ready(wait_set), matched.take_data() is None)
print(compat.event_of(ActionClient(node, Fibonacci, 'fibonacci')))
"""
    )
    assert result.stdout == 'True True False\nTrue True False\nNone\n', result.stderr


TYPE_DESCRIPTIONS = """
import threading

def described():
    return sorted(
        name for name, _ in observer.get_service_names_and_types() if name.endswith('description')
    )

observer = Node('observer')
"""


def test_what_describes_types_leaves_the_graph_with_its_node(script):
    """Without it the service of each node that was ever destroyed stays, with 0.1 MB."""
    result = script(
        READY
        + TYPE_DESCRIPTIONS
        + """
print(described())
compat.end_type_descriptions(node)
print(described())
compat.end_type_descriptions(node)
node.destroy_node()
compat.end_type_descriptions(node)
print(described(), [name for name in observer.get_node_names() if name == 'node'])
bare = Node('bare', parameter_overrides=[
    rclpy.parameter.Parameter('start_type_description_service', value=False)
])
compat.end_type_descriptions(bare)
observer.destroy_node()
rclpy.shutdown()
"""
    )
    before, after = "['/node/get_type_description', ", "['/observer/get_type_description']"
    assert result.stdout == f'{before}{after[1:]}\n{after}\n{after} []\n', result.stderr
    assert result.stderr == ''


def test_what_describes_types_is_ended_while_an_executor_waits(script):
    result = script(
        READY
        + TYPE_DESCRIPTIONS
        + """
waiting = threading.Event()
node.create_guard_condition(waiting.set).trigger()
thread = threading.Thread(target=executor.spin)
thread.start()
for number in range(50):
    waiting.wait()
    compat.end_type_descriptions(node)
    node.destroy_node()
    executor.remove_node(node)
    print(*described())
    waiting.clear()
    node = Node('node')
    node.create_guard_condition(waiting.set).trigger()
    executor.add_node(node)
executor.shutdown()
thread.join()
"""
    )
    assert result.stdout == '/observer/get_type_description\n' * 50, result.stderr


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


def test_messages_that_wait_for_a_subscription_are_taken(script):
    result = script(
        """
import rclpy
from labkit.background import compat
from rclpy.node import Node
from std_msgs.msg import String

rclpy.init()
node = Node('node')
subscription = node.create_subscription(String, '/topic', print, 3, raw=True)
publisher = node.create_publisher(String, '/topic', 10)
print(compat.take_all(subscription, 10))
for _ in range(5):
    publisher.publish(String(data=''))
print(compat.take_all(subscription, 2), compat.take_all(subscription, 10))
"""
    )
    assert result.stdout == '0\n2 1\n', result.stderr


def test_a_thread_displays_under_an_earlier_cell_and_updates_it(kernel):
    first = kernel.run('from labkit.background import compat\nrequest = compat.running_request()')
    later = kernel.run(
        """
import threading
def show():
    compat.display_under(request, {'text/plain': 'first'}, 'its name', update=False)
    compat.display_under(request, {'text/plain': 'second'}, 'its name', update=True)
    compat.display_under(request, {'text/plain': 'third'}, 'other name', update=False)
thread = threading.Thread(target=show)
thread.start()
thread.join()
"""
    )
    assert (later.error, later.text) == ('', '')
    assert kernel.wait_for_output(first.msg_id, 'third') == 'first\nthird\n'


def test_what_a_callback_awaits_is_known(script):
    result = script(
        READY
        + """
from rclpy.task import Future
future = Future()
async def inner():
    return await future
async def outer():
    return await inner()
task = Task(outer)
print(compat.awaited_by(task))
task()
print(compat.awaited_by(task) is future)
future.set_result(1)
task()
print(task.result(), compat.awaited_by(task))
"""
    )
    assert result.stdout == 'None\nTrue\n1 None\n', result.stderr


def test_an_action_client_and_the_timer_of_a_rate_are_known(script):
    result = script(
        READY
        + """
from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle
from test_msgs.action import Fibonacci
client = ActionClient(node, Fibonacci, 'fibonacci')
response = Fibonacci.Impl.SendGoalService.Response()
handle = ClientGoalHandle(client, [0] * 16, response)
print(compat.action_type_of(client) is Fibonacci, compat.client_of_goal(handle) is client)
made, create_timer = [], node.create_timer
def create(period, callback, *args):
    made.append(compat.is_of_rate(node, *args))
    return create_timer(period, callback, *args)
node.create_timer = create
node.create_rate(10)
node.create_timer(1.0, print)
node.create_timer(1.0, print, node.default_callback_group)
print(made)
"""
    )
    assert result.stdout == 'True True\n[True, False, False]\n', result.stderr


def test_feedback_of_a_goal_outlives_its_result(script):
    result = script(
        READY
        + """
from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle
from rclpy.task import Future
from test_msgs.action import Fibonacci
from unique_identifier_msgs.msg import UUID
client = ActionClient(node, Fibonacci, 'fibonacci')
goal = bytes(16)
future = Future()
# As rclpy does with the result.
future.add_done_callback(lambda _: client._feedback_callbacks.pop(goal))
client._feedback_callbacks[goal] = print
handle = ClientGoalHandle(client, UUID(), Fibonacci.Impl.SendGoalService.Response())
forget = compat.keep_feedback(handle, future)
future.set_result(None)
print(client._feedback_callbacks == {goal: print})
forget()
print(client._feedback_callbacks)
"""
    )
    assert result.stdout == 'True\n{}\n', result.stderr


def test_parameters_requests_and_the_timer_of_a_rate_are_known(script):
    result = script(
        READY
        + """
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger
node = Node('given', parameter_overrides=[Parameter('speed', value=1)])
node.declare_parameter('size', 2)
given, declared = compat.parameters_of(node)
print(given, 'size' in declared, 'speed' in declared)
print(compat.parameter_values(node)['size'], compat.has_parameter_callbacks(node))
node.add_post_set_parameters_callback(print)
print(compat.has_parameter_callbacks(node))
client = node.create_client(Trigger, 'work')
print(compat.pending_requests(client))
client.call_async(Trigger.Request())
print(compat.pending_requests(client))
print(compat.timer_of_rate(node.create_rate(10)) in node.timers)
"""
    )
    assert result.stdout == ("['speed'] True False\n2 False\nTrue\n0\n1\nTrue\n"), result.stderr
