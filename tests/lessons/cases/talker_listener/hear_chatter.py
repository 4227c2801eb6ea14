"""Answers to `hear_chatter`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong('capital letter', 'Capital and small letters differ in names'),
    wrong(
        'in the namespace of the node',
        'it lies in another namespace',
        ("'chatter'", "'~/chatter'"),
    ),
    wrong(
        # Within one process ROS refuses it; between processes it is silent.
        'wrong type',
        'A topic carries one type of message.',
        ('String', 'Int16'),
        run='process',
    ),
    wrong('callback called', 'A callback is passed, not called', outcome=ERROR),
    wrong(
        'callback without a message',
        'This callback does not take one argument',
        ('(self, msg)', '(self)'),
        outcome=ERROR,
        refused='The name msg is not defined.',
    ),
    wrong('not spun', 'Nothing takes them out.'),
    wrong(
        'prints and does not log',
        'The callback does not log it.',
        ('self.get_logger().info(', 'print('),
    ),
    wrong(
        'logs something else',
        'its line does not hold what the message says',
        ('{msg.data}', 'msg.data'),
        refused='Nothing is put into the f-string.',
    ),
    wrong(
        'small letters',
        'its line does not hold what the message says',
        ('{msg.data}', '{msg.data.lower()}'),
    ),
    wrong(
        'only the first words',
        'its line does not hold what the message says',
        ('{msg.data}', '{msg.data[:20]}'),
    ),
    wrong(
        'only the first time',
        # The first one may be of the lesson's talker, before the check.
        '/diary logged nothing',
        (
            "        super().__init__('diary')\n",
            "        super().__init__('diary')\n        self.calls = 0\n",
        ),
        (
            '        self.get_logger().info(f\'I heard: "{msg.data}"\')\n',
            '        self.calls += 1\n        if self.calls == 1:\n'
            '            self.get_logger().info(f\'I heard: "{msg.data}"\')\n',
        ),
    ),
    wrong(
        'every other one',
        'Some messages are logged as they came, and this one is not.',
        (
            "        super().__init__('diary')\n",
            "        super().__init__('diary')\n        self.calls = 0\n",
        ),
        (
            '        self.get_logger().info(f\'I heard: "{msg.data}"\')\n',
            '        self.calls += 1\n        if self.calls % 2:\n'
            '            self.get_logger().info(f\'I heard: "{msg.data}"\')\n',
        ),
    ),
    wrong(
        'logs twice',
        'logged more than once',
        (
            '        self.get_logger().info(f\'I heard: "{msg.data}"\')\n',
            '        self.get_logger().info(f\'I heard: "{msg.data}"\')\n'
            '        self.get_logger().info(f\'I heard: "{msg.data}"\')\n',
        ),
    ),
    wrong(
        'repeats its last line from a timer',
        'one line of /diary for each message',
        (
            "        super().__init__('diary')\n",
            "        super().__init__('diary')\n        self.last = ''\n"
            '        self.create_timer(4.0, self.repeat)\n',
        ),
        (
            '        self.get_logger().info(f\'I heard: "{msg.data}"\')\n',
            '        self.get_logger().info(f\'I heard: "{msg.data}"\')\n'
            '        self.last = msg.data\n\n    def repeat(self):\n'
            '        self.get_logger().info(self.last)\n',
        ),
    ),
    wrong(
        'logs when nothing has come',
        'A timer or a loop logs, too.',
        (
            "        super().__init__('diary')\n",
            "        super().__init__('diary')\n        self.create_timer(12.3, self.tell)\n",
        ),
        (
            '        self.get_logger().info(f\'I heard: "{msg.data}"\')\n',
            '        self.get_logger().info(f\'I heard: "{msg.data}"\')\n\n'
            "    def tell(self):\n        self.get_logger().info('waiting')\n",
        ),
    ),
    wrong(
        'does not log the empty text',
        'Some messages are logged as they came, and this one is not.',
        (
            '        self.get_logger().info(f\'I heard: "{msg.data}"\')\n',
            '        if msg.data:\n'
            '            self.get_logger().info(f\'I heard: "{msg.data}"\')\n',
        ),
    ),
    wrong(
        'hears nothing of usual publishers',
        'QoS profiles do not match',
        ('self.on_message, 10)', 'self.on_message, latched)'),
        (
            '\n\nclass',
            '\n'
            'latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n'
            '\n\nclass',
        ),
        ('from std_msgs', 'from rclpy.qos import DurabilityPolicy, QoSProfile\nfrom std_msgs'),
    ),
    wrong(
        'blocks in the callback',
        'While a callback runs, no other one can',
        (
            '        self.get_logger().info(f\'I heard: "{msg.data}"\')\n',
            '        time.sleep(3)\n        self.get_logger().info(f\'I heard: "{msg.data}"\')\n',
        ),
        ('from rclpy', 'import time\n\nfrom rclpy'),
    ),
    wrong(
        'a class, and no node of it',
        'Nothing runs before a node is made of it.',
        ('\n\ndiary = lab.spin(Diary())\n', ''),
    ),
    wrong('a program that does not spin', 'Call rclpy.spin(node) in its program.', run='process'),
    wrong(
        'field misspelt', 'String has nothing called text', ('msg.data', 'msg.text'), outcome=ERROR
    ),
    wrong(
        'a second line for each message',
        'beside the one that is asked for',
        (
            '        self.get_logger().info(f\'I heard: "{msg.data}"\')\n',
            '        self.get_logger().info(f\'I heard: "{msg.data}"\')\n'
            "        self.get_logger().info('ready')\n",
        ),
    ),
    wrong(
        'not the same again',
        'Some messages are logged as they came, and this one is not.',
        ("super().__init__('diary')\n", "super().__init__('diary')\n        self.last = None\n"),
        (
            '        self.get_logger().info(',
            '        if msg.data == self.last:\n            return\n'
            '        self.last = msg.data\n        self.get_logger().info(',
        ),
    ),
    wrong(
        'one blank between two words',
        'its line does not hold what the message says',
        ('        self.get', "        text = ' '.join(msg.data.split())\n        self.get"),
        ('{msg.data}', '{text}'),
    ),
    wrong(
        'the newest, every 0.4 s',
        'Some messages are logged as they came, and this one is not.',
        (
            "super().__init__('diary')\n",
            "super().__init__('diary')\n        self.newest = None\n"
            '        self.create_timer(0.4, self.tell)\n',
        ),
        (
            '        self.get_logger().info(f\'I heard: "{msg.data}"\')\n',
            '        self.newest = msg\n\n    def tell(self):\n        if self.newest:\n'
            '            msg, self.newest = self.newest, None\n'
            '            self.get_logger().info(f\'I heard: "{msg.data}"\')\n',
        ),
    ),
    wrong(
        'a line half a second after its beginning',
        'A timer or a loop logs, too.',
        (
            'self.on_message, 10)\n',
            'self.on_message, 10)\n        self.timer = self.create_timer(0.5, self.on_timer)\n',
        ),
        (
            '    def on_message',
            '    def on_timer(self):\n        self.timer.cancel()\n'
            "        self.get_logger().info('I am ready')\n\n    def on_message",
        ),
    ),
    right('functions'),
    right(
        'a logger below that of the node',
        ('get_logger().info', "get_logger().get_child('ears').info"),
    ),
    right(
        'a list and a timer, by a node with the name of another one',
        (
            "        super().__init__('diary')\n",
            "        super().__init__('listener')\n        self.heard = []\n",
        ),
        (
            'self.on_message, 10)\n',
            'self.heard.append, 10)\n        self.create_timer(0.1, self.on_timer)\n',
        ),
        (
            'def on_message(self, msg):\n',
            'def on_timer(self):\n        while self.heard:\n'
            '            msg = self.heard.pop(0)\n    ',
        ),
    ),
    right('a queue and a thread'),
    right('in a namespace, with an executor of its own'),
]
