"""Exercise: a node that calls a service when it hears a message, without waiting for itself."""

from __future__ import annotations

import random
from typing import Any

from labkit.exercises import Exercise, Mistake, Solution, anything
from labkit.exercises.callback_count import find_node
from labkit.exercises.clauses import WITHIN, Answers, AsksForEach, Named
from labkit.exercises.draws import MANY

__all__ = ['exercise']

WISH, NEWS, SERVICE = '/wish', '/news', '/move_door'
BOOL, STRING = 'std_msgs/msg/Bool', 'std_msgs/msg/String'
NODE = '/porter'
# Not the one of the lesson: her name is in the text that stands in the notebook.
KEEPERS = ('Bo', 'Chidi', 'Dilek', 'Eva', 'Finn', 'Guo', 'Hana')


def _message(wish: bool) -> str:
    return f'{find_node("/door").keeper} {"opened" if wish else "closed"} the door'


OPPOSITE = Mistake(
    'porter/opposite',
    'The request says the opposite of the message.',
    'In the callback of the subscription: SetBool.Request(data=msg.data)',
    model=lambda wish: not wish,
    change=[('data=msg.data', 'data=not msg.data')],
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


def _change(door: Any) -> None:
    door.keeper = random.choice([name for name in KEEPERS if name != door.keeper])


exercise = Exercise(
    name='porter',
    task=f'Call {SERVICE} for each Bool on {WISH}, and publish the message of each response on '
    f'{NEWS}.',
    clauses=(
        Named(NODE),
        AsksForEach(
            WISH,
            NODE,
            SERVICE,
            partner='/door',
            cell='door = lab.spin(make_door())',
            words=f'for each message on `{WISH}` (`{BOOL}`), call `{SERVICE}` once, with the '
            "message's `data` as that of the request",
            request='SetBool.Request(data=msg.data)',
            change=_change,
            mistakes=[OPPOSITE],
        ),
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
