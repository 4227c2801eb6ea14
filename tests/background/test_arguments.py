"""Arguments that rclpy blames on something else, notices late, or dies of."""

from __future__ import annotations

import pytest

SETUP = """
import labkit as lab
import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger
from test_msgs.action import Fibonacci

class Wrong(Node):
    def __init__(self):
        super().__init__('wrong')

    def tick(self):
        pass

    def add(self, request, response):
        return response

wrong = lab.spin(Wrong())
"""
KIND = 'expects the class of'
NAME = 'Pass the name alone, without brackets: wrong.tick'
REFUSED = [
    (
        "ActionClient(wrong, String, 'x')",
        f'ActionClient() {KIND} an action, but got std_msgs/msg/String, which is a message.',
        'such as Fibonacci of test_msgs.action',
    ),
    ("ActionServer(wrong, String, 'x', wrong.tick)", f'ActionServer() {KIND} an action', 'String'),
    ("ActionClient(wrong, String(), 'x')", 'std_msgs/msg/String, which is a message', ''),
    ("ActionClient(wrong, Trigger, 'x')", 'std_srvs/srv/Trigger, which is a service', ''),
    ("ActionClient(wrong, Trigger.Request, 'x')", 'Trigger_Request, which is a message', ''),
    (
        "ActionClient(wrong, Fibonacci.Goal, 'x')",
        'test_msgs/action/Fibonacci_Goal, which is a message',
        'Pass the action itself: Fibonacci, not Fibonacci.Goal.',
    ),
    (
        "ActionServer(wrong, Fibonacci.Impl.SendGoalService, 'x', wrong.tick)",
        'which is a service',
        '',
    ),
    ("ActionClient(wrong, None, 'x')", 'an action, but got None', ''),
    ("wrong.create_publisher(Fibonacci, 'x', 10)", f'{KIND} a message', 'which is an action'),
    ("wrong.create_subscription(Trigger, 'x', print, 10)", 'which is a service', ''),
    (
        "wrong.create_publisher('std_msgs/msg/String', 'x', 10)",
        "create_publisher() expects the class of a message, but got the text 'std_msgs/msg/",
        'Import the class, and pass it: from std_msgs.msg import String',
    ),
    ("wrong.create_client('x', Trigger)", "service, but got the text 'x'", ''),
    ("wrong.create_service(String, 'x', wrong.add)", f'{KIND} a service', 'String'),
    (
        'wrong.create_timer(1.0, wrong.tick())',
        'create_timer() expects a function as its callback, but got None: with brackets, '
        'wrong.tick() calls it at once, and passes on what it returns.',
        NAME,
    ),
    ('wrong.create_timer(1.0, callback=wrong.tick())', 'wrong.tick() calls it at once', NAME),
    ('wrong.create_timer(1.0, None)', 'as its callback, but got None.', 'Pass the name of a'),
    (
        "wrong.create_subscription(\n    String,\n    'x',\n    wrong.tick(),\n    10,\n)",
        'calls it at once',
        NAME,
    ),
    ("wrong.create_subscription(String, 'x', 'tick', 10)", "but got 'tick'.", ''),
    ("wrong.create_service(Trigger, 'x', wrong.tick())", 'calls it at once', NAME),
    ("ActionServer(wrong, Fibonacci, 'x', wrong.tick())", 'as its execute_callback, but', NAME),
    ('rclpy.task.Future().add_done_callback(wrong.tick())', 'calls it at once', NAME),
    (
        "wrong.create_client(Trigger, 'x').call_async(None)",
        'call_async() expects an object of Trigger.Request, but got None.',
        'Make one first, such as Trigger.Request(), and pass it.',
    ),
    (
        "wrong.create_client(Trigger, 'x').call_async(Trigger.Request)",
        'Trigger.Request is the class; call_async() sends an object made of it.',
        'with brackets: Trigger.Request()',
    ),
    (
        "ActionClient(wrong, Fibonacci, 'x').send_goal_async(3)",
        'send_goal_async() expects an object of Fibonacci.Goal, but got 3.',
        '',
    ),
    ('rclpy.spin(Wrong)', 'rclpy.spin() expects a node, but got the class Wrong', 'spin(Wrong())'),
    ('rclpy.spin_once(None)', 'rclpy.spin_once() expects a node, but got None.', ''),
    (
        'rclpy.spin_until_future_complete(Wrong, None)',
        'rclpy.spin_until_future_complete() expects a node, but got the class Wrong',
        '',
    ),
    ('Node(String)', 'Node() expects a name, a text in quotes, but got <class', "as 'talker'"),
    ('rclpy.create_node(5)', 'Node() expects a name, a text in quotes, but got 5.', ''),
    (
        "wrong.create_publisher(String, 10, 'x')",
        'create_publisher() expects a name, a text in quotes, but got 10.',
        "Write it in its place, in quotes, such as 'chatter'.",
    ),
    ('wrong.create_subscription(String, String, print, 10)', 'but got <class', 'in its place'),
    ('wrong.create_client(Trigger, Trigger)', 'create_client() expects a name', "'reset'"),
    ('wrong.create_service(Trigger, wrong.add, "x")', 'create_service() expects', ''),
    ('ActionClient(wrong, Fibonacci, None)', 'ActionClient() expects a name', ''),
    ('ActionServer(wrong, Fibonacci, 3, print)', 'ActionServer() expects a name', ''),
    (
        "rclpy.init(args='--ros-args -r a:=b')",
        "rclpy.init(args=...) expects a list of words, but got one text, '--ros-args -r a:=b'.",
        "args=['--ros-args', '-r', 'chatter:=news']",
    ),
    ("Node('x', cli_args='--ros-args')", 'Node(cli_args=...) expects a list of words', ''),
]


