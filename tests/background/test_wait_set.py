"""The kept wait set: destroyed entities are released, new ones are noticed."""

from __future__ import annotations

import pytest

SETUP = """
import gc, threading
import labkit as lab
from labkit.background.runtime import runtime
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import String
from std_srvs.srv import Trigger

node = lab.spin(Node('node'))
heard = []
publisher = node.create_publisher(String, 'topic', 10)

def on_message(msg):
    heard.append(msg.data)

def say(text):
    publisher.publish(String(data=text))

def quiet():
    assert runtime.executor.settle(60)
"""


def output(script, code: str) -> str:
    """Return the output of a program with a node that listens to /topic."""
    result = script(SETUP + code)
    assert result.exit_code == 0, result.stderr
    assert result.stderr == ''
    return result.stdout


def test_what_is_made_while_the_background_waits_is_heard(script):
    text = output(
        script,
        """
for number in range(20):
    subscription = node.create_subscription(String, f'topic_{number}', on_message, 10)
    other = node.create_publisher(String, f'topic_{number}', 10)
    quiet()
    other.publish(String(data=str(number)))
    lab.wait_until(lambda: len(heard) == number + 1)
print(heard == [str(number) for number in range(20)])
""",
    )
    assert text == 'True\n'


@pytest.mark.parametrize(
    ('make', 'end', 'gone'),
    [
        (
            "node.create_subscription(String, 'topic', on_message, 10)",
            'node.destroy_subscription(made)',
            'node.count_subscribers("topic") == 0',
        ),
        (
            "node.create_subscription(String, 'topic', on_message, 10)",
            'made.destroy()',
            'node.count_subscribers("topic") == 0',
        ),
        (
            "node.create_service(Trigger, 'ask', lambda request, response: response)",
            'node.destroy_service(made)',
            '"/ask" not in dict(node.get_service_names_and_types())',
        ),
        (
            "node.create_client(Trigger, 'ask')",
            'node.destroy_client(made)',
            'not node.get_client_names_and_types_by_node("node", "/")',
        ),
    ],
)
def test_what_is_destroyed_while_the_background_waits_leaves_the_graph(script, make, end, gone):
    # Without a timer nothing else wakes the background but what is destroyed.
    text = output(
        script,
        f"""
made = {make}
quiet()
{end}
runtime.executor.wake()
lab.wait_until(lambda: {gone})
print('gone')
""",
    )
    assert text == 'gone\n'


def test_who_waits_until_it_is_quiet_has_nothing_gathered_anew(script):
    text = output(
        script,
        """
from labkit.background import wait_set

wait_set.RENEW_SEC = float('inf')
gathered = []
gather = wait_set.KeptWaitSet._gather

def note(*words):
    gathered.append(words)
    gather(*words)

wait_set.KeptWaitSet._gather = note
node.create_subscription(String, 'topic', on_message, 10)
quiet()
assert gathered
gathered.clear()
for number in range(100):
    say(str(number))
    quiet()
print(len(heard), len(gathered))
""",
    )
    assert text == '100 0\n'


def test_a_callback_destroys_its_own_node_and_makes_one_of_the_same_name(script):
    text = output(
        script,
        """
class Phoenix(Node):
    lives = 0

    def __init__(self):
        super().__init__('phoenix')
        self.create_subscription(String, 'topic', self.on_message, 10)
        Phoenix.lives += 1

    def on_message(self, msg):
        heard.append(msg.data)
        lab.remove(self)
        lab.spin(Phoenix())

lab.spin(Phoenix())
for number in range(10):
    say(str(number))
    lab.wait_until(lambda: len(heard) == number + 1 and Phoenix.lives == number + 2)
print(node.count_subscribers('topic'), Phoenix.lives)
lab.wait_until(lambda: node.get_node_names().count('phoenix') == 1)
""",
    )
    assert text == '1 11\n'


def test_what_another_callback_of_the_round_destroys_is_not_run(script):
    text = output(
        script,
        """
def first(msg):
    heard.append('first')
    node.destroy_subscription(second)

node.create_subscription(String, 'topic', first, 10)
second = node.create_subscription(String, 'topic', lambda msg: heard.append('second'), 10)
say('to both')
quiet()
print(heard)
""",
    )
    assert text == "['first']\n"


def test_a_timer_that_is_cancelled_before_its_turn_does_not_tick(script):
    text = output(
        script,
        """
ticks = []
go_on = threading.Event()

def hold(msg):
    go_on.wait(60)
    timer.cancel()

node.create_subscription(String, 'topic', hold, 10)
timer = node.create_timer(0.001, lambda: ticks.append(1))
lab.wait_until(lambda: ticks)
say('hold')
while runtime.executor.running_callback() != ('/node', 'hold'):
    pass
before = len(ticks)
go_on.set()
quiet()
print(len(ticks) - before)
timer.reset()
runtime.executor.wake()
lab.wait_until(lambda: len(ticks) > before + 3)
print('ticks again')
""",
    )
    assert text == '0\nticks again\n'


