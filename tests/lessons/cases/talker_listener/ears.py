"""Answers to `ears`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'both ears have one name',
        'There is no node called /right_ear.',
        ("'right_ear', 'a bell'", "'left_ear', 'a bell'"),
    ),
    wrong(
        'only one ear',
        'There is no node called /right_ear.',
        ("right_ear = lab.spin(Ear('right_ear', 'a bell'))\n", ''),
    ),
    wrong(
        'the other ear only',
        'There is no node called /left_ear.',
        ("left_ear = lab.spin(Ear('left_ear', 'a dog'))\n", ''),
    ),
    wrong(
        'a name is misspelt',
        '/left_ears is not /left_ear',
        ("'left_ear', 'a dog'", "'left_ears', 'a dog'"),
    ),
    wrong(
        'one is silent',
        'The timer calls its callback, but publish() is not called there',
        (
            '        self.publisher.publish(String(data=self.noise))\n',
            "        if self.get_name() == 'left_ear':\n"
            '            self.publisher.publish(String(data=self.noise))\n',
        ),
    ),
    wrong(
        'the left one is silent',
        'The timer calls its callback, but publish() is not called there',
        (
            '        self.publisher.publish(String(data=self.noise))\n',
            "        if self.get_name() == 'right_ear':\n"
            '            self.publisher.publish(String(data=self.noise))\n',
        ),
    ),
    wrong(
        'one is not spun',
        'nothing runs its callbacks',
        (
            "right_ear = lab.spin(Ear('right_ear', 'a bell'))\n",
            "right_ear = Ear('right_ear', 'a bell')\n",
        ),
    ),
    wrong(
        'one is slower',
        'a message every 0.25 s (4 Hz): 1.25 times too slow',
        ('create_timer(0.2', "create_timer(0.2 if name == 'left_ear' else 0.25"),
    ),
    wrong('a little too fast', '1.05 times too fast', ('create_timer(0.2', 'create_timer(0.19')),
    wrong(
        'one of two is silent, in a thread',
        'no message in 30 s',
        ('for ear in ears:', 'for ear in ears[:1]:'),
        of='two classes and a thread',
    ),
    wrong(
        'a third ear',
        '/third_ear publishes there, too',
        (
            "right_ear = lab.spin(Ear('right_ear', 'a bell'))\n",
            "right_ear = lab.spin(Ear('right_ear', 'a bell'))\n"
            "third_ear = lab.spin(Ear('third_ear', 'a cat'))\n",
        ),
    ),
    wrong(
        'two publishers in one ear',
        'said by two publishers',
        (
            '        self.timer',
            "        self.second = self.create_publisher(String, 'sound', 10)\n        self.timer",
        ),
        (
            '        self.publisher.publish(String(data=self.noise))\n',
            '        self.publisher.publish(String(data=self.noise))\n'
            '        self.second.publish(String(data=self.noise))\n',
        ),
    ),
    wrong('publishes twice', 'is publish() called twice'),
    wrong(
        'one stops after ten',
        'They stop coming.',
        ('        self.noise = noise\n', '        self.noise = noise\n        self.calls = 0\n'),
        (
            '        self.publisher.publish(String(data=self.noise))\n',
            '        self.calls += 1\n'
            "        if self.calls <= 10 or self.get_name() == 'left_ear':\n"
            '            self.publisher.publish(String(data=self.noise))\n',
        ),
    ),
    wrong(
        'stops after a minute',
        'They stop coming.',
        ('        self.noise = noise\n', '        self.noise = noise\n        self.calls = 0\n'),
        (
            '        self.publisher.publish(String(data=self.noise))\n',
            '        self.calls += 1\n        if self.calls <= 75:\n'
            '            self.publisher.publish(String(data=self.noise))\n',
        ),
    ),
    wrong(
        'nothing in the message',
        'its field data is an empty text at first',
        ('String(data=self.noise)', 'String()'),
    ),
    wrong(
        'nothing to say later on',
        'its field data is an empty text at first',
        (
            'publish(String(data=self.noise))',
            'publish(String(data=self.noise))\n        self.noise = self.noise[1:]',
        ),
    ),
    wrong('only spaces', 'A text of spaces says nothing.', ("'a bell'", "'  '")),
    wrong(
        'five seconds for five times a second',
        'A rate in Hz and a period in seconds were mixed up',
        ('create_timer(0.2', 'create_timer(5'),
    ),
    wrong('another topic', 'names must be equal to the last letter'),
    wrong(
        'wrong type',
        'A topic carries one type of message.',
        ('from std_msgs.msg import String', 'from std_msgs.msg import Int16'),
        ('(String, ', '(Int16, '),
        ('String(data=self.noise)', 'Int16(data=7)'),
    ),
    wrong(
        'not set up',
        'super().__init__(...) has not been called',
        ('        super().__init__(name)\n', ''),
        outcome=ERROR,
    ),
    wrong(
        'a class, and no node of it',
        'Nothing runs before a node is made of it.',
        (
            "\n\nleft_ear = lab.spin(Ear('left_ear', 'a dog'))\n"
            "right_ear = lab.spin(Ear('right_ear', 'a bell'))\n",
            '',
        ),
    ),
    wrong(
        'one speaks for both',
        'Twice as many messages come as were asked for',
        (
            '        self.publisher.publish(String(data=self.noise))\n',
            "        for noise in ('a dog', 'a bell') if self.noise == 'a dog' else ():\n"
            '            self.publisher.publish(String(data=noise))\n',
        ),
    ),
    wrong(
        'they take turns',
        'They come in bursts, or with pauses.',
        (
            '        self.noise = noise\n',
            "        self.noise, self.calls = noise, int(noise == 'a dog')\n",
        ),
        (
            '        self.publisher.publish(String(data=self.noise))\n',
            '        self.calls += 1\n        for _ in range(2 * (self.calls % 2)):\n'
            '            self.publisher.publish(String(data=self.noise))\n',
        ),
    ),
    right('functions'),
    right(
        'partial',
        ('from rclpy', 'from functools import partial\n\nfrom rclpy'),
        (
            'self.create_timer(0.2, self.listen)\n\n    def listen(self):\n'
            '        self.publisher.publish(String(data=self.noise))\n',
            'self.create_timer(0.2, partial(self.publisher.publish, String(data=noise)))\n',
        ),
        ('        self.noise = noise\n', ''),
    ),
    right('two classes and a thread'),
    right(
        'one by a timer, one by a thread',
        (
            "        super().__init__('left_ear')\n",
            "        super().__init__('left_ear')\n        self.create_timer(0.2, self.listen)\n",
        ),
        (
            '\n\nclass RightEar',
            "\n    def listen(self):\n        self.pub.publish(String(data='a dog'))\n\n"
            '\nclass RightEar',
        ),
        ('for ear in ears:', 'for ear in ears[1:]:'),
        of='two classes and a thread',
    ),
    right(
        'a fast timer, each fourth call',
        ('        self.noise = noise\n', '        self.noise = noise\n        self.calls = 0\n'),
        ('create_timer(0.2', 'create_timer(0.05'),
        (
            '        self.publisher.publish(String(data=self.noise))\n',
            '        self.calls += 1\n        if self.calls % 4 == 0:\n'
            '            self.publisher.publish(String(data=self.noise))\n',
        ),
    ),
    right('both in a process of their own', run='process'),
    right(
        'both in a process, by subprocess', of='both in a process of their own', run='subprocess'
    ),
    right('one here, one in a process, by asyncio'),
]
