"""Exercise: a node that calls a service when it hears a message, without waiting for itself."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

from labkit.exercises import Exercise, Fail, Outcome, Solution, Style, Wrong, changed, expect
from labkit.exercises.clauses import Answers, Clause, Evidence, Named
from labkit.lessons._script import in_process

__all__ = ['porter']

WISH, NEWS, SERVICE = '/wish', '/news', '/move_door'
BOOL, STRING = 'std_msgs/msg/Bool', 'std_msgs/msg/String'
NODE = '/porter'
# Not the one of the lesson: her name is in the text that stands in the notebook.
KEEPERS = ('Bo', 'Chidi', 'Dilek', 'Eva', 'Finn', 'Guo', 'Hana')
ANSWER_SEC = 2.5
CELL = 'door = lab.spin(make_door())'

_PORTER = """
from rclpy.node import Node
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool


class Porter(Node):
    def __init__(self):
        super().__init__('porter')
        self.client = self.create_client(SetBool, 'move_door')
        self.publisher = self.create_publisher(String, 'news', 10)
        self.subscription = self.create_subscription(Bool, 'wish', self.on_wish, 10)

    def on_wish(self, msg):
        future = self.client.call_async(SetBool.Request(data=msg.data))
        future.add_done_callback(self.on_response)

    def on_response(self, future):
        self.publisher.publish(String(data=future.result().message))


lab.spin(Porter())
"""
_CALLBACK = """    def on_wish(self, msg):
        future = self.client.call_async(SetBool.Request(data=msg.data))
        future.add_done_callback(self.on_response)

    def on_response(self, future):
        self.publisher.publish(String(data=future.result().message))
"""
_AWAIT = """    async def on_wish(self, msg):
        response = await self.client.call_async(SetBool.Request(data=msg.data))
        self.publisher.publish(String(data=response.message))
"""
_CALL = """    def on_wish(self, msg):
        response = self.client.call(SetBool.Request(data=msg.data))
        self.publisher.publish(String(data=response.message))