def test_one_callback_of_a_group_is_under_way_the_others_wait_for_it(script):
    text = output(
        script,
        """
future = Future()

async def slow(msg):
    heard.append('begun')
    await future
    heard.append('done')

group = MutuallyExclusiveCallbackGroup()
guards = []
node.create_subscription(String, 'slow', slow, 10, callback_group=group)
node.create_subscription(String, 'topic', on_message, 10, callback_group=group)
guard = node.create_guard_condition(lambda: heard.append('guard'), callback_group=group)
node.create_subscription(
    String, 'topic', lambda msg: heard.append('free'), 10,
    callback_group=MutuallyExclusiveCallbackGroup(),
)
node.create_publisher(String, 'slow', 10).publish(String())
lab.wait_until(lambda: heard == ['begun'])
say('waits')
guard.trigger()
quiet()
print(heard)
future.set_result(None)
runtime.executor.wake()
quiet()
print(heard)
""",
    )
    assert text == ("['begun', 'free']\n['begun', 'free', 'done', 'waits', 'guard']\n")


def test_guard_conditions_and_the_events_of_qos_are_run(script):
    text = output(
        script,
        """
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.qos import QoSProfile, ReliabilityPolicy

guard = node.create_guard_condition(lambda: heard.append('guard'))
guard.trigger()
lab.wait_until(lambda: 'guard' in heard)
events = SubscriptionEventCallbacks(incompatible_qos=lambda event: heard.append('event'))
weak = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
told = PublisherEventCallbacks(incompatible_qos=lambda event: heard.append('told'))
node.create_publisher(String, 'weak', weak, event_callbacks=told)
made = node.create_subscription(String, 'weak', on_message, 1, event_callbacks=events)
lab.wait_until(lambda: len(heard) == 3)
print(heard[0], sorted(heard[1:]))
""",
    )
    assert text == "guard ['event', 'told']\n"


def test_a_coroutine_goes_on_when_its_node_is_spun_once_more(kernel):
    kernel.run(
        """
import rclpy
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import String
rclpy.init()
node, future, heard = Node('once'), Future(), []
async def on_message(msg):
    heard.append('begun')
    await future
    heard.append('done')
node.create_subscription(String, 'topic', on_message, 10)
publisher = node.create_publisher(String, 'topic', 10)
publisher.publish(String())
"""
    )
    result = kernel.run(
        """
while 'begun' not in heard:
    rclpy.spin_once(node)
future.set_result(None)
node.create_timer(0.01, lambda: None)
while 'done' not in heard:
    rclpy.spin_once(node)
print(heard)
"""
    )
    assert (result.error, result.text) == ('', "['begun', 'done']\n")


def test_a_waitable_that_is_removed_under_way_lets_its_group_go(script):
    text = output(
        script,
        """
async def never(msg):
    heard.append('begun')
    await Future()

node.create_subscription(String, 'topic', on_message, 10)
for number in range(5):
    other = lab.spin(Node('other'))
    other.create_subscription(String, 'topic', never, 10)
    say(str(number))
    lab.wait_until(lambda: heard.count('begun') == number + 1 and str(number) in heard)
    lab.remove(other)
    quiet()
print(heard.count('begun'), runtime.executor.awaiting)
""",
    )
    assert text == '5 0\n'


def test_nodes_come_and_go_from_other_threads_while_others_talk(script):
    text = output(
        script,
        """
import sys
from rclpy.executors import ExternalShutdownException

class Talker(Node):
    def __init__(self, number):
        super().__init__(f'talker_{number}')
        self.said = self.heard = 0
        self.out = self.create_publisher(String, f'talk_{number}', 10)
        self.create_subscription(String, f'talk_{number}', self.on_message, 10)
        self.create_timer(0.002, self.on_timer)

    def on_timer(self):
        self.said += 1
        self.out.publish(String())

    def on_message(self, msg):
        self.heard += 1

talkers = [lab.spin(Talker(number)) for number in range(3)]
failed = []

def come_and_go(name):
    try:
        for _ in range(15):
            guest = Node(name)
            guest.create_subscription(String, 'talk_0', on_message, 10)
            guest.create_timer(0.001, lambda: None)
            lab.spin(guest)
            lab.remove(guest)
    except BaseException as error:
        failed.append(error)

threads = [threading.Thread(target=come_and_go, args=(f'guest_{n}',)) for n in range(3)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
lab.wait_until(lambda: all(talker.heard > 20 for talker in talkers))
for talker in talkers:
    lab.wait_until(lambda: talker.heard == talker.said)
print(failed, [talker.heard > 20 for talker in talkers], len(runtime.nodes()))
""",
    )
    assert text == '[] [True, True, True] 4\n'


@pytest.mark.parametrize(
    'call',
    [
        'spin()',
        'spin_once()',
        'spin_once(timeout_sec=0)',
        'spin_until_future_complete(Future())',
        'spin_once_until_future_complete(Future())',
    ],
)
def test_the_background_executor_is_spun_by_nobody_else(kernel, call):
    kernel.run('import labkit as lab\nfrom rclpy.node import Node\nfrom rclpy.task import Future')
    result = kernel.run(f'node = lab.spin(Node("node"))\nnode.executor.{call}')
    assert result.error.startswith('LabError')
    said = ' '.join(result.traceback.split())
    assert 'spins in the background already' in said
    assert 'lab.wait_until' in result.traceback