OTHER_TYPES = """
from std_srvs.srv import Empty
from test_msgs.action import NestedMessage
wrong.create_service(Trigger, 'fire', wrong.add)
server = ActionServer(wrong, Fibonacci, 'count', wrong.tick)
"""


@pytest.mark.parametrize(
    ('code', 'words'),
    [
        (
            "wrong.create_client(Empty, 'fire')",
            '/fire is a service of std_srvs/srv/Trigger in this notebook already, and not of std_',
        ),
        ("wrong.create_service(Empty, 'fire', wrong.add)", '/fire is a service of std_srvs/srv/T'),
        (
            "ActionClient(wrong, NestedMessage, 'count')",
            '/count is an action of test_msgs/action/Fibonacci in this notebook already',
        ),
        ("ActionServer(wrong, NestedMessage, 'count', wrong.tick)", '/count is an action of test'),
    ],
)
def test_another_type_is_refused_in_a_sentence(kernel, code, words):
    kernel.run(SETUP)
    kernel.run(OTHER_TYPES)
    result = kernel.run(code)
    assert result.error.startswith(f'LabError: {words}')
    assert f'line 1: {code}' in result.traceback


def test_they_are_refused_in_a_sentence_and_the_line(kernel):
    setup = kernel.run(SETUP)
    for code, words, todo in REFUSED:
        result = kernel.run(code)
        assert result.error.startswith('LabError: '), code
        assert words in result.error
        assert todo in result.error
        assert f'line 1: {code.splitlines()[0]}' in result.traceback or '\n' in code
    kernel.run('wrong.create_timer(0.01, lambda: print("alive"))')
    kernel.wait_for_output(setup.msg_id, 'alive')


SERVED = """
class Served(Node):
    def __init__(self):
        super().__init__('served')
        self.create_service(Trigger, 'fire', self.on_fire)

    def on_fire(self, request, response):
        {end}

served = lab.spin(Served())
client = wrong.create_client(Trigger, 'fire')
client.call_async(Trigger.Request())
"""


