"""Answers to `hearer`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'as it came',
        'That is the message as it came.',
        ("f'{who} says {text}'", 'msg.data'),
        ("        if not colon:\n            who, text = 'somebody', msg.data\n", ''),
        refused='The parts are made, and not used.',
    ),
    wrong(
        'nobody for somebody',
        'nobody says who he is',
        ("        if not colon:\n            who, text = 'somebody', msg.data\n", ''),
        refused='The part colon is made, and not used.',
    ),
    wrong(
        'divides at each colon',
        'The text ends at its own colon.',
        (
            "who, colon, text = msg.data.partition(': ')",
            "who, *rest = msg.data.split(': ')\n        colon, text = rest, rest and rest[0]",
        ),
    ),
    wrong(
        'divides at a colon without a blank',
        'nobody says who he is',
        (
            "who, colon, text = msg.data.partition(': ')",
            "who, colon, text = msg.data.partition(':')\n        text = text[1:]",
        ),
    ),
    wrong(
        'prints and does not log',
        'The callback does not log it.',
        ('self.get_logger().info(', 'print('),
    ),
    wrong(
        'two seconds later',
        's later. A timer logs it',
        (
            "        self.get_logger().info(f'{who} says {text}')\n",
            '        self.lines.append((self.get_clock().now().nanoseconds, who, text))\n\n'
            '    def on_timer(self):\n'
            '        now = self.get_clock().now().nanoseconds\n'
            '        while self.lines and now - self.lines[0][0] >= 2e9:\n'
            '            _, who, text = self.lines.pop(0)\n'
            "            self.get_logger().info(f'{who} says {text}')\n",
        ),
        (
            "super().__init__('hearer')\n",
            "super().__init__('hearer')\n        self.lines = []\n"
            '        self.create_timer(0.1, self.on_timer)\n',
        ),
    ),
    wrong('another topic', 'subscribes to /hal'),
    wrong(
        'logs twice',
        'logged more than once',
        (
            "        self.get_logger().info(f'{who} says {text}')\n",
            "        self.get_logger().info(f'{who} says {text}')\n"
            "        self.get_logger().info(f'{who} says {text}')\n",
        ),
    ),
    wrong(
        'leaves out who has no name',
        'Some messages are logged as they came, and this one is not.',
        ("            who, text = 'somebody', msg.data\n", '            return\n'),
    ),
    wrong(
        'a misspelt field',
        "no attribute 'text'",
        ('msg.data.partition', 'msg.text.partition'),
        outcome=ERROR,
    ),
    wrong('wrong type', 'Use the same type on both sides', outcome=ERROR),
    wrong(
        'a second line for each message',
        'beside the one that is asked for',
        (
            "        self.get_logger().info(f'{who} says {text}')\n",
            "        self.get_logger().info(f'{who} says {text}')\n"
            "        self.get_logger().info('That is all.')\n",
        ),
    ),
    wrong(
        'the first word of a name',
        'The name is cut:',
        ('{who} says', '{who.split()[0]} says'),
    ),
    right('functions and split'),
    right(
        'if and else',
        (
            "        who, colon, text = msg.data.partition(': ')\n        if not colon:\n"
            "            who, text = 'somebody', msg.data\n"
            "        self.get_logger().info(f'{who} says {text}')\n",
            "        if ': ' in msg.data:\n            place = msg.data.index(': ')\n"
            '            who, text = msg.data[:place], msg.data[place + 2 :]\n'
            "        else:\n            who, text = 'somebody', msg.data\n"
            "        self.get_logger().info(who + ' says ' + text)\n",
        ),
    ),
    right(
        'more in the line', ("f'{who} says {text}'", "f'In the hall {who} says {text}, I hear'")
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
]
