"""Exercise: one more stage at the end of the chain."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from labkit.exercises import Exercise, Outcome, Probe, Solution, Style, Wrong, changed, expect
from labkit.lessons._script import in_process
from labkit.lessons._stage import find_stage
from labkit.lessons.my_name_is.two_stages import STRING

__all__ = ['third_stage']

ENDING = '. Nice to meet you.'
TESTS = ('My name is Zoe', 'They call me Tim')

_POLITE = """
from rclpy.node import Node
from std_msgs.msg import String


class Polite(Node):
    def __init__(self):
        super().__init__('polite')
        self.publisher = self.create_publisher(String, 'greeting', 10)
        self.subscription = self.create_subscription(String, 'complete', self.on_text, 10)

    def on_text(self, msg):
        self.publisher.publish(String(data=msg.data + '. Nice to meet you.'))


polite = lab.spin(Polite())
"""
_SUM = "msg.data + '. Nice to meet you.'"


def _judge_third_stage(probe: Probe) -> str:
    _refuse_shortcut(probe)
    hears, says = find_stage(probe, '/complete', '/greeting', {'data': TESTS[0]})
    expect.replies(
        probe,
        hears,
        [{'data': text} for text in TESTS],
        says,
        lambda sent: sent['data'] + ENDING,
        explain=_explain,
    )
    done = f'{hears.node} says {TESTS[0] + ENDING!r} when {TESTS[0]!r} comes.'
    greetings = probe.watch('/greeting', STRING)
    if probe.publishers('/complete') and probe.wait(lambda: len(greetings), 1.0):
        return f'{done}\nThe whole chain says {greetings.values("data")[0]!r}.'
    return f'{done}\nThe stages before it do not run at this moment.'


def _refuse_shortcut(probe: Probe) -> None:
    names = {endpoint.node for endpoint in probe.publishers('/greeting')}
    hears = {endpoint.node for endpoint in probe.subscriptions('/complete')}
    for endpoint in probe.subscriptions('/incomplete'):
        expect.that(
            endpoint.node not in names - hears,
            expected='a third stage that subscribes to /complete',
            seen=f'{endpoint.node} subscribes to /incomplete',
            why='It hears stage one and goes past stage two, so the first name is missing.',
            todo="Write the topic as '/complete'.",
        )


def _explain(sent: Mapping[str, Any], came: list[Any]) -> tuple[str, str]:
    text = sent['data']
    if text in came:
        return 'The text is passed on as it came: nothing is added.', f'msg.data + {ENDING!r}'
    if came and not any(text in other for other in came):
        return (
            'What goes out does not hold the text that came in: the string is made beforehand.',
            'Make the string in the callback, of msg.data.',
        )
    beginning = next((other for other in came if other.startswith(text)), '')
    return expect.text_trouble(beginning, text + ENDING), 'Compare the two texts.'


third_stage = Exercise(
    name='third_stage',
    task=f'A node that appends {ENDING!r} to each text of /complete, and publishes it on '
    '/greeting.',
    subscribes={'/complete': STRING},
    publishes={'/greeting': STRING},
    judge=_judge_third_stage,
    hints=[
        'Stage three is like stage two: it hears one topic and publishes on another one.',
        'It hears /complete. Stages one and two need not be changed.',
        f'In the callback: self.publisher.publish(String(data=msg.data + {ENDING!r}))',
    ],
    answer=Solution(
        _POLITE,
        'A chain grows at its end without a change to what is there. Stage two does not know '
        'that somebody listens to it now.',
    ),
    styles=[
        Style(
            'functions',
            """
import rclpy
from std_msgs.msg import String

node = rclpy.create_node('butler')
publisher = node.create_publisher(String, '/greeting', 5)


def bow(text):
    publisher.publish(String(data=f'{text.data}. Nice to meet you.'))


node.create_subscription(String, '/complete', bow, 5)
lab.spin(node)
""",
        ),
        Style(
            'own process',
            in_process(_POLITE),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'listens to stage one',
            changed(_POLITE, ("String, 'complete'", "String, 'incomplete'")),
            'It hears stage one and goes past stage two',
        ),
        Wrong(
            'publishes where it listens',
            changed(_POLITE, ("String, 'greeting', 10", "String, 'complete', 10")),
            'The node hears what it says itself',
        ),
        Wrong(
            'space missing',
            changed(_POLITE, (_SUM, "msg.data + '.Nice to meet you.'")),
            'The spaces are not where they should be.',
        ),
        Wrong(
            'full stop missing',
            changed(_POLITE, (_SUM, "msg.data + '. Nice to meet you'")),
            "The text ends too early: '.' is missing.",
        ),
        Wrong(
            'string built once',
            changed(_POLITE, (_SUM, "'My name is Ada. Nice to meet you.'")),
            'the string is made beforehand',
        ),
        Wrong(
            'nothing added',
            changed(_POLITE, (_SUM, 'msg.data')),
            'The text is passed on as it came',
        ),
        Wrong(
            'publishes a text',
            changed(_POLITE, (f'String(data={_SUM})', _SUM)),
            'publish() takes a message of the type',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'misspelt',
            changed(_POLITE, ("'greeting'", "'greetings'")),
            'names must be equal to the last letter',
        ),
    ],
)
