"""Answers to `polite`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'greets nobody whose name holds Ada',
        'says Hello and was not greeted yet',
        ('who not in self.greeted', "'Ada' not in who"),
    ),
    wrong(
        'says the name as often as Hello is said',
        'The text goes on after that',
        (
            '            self.publisher.publish(',
            "            who = who * text.count('Hello')\n            self.publisher.publish(",
        ),
    ),
    wrong(
        'greets itself, without an end',
        'without an end',
        ("if 'Hello' in text and who not in self.greeted:", "if 'Hello' in text:"),
        ('            self.greeted.add(who)\n', ''),
    ),
    wrong('greets itself once', 'What it has said itself reaches it, too', ("{'Ada'}", 'set()')),
    wrong(
        'remembers who said nothing yet',
        'says Hello and was not greeted yet',
        (
            "        if 'Hello' in text and who not in self.greeted:\n"
            '            self.greeted.add(who)\n',
            '        new = who not in self.greeted\n        self.greeted.add(who)\n'
            "        if 'Hello' in text and new:\n",
        ),
    ),
    wrong(
        'one for all',
        'says Hello and was not greeted yet',
        (
            "if 'Hello' in text and who not in self.greeted:",
            "if 'Hello' in text and len(self.greeted) == 1:",
        ),
    ),
    wrong('without the name', 'Ada: Hello, ', ("f'Ada: Hello, {who}'", "'Ada: Hello'")),
    wrong(
        'ten people and no more',
        'says Hello and was not greeted yet',
        (
            "if 'Hello' in text and who not in self.greeted:",
            "if 'Hello' in text and who not in self.greeted and len(self.greeted) < 5:",
        ),
    ),
    wrong(
        'greets twice',
        'A message is answered more than once.',
        (
            "            self.publisher.publish(String(data=f'Ada: Hello, {who}'))\n",
            '            for _ in range(2):\n'
            "                self.publisher.publish(String(data=f'Ada: Hello, {who}'))\n",
        ),
    ),
    wrong(
        'a list that is not there',
        "no attribute 'known'",
        ('self.greeted.add', 'self.known.add'),
        outcome=ERROR,
    ),
    wrong('capital letter', 'was not greeted yet'),
    wrong(
        'forgets after ten people',
        'The same person was greeted before.',
        (
            '            self.greeted.add(who)\n',
            '            self.greeted.add(who)\n            if len(self.greeted) > 10:\n'
            "                self.greeted = {'Ada'}\n",
        ),
    ),
    wrong(
        'capital and small letters alike',
        'says Hello and was not greeted yet',
        ('            self.greeted.add(who)\n', '            self.greeted.add(who.lower())\n'),
        ("{'Ada'}", "{'ada'}"),
        ('who not in', 'who.lower() not in'),
    ),
    wrong(
        'Hello anywhere',
        'This message does not say Hello.',
        ("who, _, text = msg.data.partition(': ')", "who = msg.data.partition(': ')[0]"),
        ("'Hello' in text", "'Hello' in msg.data"),
    ),
    wrong(
        'the name up to the last colon',
        "The text goes on after that, with ': at 7'.",
        ('.partition(', '.rpartition('),
    ),
    right('functions and a list'),
    right(
        'a dictionary that counts',
        ("{'Ada'}", "{'Ada': 1}"),
        ('            self.greeted.add(who)\n', '            self.greeted[who] = 1\n'),
    ),
    right(
        'a list and a timer',
        (
            'self.on_message, 10)\n',
            'self.note, 10)\n        self.waiting = []\n'
            '        self.create_timer(0.1, self.on_timer)\n\n    def note(self, msg):\n'
            '        self.waiting.append(msg)\n\n    def on_timer(self):\n'
            '        while self.waiting:\n'
            '            self.on_message(self.waiting.pop(0))\n',
        ),
    ),
    right(
        'a queue and a thread',
        ('from rclpy', '\nimport queue\nimport threading\n\nfrom rclpy'),
        (
            'self.on_message, 10)\n',
            'self.heard.put, 10)\n'
            '        threading.Thread(target=self.work, daemon=True).start()\n\n'
            '    def work(self):\n        while True:\n'
            '            msg = self.heard.get()\n'
            '            sum(range(1_000_000))  # it takes its time\n'
            '            self.on_message(msg)\n',
        ),
        (
            "        self.greeted = {'Ada'}\n",
            "        self.greeted = {'Ada'}\n        self.heard = queue.Queue()\n",
        ),
    ),
    right(
        'greets before it remembers',
        (
            '            self.greeted.add(who)\n'
            "            self.publisher.publish(String(data=f'Ada: Hello, {who}'))\n",
            "            self.publisher.publish(String(data=f'Ada: Hello, {who}'))\n"
            '            self.greeted.add(who)\n',
        ),
    ),
    right('a word of its own', ("'Hello' in text", "'Hello' in text.split()")),
    right(
        'a pattern',
        ('from rclpy', 'import re\n\nfrom rclpy'),
        ("'Hello' in text", "re.search(r'\\bHello\\b', text)"),
    ),
]
