"""Exercise: a node that calls a service when it hears a message, without waiting for itself."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any

from labkit.exercises import Exercise, Fail, Mistake, Solution, anything, expect
from labkit.exercises.callbacks import find_node
from labkit.exercises.clauses import WITHIN, Answers, Evidence, GraphClause, Named
from labkit.exercises.draws import MANY
from labkit.lessons.services_and_parameters.door import is_door

__all__ = ['porter']

WISH, NEWS, SERVICE = '/wish', '/news', '/move_door'
BOOL, STRING = 'std_msgs/msg/Bool', 'std_msgs/msg/String'
NODE = '/porter'
# Not the one of the lesson: her name is in the text that stands in the notebook.
KEEPERS = ('Bo', 'Chidi', 'Dilek', 'Eva', 'Finn', 'Guo', 'Hana')
ANSWER_SEC = 2.5


def _message(wish: bool) -> str:
    return f'{find_node("/door").keeper} {"opened" if wish else "closed"} the door'


_CALL = 'future = self.client.call_async(SetBool.Request(data=msg.data))\n'
_DATA = 'In the callback of the subscription: SetBool.Request(data=msg.data)'
NO_DOOR = Mistake(
    'porter/no-door',
    'Your node is there, and what it should call is not.',
    'Run the cell again that says: door = lab.spin(make_door())',
)
DEADLOCK = Mistake(
    'porter/deadlock',
    'Its callback waits for the response: by call(), or by await with a client in the same '
    'callback group. The response can be taken only when this callback has returned. So it waits '
    'for ever: a deadlock.',
    'Use call_async() and add_done_callback(), and return from the callback.',
)
NO_CALL = Mistake(
    'porter/no-call',
    'No request has come to the door. A request alone calls nothing.',
    'In the callback: self.client.call_async(request)',
    change=[
        (
            f'        {_CALL}        future.add_done_callback(self.on_response)\n',
            '        self.request = SetBool.Request(data=msg.data)\n',
        )
    ],
)
CALLS_MORE = Mistake(
    'porter/calls-more',
    'The service is called more often than messages come.',
    'Call it once in the callback of the subscription, and nowhere else.',
    change=[(_CALL, f'self.client.call_async(SetBool.Request(data=msg.data))\n        {_CALL}')],
)
CALLS_SOME = Mistake(
    'porter/calls-some',
    'Some messages lead to a call, and others do not.',
    'Call the service for each message, True or False, also for a repeated one.',
    change=[(_CALL, f'if not msg.data:\n            return\n        {_CALL}')],
)
SAME_REQUEST = Mistake(
    'porter/same-request',
    'The request is always the same, whatever the message says.',
    _DATA,
    change=[('data=msg.data', 'data=True')],
)
OPPOSITE = Mistake(
    'porter/opposite',
    'The request says the opposite of the message.',
    _DATA,
    change=[('data=msg.data', 'data=not msg.data')],
)
OTHER_REQUEST = Mistake(
    'porter/other-request', 'What is called differs from what was heard.', _DATA
)
MISTAKES = (
    Mistake(
        'porter/no-done-callback',
        f'{SERVICE} was called, and nothing was published when its response came.',
        'future.add_done_callback(self.on_response), and publish in on_response.',
        model=lambda wish: None,
        change=[
            ('        future.add_done_callback(self.on_response)\n', ''),
            ('        future = self.client', '        self.future = self.client'),
        ],
    ),
    Mistake(
        'porter/other-response',
        'That is the response to another message.',
        'Take the message out of the future that belongs to this call.',
        model=lambda wish: _message(not wish),
    ),
    Mistake(
        'porter/own-text',
        'The text is not the message of the response. The door may say something else next time.',
        'Publish future.result().message.',
        model=anything,
        change=[('future.result().message', "'Ada opened the door'")],
    ),
)


class _Calls(GraphClause):
    """The service is called once for each message, with its value."""

    text = (
        f"for each message on `{WISH}` (`{BOOL}`), call `{SERVICE}` once, with the message's "
        '`data` as that of the request'
    )

    def find(self, evidence: Evidence) -> None:
        """Look for the subscription and for the door, and let somebody else keep it."""
        evidence.subscription(WISH, NODE)
        door = _door()
        expect.only_given(evidence.probe, SERVICE, '/door')
        expect.asks(evidence.probe, NODE, SERVICE)
        evidence.partners.add('/door')
        door.keeper = random.choice([name for name in KEEPERS if name != door.keeper])

    def tests(self, evidence: Evidence) -> Sequence[Any]:
        """Count the calls from now on. The tests are those of the answers."""
        _door().calls.clear()
        return ()

    def judge(self, evidence: Evidence) -> str:
        """Compare what was heard with what was called."""
        from labkit.asking.service_calls import wait_until_spun

        probe, called = evidence.probe, _door().calls
        heard = [sample.message.data for sample in evidence.life.on(WISH)]
        # Of a process that is slow the last call may be on its way.
        probe.wait(lambda: len(called) >= len(heard), 0.5)
        calls = list(called)
        if calls == heard:
            return f'{len(heard)} messages, {len(calls)} calls of {SERVICE}.'
        if 0 < len(calls) < len(heard) and not wait_until_spun(probe.spun_node, NODE, ANSWER_SEC):
            raise Fail(
                f'a call of {SERVICE} for each message',
                f'{len(calls)} of {len(heard)} calls, and then {NODE} answers nobody any more',
                DEADLOCK,
            )
        if not calls:
            expect.hanging()
            expect.spun(probe, evidence.subscription(WISH, NODE))
        wanted, seen = expect.apart(heard, calls)
        raise Fail(
            f'{len(heard)} calls of {SERVICE} with data = {wanted}',
            f'{len(calls)} calls' + (f' with data = {seen}' if calls else ''),
            _mistake(heard, calls),
        )


def _mistake(heard: Sequence[bool], calls: Sequence[bool]) -> Mistake:
    if len(calls) != len(heard):
        return CALLS_MORE if len(calls) > len(heard) else CALLS_SOME if calls else NO_CALL
    if len({*calls}) == 1:
        return SAME_REQUEST
    return OPPOSITE if [not data for data in calls] == heard else OTHER_REQUEST


def _door() -> Any:
    """Return the door of this notebook; raise Fail if nobody spins it."""
    found = find_node('/door')
    if not is_door(found) or found.executor is None:
        raise Fail(f'the door of this lesson, which serves {SERVICE}', 'no door', NO_DOOR)
    return found


porter = Exercise(
    name='porter',
    task=f'Call {SERVICE} for each Bool on {WISH}, and publish the message of each response on '
    f'{NEWS}.',
    clauses=(
        Named(NODE),
        _Calls(),
        Answers(
            WISH,
            NEWS,
            BOOL,
            f'publish the `message` of each response on `{NEWS}` (`{STRING}`), once, {WITHIN}',
            answer=_message,
            draw=lambda: [True, False, *random.choices([True, False], k=MANY)],
            outer_type=STRING,
            by=NODE,
            mistakes=MISTAKES,
            # The door gets another keeper in each check.
            lasting=False,
        ),
    ),
    hints=[
        'The callback of the subscription must not wait. Who takes the response then?',
        'call_async() gives a future. Its add_done_callback() says who gets it when it is done.',
        'future.add_done_callback(self.on_response), and in on_response(self, future): '
        'future.result().message',
    ],
    answer=Solution(
        __file__,
        'porter.py',
        'The callback of the subscription sends the request and returns. When the response is '
        'there, on_response is called with the future that holds it.',
    ),
)