"""
_CLIENT = "self.create_client(SetBool, 'move_door')"
_GROUP = """self.create_client(
            SetBool, 'move_door', callback_group=MutuallyExclusiveCallbackGroup()
        )"""
_IMPORT = 'from rclpy.node import Node\n'
_IMPORT_GROUP = 'from rclpy.callback_groups import MutuallyExclusiveCallbackGroup\n'


def _door(evidence: Evidence) -> Any:
    """Return the door of this notebook.

    Raises:
        Fail: It is not there, or nobody spins it.
    """
    from labkit.lessons.services_and_parameters.door import is_door

    found = evidence.probe.node_object('/door')
    expect.that(
        is_door(found) and found.executor is not None,
        expected=f'the door of this lesson, which serves {SERVICE}',
        seen='no door',
        why='Your node is there, and what it should call is not.',
        todo=f'Run the cell again that says: {CELL}',
    )
    return found


def _keeper() -> str:
    """Return who looks after the door now."""
    from labkit.exercises.callbacks import find_node

    return str(find_node('/door').keeper)


def _message(wish: bool) -> str:
    return f'{_keeper()} {"opened" if wish else "closed"} the door'


def _draw() -> list[bool]:
    # More than ten: some nodes have had enough then.
    return [True, False, *random.choices([True, False], k=10)]


@dataclass(frozen=True)
class _Calls(Clause):
    """The service is called once for each message, with its value."""

    @property
    def text(self) -> str:
        """What is asked for."""
        return (
            f'for each message on `{WISH}` (`{BOOL}`), call `{SERVICE}` once, with its `data` '
            'as `data` of the request'
        )

    def find(self, evidence: Evidence) -> None:
        """Look for the subscription and for the door, and let somebody else keep it."""
        evidence.subscription(WISH, NODE)
        door = _door(evidence)
        door.keeper = random.choice([name for name in KEEPERS if name != door.keeper])

    def tests(self, evidence: Evidence) -> Sequence[Any]:
        """Count the calls from now on. The tests are those of the answers."""
        _door(evidence).calls.clear()
        return ()

    def judge(self, evidence: Evidence) -> str:
        """Compare what was heard with what was called."""
        heard = [sample.message.data for sample in evidence.life.on(WISH)]
        # Of a process that is slow the last call may be on its way.
        calls = _door(evidence).calls
        evidence.probe.wait(lambda: len(calls) >= len(heard), 0.5)
        if list(calls) != heard:
            self._refuse(evidence, heard, list(calls))
        return f'{len(heard)} messages, {len(calls)} calls of {SERVICE}.'

    def _refuse(
        self, evidence: Evidence, heard: Sequence[bool], calls: Sequence[bool]
    ) -> NoReturn:
        self._refuse_deadlock(evidence, heard, calls)
        why = 'What is called differs from what was heard.'
        todo = 'In the callback of the subscription: SetBool.Request(data=msg.data)'
        if not calls:
            expect.hanging(evidence.probe)
            expect.spun(evidence.probe, evidence.subscription(WISH, NODE))
            why = 'No request has come to the door. A request alone calls nothing.'
            todo = 'In the callback: self.client.call_async(request)'
        elif len(calls) > len(heard):
            why = 'The service is called more often than messages come.'
            todo = 'Call it once in the callback of the subscription, and nowhere else.'
        elif len(calls) < len(heard):
            why = 'Some messages lead to a call, and others do not.'
            todo = 'Call the service for each message, True or False, also for a repeated one.'
        elif len({*calls}) == 1:
            why = 'The request is always the same, whatever the message says.'
        elif [not data for data in calls] == list(heard):
            why = 'The request says the opposite of the message.'
        raise Fail(
            f'calls of {SERVICE} with data = {expect.show(heard)}',
            f'{len(calls)} calls' + (f' with data = {expect.show(calls)}' if calls else ''),
            why=why,
            todo=todo,
        )

    def _refuse_deadlock(
        self, evidence: Evidence, heard: Sequence[bool], calls: Sequence[bool]
    ) -> None:
        """Raise Fail if the node has made a call, and does nothing any more."""
        from labkit.background.service_calls import wait_until_spun

        probe = evidence.probe
        if 0 < len(calls) < len(heard) and not wait_until_spun(probe.spun_node, NODE, ANSWER_SEC):
            raise Fail(
                f'a call of {SERVICE} for each message',
                f'{len(calls)} of {len(heard)} calls, and then {NODE} answers nobody any more',
                why='Its callback waits for the response: by call(), or by await with a client in '
                'the same callback group. The response can be taken only when this callback has '
                'returned. So it waits for ever: a deadlock.',
                todo='Use call_async() and add_done_callback(), and return from the callback.',
            )


def _explain(wish: bool, came: Sequence[str]) -> tuple[str, str]:
    if not came:
        return (
            f'{SERVICE} was called, and nothing was published when its response came.',
            'future.add_done_callback(self.on_response), and publish in on_response.',
        )
    if all(text == _message(not wish) for text in came):
        return (
            'That is the response to another message.',
            'Take the message out of the future that belongs to this call.',
        )
    return (
        'The text is not the message of the response. The door may say something else next time.',
        'Publish future.result().message.',
    )


porter = Exercise(
    name='porter',
    task='Call /move_door for each Bool on /wish, and publish the message of each response on '
    '/news.',
    publishes={NEWS: STRING},
    subscribes={WISH: BOOL},
    nodes=[NODE],
    clauses=(
        Named(NODE),
        _Calls(),
        Answers(
            WISH,
            NEWS,
            f'publish the `message` of each response on `{NEWS}` (`{STRING}`), once, within a '
            'second',
            answer=_message,
            draw=_draw,
            by=NODE,
            explain=_explain,
        ),
    ),
    hints=[
        'The callback of the subscription must not wait. Who takes the response then?',
        'call_async() gives a future. Its add_done_callback() says who gets it when it is done.',
        'future.add_done_callback(self.on_response), and in on_response(self, future): '
        'future.result().message',
    ],
    answer=Solution(
        _PORTER,
        'The callback of the subscription sends the request and returns. When the response is '
        'there, on_response is called with the future that holds it.',
    ),
    styles=[
        Style(
            'await, and a callback group for the client',
            changed(
                _PORTER,
                (_CALLBACK, _AWAIT),
                (_CLIENT, _GROUP),
                (_IMPORT, f'{_IMPORT_GROUP}{_IMPORT}'),
            ),
        ),
        Style(
            'lambda',
            changed(
                _PORTER,
                (
                    _CALLBACK,
                    '    def on_wish(self, msg):\n'
                    '        future = self.client.call_async(SetBool.Request(data=msg.data))\n'
                    '        future.add_done_callback(lambda done: self.say(done.result()))\n\n'
                    '    def say(self, response):\n'
                    '        self.publisher.publish(String(data=response.message))\n',
                ),
            ),
        ),
        Style(
            'waits until the door is there',
            changed(
                _PORTER,
                (
                    _CLIENT,
                    f'{_CLIENT}\n        while not self.client.wait_for_service('
                    "timeout_sec=1.0):\n            self.get_logger().info('waiting')",
                ),
            ),
        ),
        Style('own process', in_process(_PORTER), process=True),
        Style(
            'own process, two threads, and call()',
            changed(
                in_process(
                    changed(
                        _PORTER,
                        (_CALLBACK, _CALL),
                        (_CLIENT, _GROUP),
                        (_IMPORT, f'{_IMPORT_GROUP}{_IMPORT}'),
                    )
                ),
                ('rclpy.spin(Porter())', 'rclpy.spin(Porter(), MultiThreadedExecutor(2))'),
                (
                    'from rclpy.node import Node\n',
                    'from rclpy.executors import MultiThreadedExecutor\n'
                    'from rclpy.node import Node\n',
                ),
            ),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'call() in the callback',
            changed(_PORTER, (_CALLBACK, _CALL)),
            'inside a callback would wait for ever',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'call() in the callback, in a process of its own',
            in_process(changed(_PORTER, (_CALLBACK, _CALL))),
            'So it waits for ever: a deadlock.',
            process=True,
        ),
        Wrong(
            'await in one callback group',
            changed(_PORTER, (_CALLBACK, _AWAIT)),
            'So it waits for ever: a deadlock.',
        ),
        Wrong(
            'has had enough after ten',
            changed(
                _PORTER,
                (
                    '    def on_wish(self, msg):\n',
                    '    def on_wish(self, msg):\n'
                    "        self.wishes = getattr(self, 'wishes', 0) + 1\n"
                    '        if self.wishes > 10:\n            return\n',
                ),
            ),
            'Some messages lead to a call, and others do not.',
        ),
        Wrong(
            'does not wait at all',
            changed(
                _PORTER,
                (
                    '        future.add_done_callback(self.on_response)\n',
                    '        self.on_response(future)\n',
                ),
            ),
            'was not done yet',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'no done callback',
            changed(
                _PORTER,
                ('        future.add_done_callback(self.on_response)\n', ''),
                ('        future = self.client', '        self.future = self.client'),
            ),
            'nothing was published when its response came',
        ),
        Wrong(
            'always opens',
            changed(_PORTER, ('SetBool.Request(data=msg.data)', 'SetBool.Request(data=True)')),
            'The request is always the same',
        ),
        Wrong(
            'the opposite',
            changed(_PORTER, ('Request(data=msg.data)', 'Request(data=not msg.data)')),
            'The request says the opposite',
        ),
        Wrong(
            'calls twice',
            changed(
                _PORTER,
                (
                    '        future = self.client.call_async(SetBool.Request(data=msg.data))\n',
                    '        self.client.call_async(SetBool.Request(data=msg.data))\n'
                    '        future = self.client.call_async(SetBool.Request(data=msg.data))\n',
                ),
            ),
            'The service is called more often than messages come.',
        ),
        Wrong(
            'opens only',
            changed(
                _PORTER,
                (
                    '        future = self.client',
                    '        if not msg.data:\n            return\n        future = self.client',
                ),
            ),
            'Some messages lead to a call',
        ),
        Wrong(
            'a text of its own',
            changed(_PORTER, ('future.result().message', "'Ada opened the door'")),
            'The text is not the message of the response.',
        ),
        Wrong(
            'publishes twice',
            changed(
                _PORTER,
                (
                    '        self.publisher.publish(String(data=future.result().message))\n',
                    '        for _ in range(2):\n            self.publisher.publish(String('
                    'data=future.result().message))\n',
                ),
            ),
            'A message is answered more than once.',
        ),
        Wrong(
            'no call',
            changed(
                _PORTER,
                (
                    '        future = self.client.call_async(SetBool.Request(data=msg.data))\n'
                    '        future.add_done_callback(self.on_response)\n',
                    '        self.request = SetBool.Request(data=msg.data)\n',
                ),
            ),
            'No request has come to the door.',
        ),
        Wrong(
            'another topic',
            changed(_PORTER, ("'news'", "'new'")),
            'names must be equal to the last letter',
        ),
        Wrong(
            'another node name',
            changed(_PORTER, ("__init__('porter')", "__init__('portier')")),
            'The name is what super().__init__() gets',
        ),
        Wrong(
            'not spun',
            changed(_PORTER, ('lab.spin(Porter())', 'Porter()')),
            'Hand the node over: lab.spin(node)',
        ),
    ],
)
