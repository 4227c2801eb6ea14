"""What the check of the exercise porter asks for."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

from labkit.exercises import Fail, expect
from labkit.exercises.clauses import Clause, Evidence

__all__ = ['BOOL', 'NEWS', 'NODE', 'STRING', 'WISH', 'Calls', 'draw', 'explain', 'message']

WISH, NEWS, SERVICE = '/wish', '/news', '/move_door'
BOOL, STRING = 'std_msgs/msg/Bool', 'std_msgs/msg/String'
NODE = '/porter'
# Not the one of the lesson: her name is in the text that stands in the notebook.
KEEPERS = ('Bo', 'Chidi', 'Dilek', 'Eva', 'Finn', 'Guo', 'Hana')
ANSWER_SEC = 2.5
CELL = 'door = lab.spin(make_door())'


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


def message(wish: bool) -> str:
    """Return what the keeper of this door says upon a wish."""
    return f'{_keeper()} {"opened" if wish else "closed"} the door'


def draw() -> list[bool]:
    """Return wishes that are sent as tests."""
    # More than ten: some nodes have had enough then.
    return [True, False, *random.choices([True, False], k=10)]


@dataclass(frozen=True)
class Calls(Clause):
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
            expect.hanging()
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


def explain(wish: bool, came: Sequence[str]) -> tuple[str, str]:
    """Return the misconception and the next step, from what came upon a wish."""
    if not came:
        return (
            f'{SERVICE} was called, and nothing was published when its response came.',
            'future.add_done_callback(self.on_response), and publish in on_response.',
        )
    if all(text == message(not wish) for text in came):
        return (
            'That is the response to another message.',
            'Take the message out of the future that belongs to this call.',
        )
    return (
        'The text is not the message of the response. The door may say something else next time.',
        'Publish future.result().message.',
    )
