"""Answers to `teller`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'says blanks, too',
        'Nothing should be published for',
        (
            '        if text:\n            self.publisher',
            '        if True:\n            self.publisher',
        ),
    ),
    wrong(
        'without a blank after the colon',
        'A space is a character like any other.',
        ('Ada: {text}', 'Ada:{text}'),
    ),
    wrong(
        'in capital letters',
        'Capital and small letters differ',
        ('msg.data.strip()', 'msg.data.strip().upper()'),
    ),
    wrong(
        'twice',
        'A message is answered more than once.',
        (
            "            self.publisher.publish(String(data=f'Ada: {text}'))\n",
            '            for _ in range(2):\n'
            "                self.publisher.publish(String(data=f'Ada: {text}'))\n",
        ),
    ),
    wrong(
        'the first one again and again',
        'What is said is not what was typed.',
        (
            "        super().__init__('teller')\n",
            "        super().__init__('teller')\n        self.text = ''\n",
        ),
        (
            '        text = msg.data.strip()\n',
            '        self.text = self.text or msg.data.strip()\n        text = self.text\n',
        ),
    ),
    wrong('another topic', 'A slip of the pen?'),
    wrong(
        'the text and not a message',
        'it got one of type str',
        ("String(data=f'Ada: {text}')", "f'Ada: {text}'"),
        outcome=ERROR,
    ),
    wrong('not spun', 'takes them out'),
    right('functions'),
    right(
        'a list and a timer',
        (
            "'typed', self.on_typed, 10)\n",
            "'typed', self.note, 10)\n        self.waiting = []\n"
            '        self.create_timer(0.1, self.on_timer)\n\n    def note(self, msg):\n'
            '        self.waiting.append(msg)\n\n    def on_timer(self):\n'
            '        while self.waiting:\n'
            '            self.on_typed(self.waiting.pop(0))\n',
        ),
    ),
    right(
        'returns early',
        (
            "        if text:\n            self.publisher.publish(String(data=f'Ada: {text}'))\n",
            '        if not text:\n            return\n'
            "        self.publisher.publish(String(data=f'Ada: {text}'))\n",
        ),
    ),
]
