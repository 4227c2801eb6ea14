"""Answers to `two_names`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong('one node only', 'of /ada alone', ("bob = lab.spin(Introducer('bob', 'Bob'))\n", '')),
    wrong('same first name', "Both say 'Ada'", ("'bob', 'Bob'", "'bob', 'Ada'")),
    wrong(
        'second one not spun',
        '/bob is there, but it is not spun',
        ("lab.spin(Introducer('bob', 'Bob'))", "Introducer('bob', 'Bob')"),
    ),
    wrong(
        'string built once',
        'What goes out does not hold the text that came in',
        ('msg.data + self', "'My name is ' + self"),
    ),
    wrong(
        'space too many',
        'There is a space too many beside the name.',
        ('msg.data + self', "msg.data + ' ' + self"),
    ),
    wrong(
        'one node with two publishers',
        'One node has two publishers.',
        (
            "ada = lab.spin(Introducer('ada', 'Ada'))\nbob = lab.spin(Introducer('bob', 'Bob'))",
            "ada = lab.spin(Introducer('ada', 'Ada'))",
        ),
        (
            '    def on_text',
            "        self.other = self.create_publisher(String, 'names', 10)\n\n    def on_text",
        ),
        (
            'self.first_name))',
            "self.first_name))\n        self.other.publish(String(data=msg.data + 'Bob'))",
        ),
    ),
    wrong('capital letter', 'Capital and small letters differ in names'),
    wrong('publishes twice', 'A message is answered more than once.'),
    wrong(
        'passes on, and answers',
        'The input is published too',
        (
            '        self.publisher.publish(String(data=msg.data + self.first_name))\n',
            '        self.publisher.publish(String(data=msg.data + self.first_name))\n'
            '        self.publisher.publish(msg)\n',
        ),
    ),
    wrong(
        'a name that changes',
        'The name is another one than with the first text.',
        (
            '        self.publisher.publish(String(data=msg.data + self.first_name))\n',
            '        self.publisher.publish(String(data=msg.data + self.first_name))\n'
            '        self.first_name = self.first_name[::-1]\n',
        ),
    ),
    wrong(
        'only the first time',
        'nothing on /names',
        (
            '        self.publisher.publish(String(data=msg.data + self.first_name))\n',
            '        if self.first_name:\n'
            '            self.publisher.publish(String(data=msg.data + '
            "self.first_name))\n        self.first_name = ''\n",
        ),
    ),
    wrong(
        'one of them knows one text only',
        'messages were answered correctly, the others were not',
        (
            '        self.publisher.publish(String(data=msg.data + self.first_name))\n',
            "        if self.first_name == 'Ada' or msg.data == 'My name is ':\n"
            '            self.publisher.publish(String(data=msg.data + '
            'self.first_name))\n',
        ),
    ),
    wrong(
        'repeats its answer',
        'a timer or a loop publishes it',
        (
            '        self.first_name = first_name\n',
            '        self.first_name = first_name\n        self.heard = None\n'
            '        self.timer = self.create_timer(0.2, self.on_timer)\n',
        ),
        (
            '        self.publisher.publish(String(data=msg.data + self.first_name))\n',
            '        self.heard = msg\n\n    def on_timer(self):\n'
            '        if self.heard:\n'
            '            self.publisher.publish(String(data=self.heard.data + '
            'self.first_name))\n',
        ),
    ),
    wrong(
        'one of them listens elsewhere',
        '/bob with a subscription to /incomplete',
        ("String, 'incomplete', self", 'String, self.inner, self'),
        (
            '        self.first_name = first_name\n',
            '        self.first_name = first_name\n'
            "        self.inner = 'incomplete' if first_name == 'Ada' else 'complete'\n",
        ),
    ),
    wrong('wrong type', 'Use the same type on both sides', outcome=ERROR),
    wrong(
        'one speaks for both',
        'Only 1 of 2 nodes answered',
        (
            '        self.publisher.publish(String(data=msg.data + self.first_name))\n',
            "        for name in ('Ada', 'Bob') if self.first_name == 'Ada' else ():\n"
            '            self.publisher.publish(String(data=msg.data + name))\n',
        ),
    ),
    wrong(
        'they take turns with their names',
        'The name is another one than with the first text.',
        (
            '        self.publisher.publish(String(data=msg.data + self.first_name))\n',
            '        self.publisher.publish(String(data=msg.data + self.first_name))\n'
            "        self.first_name = 'Bob' if self.first_name == 'Ada' else 'Ada'\n",
        ),
    ),
    right('functions'),
    right(
        'a class each',
        (
            "ada = lab.spin(Introducer('ada', 'Ada'))\nbob = lab.spin(Introducer('bob', 'Bob'))",
            'class Ada(Introducer):\n    def __init__(self):\n'
            "        super().__init__('lady', 'Ada')\n\n\nclass Bob(Introducer):\n"
            "    def __init__(self):\n        super().__init__('builder', 'Bob')\n\n\n"
            'lab.spin(Ada())\nlab.spin(Bob())\n',
        ),
    ),
    right('one more, and a list and a timer'),
    right(
        'names that the lesson has used',
        ("'ada', 'Ada'", "'observer', 'Ada'"),
        ("'bob', 'Bob'", "'display', 'Bob'"),
    ),
    right(
        'executors of their own, in threads',
        (
            'from rclpy.node',
            'import threading\n\nfrom rclpy.executors import SingleThreadedExecutor\n'
            'from rclpy.node',
        ),
        (
            "ada = lab.spin(Introducer('ada', 'Ada'))\nbob = lab.spin(Introducer('bob', 'Bob'))",
            "for name in ('Ada', 'Bob'):\n    executor = SingleThreadedExecutor()\n"
            '    executor.add_node(Introducer(name.lower(), name))\n'
            '    threading.Thread(target=executor.spin, daemon=True).start()\n',
        ),
    ),
    right(
        'own process',
        (
            'from rclpy.node',
            'import rclpy\nfrom rclpy.executors import MultiThreadedExecutor\nfrom rclpy.node',
        ),
        (
            "ada = lab.spin(Introducer('ada', 'Ada'))\nbob = lab.spin(Introducer('bob', 'Bob'))",
            'rclpy.init()\nexecutor = MultiThreadedExecutor()\n'
            "for node in (Introducer('ada', 'Ada'), Introducer('bob', 'Bob')):\n"
            '    executor.add_node(node)\nexecutor.spin()\n',
        ),
        run='process',
    ),
]