@pytest.mark.parametrize(
    ('end', 'returned'),
    [('pass', 'None'), ('return request', 'std_srvs.srv.Trigger_Request()'), ('return True', 'T')],
)
def test_a_service_that_returns_no_response_is_told_where(kernel, end, returned):
    kernel.run(SETUP)
    cell = kernel.run(SERVED.format(end=end))
    shown = kernel.wait_for_output(cell.msg_id, 'return response')
    assert 'The callback on_fire of /served failed.' in shown
    line = next(
        n for n, text in enumerate(SERVED.strip().splitlines(), 1) if 'def on_fire' in text
    )
    assert f'on_fire (Cell In[2], line {line}) returned {returned}' in shown
    assert 'an object of Trigger.Response' in shown


ASKING = """
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup

class Asking(Node):
    def __init__(self):
        super().__init__('asking')
        self.count = 0
        self.client = self.create_client(Trigger, 'fire', callback_group={group})
        self.goals = ActionClient(self, Fibonacci, 'fibonacci', callback_group={group})
        self.timer = self.create_timer(0.01, self.on_timer)

    async def on_timer(self):
        self.timer.cancel()
        {before}
        answer = await self.helped()
        print('answered', type(answer).__name__)

    async def helped(self):
        return await {asks}

    async def later(self):
        future = rclpy.task.Future()
        group = ReentrantCallbackGroup()
        self.create_timer(0.01, lambda: future.set_result(1), callback_group=group)
        await future

    async def execute(self, handle):
        handle.succeed()
        return Fibonacci.Result()

asking = Asking()
served = Node('served')
served.create_service(Trigger, 'fire', lambda request, response: response)
server = ActionServer(served, Fibonacci, 'fibonacci', asking.execute)
lab.spin(served)
lab.spin(asking)
"""
CALLS = 'self.client.call_async(Trigger.Request())'
ASKS = [CALLS, 'self.goals.send_goal_async(Fibonacci.Goal())']


@pytest.mark.parametrize('asks', ASKS)
@pytest.mark.parametrize('before', ['', 'await self.later()'])
def test_a_callback_that_awaits_what_waits_for_it_is_refused(kernel, asks, before):
    kernel.run(SETUP)
    cell = kernel.run(ASKING.format(group='None', asks=asks, before=before))
    shown = kernel.wait_for_output(cell.msg_id, 'MutuallyExclusiveCallbackGroup()')
    assert 'on_timer would wait for ever' in shown
    assert f'in helped\n    return await {asks}' in shown
    assert 'answered' not in shown


@pytest.mark.parametrize('asks', ASKS)
@pytest.mark.parametrize('group', ['MutuallyExclusiveCallbackGroup()', 'ReentrantCallbackGroup()'])
def test_a_callback_may_await_the_answer_in_another_group(kernel, asks, group):
    kernel.run(SETUP)
    cell = kernel.run(ASKING.format(group=group, asks=asks, before=''))
    shown = kernel.wait_for_output(cell.msg_id, 'answered')
    assert 'failed' not in shown


def test_errors_about_arguments_have_the_names_of_rclpy(kernel):
    kernel.run(SETUP)
    for code, words in [
        ('class A(Node):\n    pass\nA()', 'Node.__init__() missing 1 required positional argumen'),
        ('Node()', "Node.__init__() missing 1 required positional argument: 'node_name'"),
        ('rclpy.spin()', "TypeError: spin() missing 1 required positional argument: 'node'"),
        ('wrong.create_publisher(String)', 'Node.create_publisher() missing 2 required'),
        ("ActionServer(wrong, Fibonacci, 'x')", 'ActionServer.__init__() missing 1 required'),
        ('wrong.create_timer(1.0)', 'Node.create_timer() missing 1 required'),
        ("wrong.create_publisher(String, 'x', 10).publish()", 'Publisher.publish() missing 1'),
    ]:
        result = kernel.run(code)
        assert words in result.error
        assert '_NotebookSafe' not in result.traceback
        assert 'make_node' not in result.traceback
