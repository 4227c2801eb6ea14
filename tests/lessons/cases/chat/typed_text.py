"""Answers to `typed_text`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

SAYS = "        self.publisher.publish(String(data=f'Ada: {text}'))\n"
ASKS = "    text = input('Your message: ').strip()\n"

ANSWERS = [
    wrong(
        'without a blank after the colon',
        'A space is a character like any other.',
        ('Ada: {text}', 'Ada:{text}'),
    ),
    wrong(
        'nothing for a namesake',
        'nothing was published for it within 3 s',
        ('    if text:\n', "    if text and not text.startswith('Ada'):\n"),
    ),
    wrong('the first 1000 letters', 'The text ends too early', ('{text}', '{text[:1000]}')),
    wrong(
        'thirty lines and no more',
        'nothing was published for it within 3 s',
        ('    if text:\n', '    teller.count += 1\n    if text and teller.count <= 30:\n'),
        ("'hall', 10)\n", "'hall', 10)\n        self.count = 0\n"),
    ),
    wrong(
        'in capital letters',
        'Capital and small letters differ',
        (').strip()', ').strip().upper()'),
    ),
    wrong(
        'says it again later',
        'A line is published more than once.',
        (
            SAYS,
            f'{SAYS}        self.text = text\n        self.create_timer(1, self.again)\n\n'
            f'    def again(self):\n{SAYS.replace("text}", "self.text}")}',
        ),
    ),
    wrong(
        'four seconds later',
        'nothing was published for it within 3 s',
        ('        teller.say(text)', '        teller.create_timer(4.0, lambda: teller.say(text))'),
    ),
    wrong(
        'no function', 'There is no function called ask', ('def ask', 'ask = None\n\n\ndef tell')
    ),
    wrong(
        'a text box',
        'without a question',
        (ASKS, '    text = Text(description="Say:").value\n'),
        ('from rclpy.node', 'from ipywidgets import Text\nfrom rclpy.node'),
        ('"Say:"', "'Say:'"),
    ),
    wrong('asks twice', 'does it ask in a loop?', (ASKS, f'{ASKS}    text = text or input()\n')),
    wrong('publishes twice', 'A line is published more than once.'),
    wrong(
        'the text and not a message',
        'it got one of type str',
        ("String(data=f'Ada: {text}')", "f'Ada: {text}'"),
        outcome=ERROR,
    ),
    wrong(
        'own process',
        'The check types into this notebook',
        refused='The name is not defined in the program.',
    ),
    wrong('own process, by subprocess', 'The check types into this notebook'),
    wrong('own process, by asyncio', 'The check types into this notebook'),
    right('not spun'),
    right('functions'),
    right(
        'a second for each line',
        ('create_timer(0.1,', 'create_timer(1.0,'),
        of='a list and a timer',
    ),
    right(
        'a node that the first question makes',
        (
            '        teller.say(text)\n\n\nteller = lab.spin(Teller())',
            '        tellers[:] = tellers or [lab.spin(Teller())]\n'
            '        tellers[0].say(text)\n\n\ntellers = []',
        ),
    ),
    right(
        'a list and a timer',
        (
            "'hall', 10)\n",
            "'hall', 10)\n        self.waiting = []\n"
            '        self.create_timer(0.1, self.on_timer)\n\n    def on_timer(self):\n'
            '        while self.waiting:\n            self.say(self.waiting.pop(0))\n',
        ),
        ('teller.say(text)', 'teller.waiting.append(text)'),
    ),
    right(
        'a method of the node',
        ('def ask():\n', 'def ask_in_vain():\n'),
        (
            '\n\ndef ask_in_vain',
            '\n    def ask_for(self, prompt):\n        text = input(prompt)\n'
            '        if text.strip():\n            self.say(text.strip())\n\n\ndef ask_in_vain',
        ),
        (
            'teller = lab.spin(Teller())',
            "teller = lab.spin(Teller())\nask = partial(teller.ask_for, 'Say: ')",
        ),
        ('from rclpy.node', 'from functools import partial\n\nfrom rclpy.node'),
    ),
    right(
        'returns early',
        (
            '    if text:\n        teller.say(text)\n',
            '    if not text:\n        return\n    teller.say(text)\n',
        ),
    ),
]
