"""Answer each message, and log it: the matchers of a subscription."""

from __future__ import annotations

from labkit.exercises import Exercise, Mistake, Solution, anything
from labkit.exercises.clauses import Answers, Logs

STRING = 'std_msgs/msg/String'


MADE_ONCE = Mistake(
    'demo-greet/made-once',
    'The text that came in is not used.',
    'Put msg.data before the name.',
    model=anything,
    change=[("msg.data + 'Ada'", "'My name is Ada'")],
)

greet = Exercise(
    name='greet',
    task='A node that adds Ada to each text of /demo_incomplete and logs what it heard.',
    clauses=[
        Answers(
            '/demo_incomplete',
            '/demo_complete',
            STRING,
            'publish each text on `/demo_complete`, with `Ada` at its end',
            answer=lambda text: f'{text}Ada',
            mistakes=[MADE_ONCE],
        ),
        Logs('/demo_incomplete', STRING, 'log a line that holds the text'),
    ],
    hints=['The answer is sent in the callback.', 'reply.data = msg.data + "Ada"'],
    answer=Solution(__file__, 'greet.py', 'The callback is where the text is.'),
)
