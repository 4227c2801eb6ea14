"""Answers to `two_stages`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'space missing',
        'A space is missing at the end of the text.',
        ("'My name is '", "'My name is'"),
    ),
    wrong('no name', 'nothing is added', ("msg.data + 'Ada'", 'msg.data')),
    wrong(
        'string built once',
        'the string is made beforehand',
        ("msg.data + 'Ada'", "'My name is Ada'"),
    ),
    wrong(
        'string grows',
        'The texts of earlier messages are still in it',
        (
            "super().__init__('completer')\n",
            "super().__init__('completer')\n        self.text = ''\n",
        ),
        (
            "self.publisher.publish(String(data=msg.data + 'Ada'))",
            'self.text += msg.data\n'
            "        self.publisher.publish(String(data=self.text + 'Ada'))",
        ),
    ),
    wrong(
        'name in front',
        'The name stands before the text.',
        ("msg.data + 'Ada'", "'Ada' + msg.data"),
    ),
    wrong(
        'publishes where it listens',
        'The node hears what it says itself',
        ("String, 'complete', 10", "String, 'incomplete', 10"),
    ),
    wrong(
        'blocks in the callback',
        'While a callback runs, no other one can',
        ('def on_text(self, msg):\n', 'def on_text(self, msg):\n        sleep(3)\n'),
        ('from rclpy', 'from time import sleep\n\nfrom rclpy'),
    ),
    wrong(
        'stage two takes a second',
        'A timer of /opener has the period that is asked for.',
        ('def on_text(self, msg):\n', 'def on_text(self, msg):\n        sleep(0.9)\n'),
        ('from rclpy', 'from time import sleep\n\nfrom rclpy'),
    ),
    wrong(
        'publisher made in the callback',
        'makes a publisher again and again',
        ("        self.publisher = self.create_publisher(String, 'complete', 10)\n", ''),
        (
            "self.publisher.publish(String(data=msg.data + 'Ada'",
            "self.create_publisher(String, 'complete', 10).publish(String(data=msg.data + 'Ada'",
        ),
    ),
    wrong('one node for both', 'One node does the work of both stages'),
    wrong(
        'two nodes of one name',
        'A node of Completer was made, and has ended.',
        ("__init__('completer')", "__init__('opener')"),
    ),
    wrong(
        'second stage missing',
        'create_subscription() for this topic has not been called',
        ('completer = lab.spin(Completer())\n', ''),
    ),
    wrong('callback called', 'Pass the name alone', outcome=ERROR),
    wrong('off by ten', 'times too fast', ('create_timer(0.5,', 'create_timer(0.05,')),
    wrong(
        'three times in two seconds',
        '1.2 times too slow',
        ('create_timer(0.5,', 'create_timer(0.6,'),
    ),
    wrong(
        'stage one ends after ten',
        'They stop coming.',
        ("super().__init__('opener')\n", "super().__init__('opener')\n        self.n = 0\n"),
        (
            "        self.publisher.publish(String(data='My name is '))\n",
            '        self.n += 1\n        if self.n <= 10:\n'
            "            self.publisher.publish(String(data='My name is '))\n",
        ),
    ),
    wrong(
        'stage one says something else later',
        'that were right',
        ("super().__init__('opener')\n", "super().__init__('opener')\n        self.n = 0\n"),
        (
            "        self.publisher.publish(String(data='My name is '))\n",
            '        self.n += 1\n'
            "        text = 'My name is ' if self.n < 30 else 'Hello, '\n"
            '        self.publisher.publish(String(data=text))\n',
        ),
    ),
    wrong(
        'stage two answers twice',
        'A message is answered more than once.',
        (
            "        self.publisher.publish(String(data=msg.data + 'Ada'))\n",
            "        msg.data = msg.data + 'Ada'\n        self.publisher.publish(msg)\n"
            '        self.publisher.publish(msg)\n',
        ),
    ),
    wrong(
        'stage two passes on, and answers',
        'The input is published too',
        (
            "        self.publisher.publish(String(data=msg.data + 'Ada'))\n",
            "        self.publisher.publish(String(data=msg.data + 'Ada'))\n"
            '        self.publisher.publish(msg)\n',
        ),
    ),
    wrong(
        'stage two has a timer',
        'Publish on /complete only in the callback for /incomplete, and once.',
        (
            "super().__init__('completer')\n",
            "super().__init__('completer')\n        self.text = 'My name is '\n"
            '        self.timer = self.create_timer(0.5, self.on_timer)\n',
        ),
        (
            "        self.publisher.publish(String(data=msg.data + 'Ada'))\n",
            '        self.text = msg.data\n\n    def on_timer(self):\n'
            "        self.publisher.publish(String(data=self.text + 'Ada'))\n",
        ),
    ),
    wrong(
        'stage two knows one text only',
        'nothing on /complete',
        (
            "        self.publisher.publish(String(data=msg.data + 'Ada'))\n",
            "        if msg.data == 'My name is ':\n"
            "            self.publisher.publish(String(data=msg.data + 'Ada'))\n",
        ),
    ),
    wrong(
        'a name that changes',
        'The name is another one than with the first text.',
        (
            "super().__init__('completer')\n",
            "super().__init__('completer')\n        self.names = ['Ada', 'Bob']\n",
        ),
        (
            "        self.publisher.publish(String(data=msg.data + 'Ada'))\n",
            '        self.names.reverse()\n'
            '        self.publisher.publish(String(data=msg.data + self.names[0]))\n',
        ),
    ),
    right('functions'),
    right(
        'stage one is a loop with a rate, in a thread',
        ('        self.timer = self.create_timer(0.5, self.on_timer)\n', ''),
        (
            'opener = lab.spin(Opener())',
            '\nimport threading\n\nopener = lab.spin(Opener())\n\n\ndef work():\n'
            '    rate = opener.create_rate(2)\n    for _ in range(120):\n'
            '        opener.on_timer()\n        rate.sleep()\n\n\n'
            'threading.Thread(target=work, daemon=True).start()\n',
        ),
    ),
    right(
        'stage one sleeps in a thread',
        ('        self.timer = self.create_timer(0.5, self.on_timer)\n', ''),
        (
            'opener = lab.spin(Opener())',
            '\nimport threading\nimport time\n\nopener = lab.spin(Opener())\n\n\n'
            'def work(opener):\n    for _ in range(240):\n        opener.on_timer()\n'
            '        time.sleep(0.5)\n\n\n'
            'threading.Thread(target=work, args=[opener], daemon=True).start()\n',
        ),
    ),
    right(
        'names that the lesson has used, and a fast timer',
        ("super().__init__('opener')\n", "super().__init__('thermometer')\n        self.n = 0\n"),
        ("'completer'", "'observer'"),
        ('create_timer(0.5,', 'create_timer(0.1,'),
        (
            "        self.publisher.publish(String(data='My name is '))\n",
            '        self.n += 1\n        if self.n % 5 == 0:\n'
            "            self.publisher.publish(String(data='My name is '))\n",
        ),
    ),
    right(
        'both in a process of its own',
        (
            'from rclpy.node',
            'import rclpy\nfrom rclpy.executors import SingleThreadedExecutor\nfrom rclpy.node',
        ),
        (
            'completer = lab.spin(Completer())\nopener = lab.spin(Opener())',
            'rclpy.init()\nexecutor = SingleThreadedExecutor()\n'
            'for stage in (Completer(), Opener()):\n    executor.add_node(stage)\n'
            'executor.spin()\n',
        ),
        run='process',
    ),
]
