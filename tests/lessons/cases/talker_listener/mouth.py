"""Answers to `mouth`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'English letters only',
        'Not all letters have become capital ones.',
        (
            '        self.publisher.publish(String(data=msg.data.upper()))\n',
            "        text = ''.join(c.upper() if c.isascii() else c for c in msg.data)\n"
            '        self.publisher.publish(String(data=text))\n',
        ),
    ),
    wrong(
        'not the empty text',
        'were answered correctly, the others were not',
        (
            '        self.publisher.publish(String(data=msg.data.upper()))\n',
            '        if msg.data:\n'
            '            self.publisher.publish(String(data=msg.data.upper()))\n',
        ),
    ),
    wrong(
        'only the first time',
        'The text is passed on as it came.',
        (
            "        self.create_subscription(String, 'thought', self.on_thought, 10)\n",
            "        self.create_subscription(String, 'thought', self.on_thought, 10)\n"
            '        self.calls = 0\n',
        ),
        (
            '        self.publisher.publish(String(data=msg.data.upper()))\n',
            '        self.calls += 1\n        loud = msg.data.upper()\n'
            '        text = loud if self.calls == 1 else msg.data\n'
            '        self.publisher.publish(String(data=text))\n',
        ),
    ),
    wrong('publishes twice', 'A message is answered more than once.'),
    wrong(
        'echoes and answers',
        'The input is published too',
        (
            '        self.publisher.publish(String(data=msg.data.upper()))\n',
            '        self.publisher.publish(msg)\n'
            '        self.publisher.publish(String(data=msg.data.upper()))\n',
        ),
    ),
    wrong(
        'repeats its last answer from a timer',
        # Of two texts that come at once it says the second one, and that may show first.
        'on /speech',
        (
            "        self.create_subscription(String, 'thought', self.on_thought, 10)\n",
            "        self.create_subscription(String, 'thought', self.on_thought, 10)\n"
            "        self.last = ''\n        self.create_timer(1.0, self.speak)\n",
        ),
        (
            '        self.publisher.publish(String(data=msg.data.upper()))\n',
            '        self.last = msg.data.upper()\n\n    def speak(self):\n'
            '        self.publisher.publish(String(data=self.last))\n',
        ),
    ),
    wrong(
        'answers another topic, too',
        'What comes on /news is answered, too.',
        (
            "        self.create_subscription(String, 'thought', self.on_thought, 10)\n",
            "        self.create_subscription(String, 'thought', self.on_thought, 10)\n"
            "        self.create_subscription(String, 'news', self.on_thought, 10)\n",
        ),
    ),
    wrong(
        'ends after three',
        'were answered correctly, the others were not',
        (
            "        self.create_subscription(String, 'thought', self.on_thought, 10)\n",
            "        self.create_subscription(String, 'thought', self.on_thought, 10)\n"
            '        self.left = 3\n',
        ),
        (
            '        self.publisher.publish(String(data=msg.data.upper()))\n',
            '        self.left -= 1\n        if self.left >= 0:\n'
            '            self.publisher.publish(String(data=msg.data.upper()))\n',
        ),
    ),
    wrong(
        'speaks much later',
        'within a second',
        (
            "        self.create_subscription(String, 'thought', self.on_thought, 10)\n",
            '        self.waiting = []\n'
            "        self.create_subscription(String, 'thought', "
            'self.waiting.append, 10)\n        self.create_timer(7.0, self.speak)\n',
        ),
        (
            '    def on_thought(self, msg):\n'
            '        self.publisher.publish(String(data=msg.data.upper()))\n',
            '    def speak(self):\n        while self.waiting:\n'
            '            msg = self.waiting.pop(0)\n'
            '            self.publisher.publish(String(data=msg.data.upper()))\n',
        ),
    ),
    wrong('talks to itself', 'The node hears what it says itself', ("'speech'", "'thought'")),
    wrong(
        'never publishes',
        'its callback did not publish',
        (
            '        self.publisher.publish(String(data=msg.data.upper()))\n',
            '        print(msg.data)\n',
        ),
    ),
    wrong(
        'publishes the text alone',
        'publish() takes a message of the type',
        ('String(data=msg.data.upper())', 'msg.data.upper()'),
        outcome=ERROR,
    ),
    wrong('not spun', '/mouth is there, but it is not spun'),
    wrong('a program that does not spin', 'Call rclpy.spin(node) in its program.', run='process'),
    wrong(
        'hears nothing of usual publishers',
        'QoS profiles do not match',
        ('on_thought, 10)', 'on_thought, latched)'),
        (
            '\n\nclass',
            '\n'
            'latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n'
            '\n\nclass',
        ),
        ('from std_msgs', 'from rclpy.qos import DurabilityPolicy, QoSProfile\nfrom std_msgs'),
    ),
    wrong(
        'another node name',
        "The name is what Node() gets, or super().__init__() in a class: 'mouth'.",
    ),
    wrong(
        'not set up',
        'super().__init__(...) has not been called',
        ("        super().__init__('mouth')\n", ''),
        outcome=ERROR,
    ),
    wrong(
        'not the same again',
        'were answered correctly, the others were not',
        ("super().__init__('mouth')\n", "super().__init__('mouth')\n        self.last = ''\n"),
        (
            '        self.publisher.publish(',
            '        same, self.last = msg.data == self.last, msg.data\n        if same:\n'
            '            return\n        self.publisher.publish(',
        ),
    ),
    wrong(
        'at most three a second',
        'were answered correctly, the others were not',
        (
            "super().__init__('mouth')\n",
            "super().__init__('mouth')\n        self.last = self.get_clock().now()\n",
        ),
        (
            '        self.publisher.publish(',
            '        now = self.get_clock().now()\n'
            '        if (now - self.last).nanoseconds < 300_000_000:\n            return\n'
            '        self.last = now\n        self.publisher.publish(',
        ),
    ),
    wrong(
        'the newest, every 0.4 s',
        'were answered correctly, the others were not',
        (
            "super().__init__('mouth')\n",
            "super().__init__('mouth')\n        self.newest = None\n"
            '        self.create_timer(0.4, self.speak)\n',
        ),
        (
            '        self.publisher.publish(String(data=msg.data.upper()))\n',
            '        self.newest = msg\n\n    def speak(self):\n        if self.newest:\n'
            '            msg, self.newest = self.newest, None\n'
            '            self.publisher.publish(String(data=msg.data.upper()))\n',
        ),
    ),
    wrong(
        'one blank between two words',
        'The spaces ',
        ('msg.data.upper()', "' '.join(msg.data.upper().split())"),
    ),
    wrong(
        'speaks where it listens, too',
        'It publishes on /thought, too, where it only has to listen.',
        (
            "super().__init__('mouth')\n",
            "super().__init__('mouth')\n"
            "        self.thoughts = self.create_publisher(String, 'thought', 10)\n",
        ),
        (
            '        self.publisher.publish(',
            "        if msg.data.startswith('I said '):\n            return\n"
            "        self.thoughts.publish(String(data=f'I said {msg.data}'))\n"
            '        self.publisher.publish(',
        ),
    ),
    wrong(
        'a word at its beginning',
        'It publishes although nothing has come.',
        (
            "create_publisher(String, 'speech', 10)\n",
            "create_publisher(String, 'speech', 10)\n"
            "        self.publisher.publish(String(data='READY'))\n",
        ),
    ),
    right('functions'),
    right(
        'a list and a timer',
        (
            "        self.create_subscription(String, 'thought', self.on_thought, 10)\n",
            '        self.waiting = []\n'
            "        self.create_subscription(String, 'thought', "
            'self.waiting.append, 10)\n        self.create_timer(0.1, self.speak)\n',
        ),
        (
            '    def on_thought(self, msg):\n'
            '        self.publisher.publish(String(data=msg.data.upper()))\n',
            '    def speak(self):\n        while self.waiting:\n'
            '            msg = self.waiting.pop(0)\n'
            '            self.publisher.publish(String(data=msg.data.upper()))\n',
        ),
    ),
    right('a queue and a thread'),
    right(
        'an executor with several threads',
        (
            'from rclpy.node import Node\n',
            'import threading\n\nfrom rclpy.executors import MultiThreadedExecutor\n'
            'from rclpy.node import Node\n',
        ),
        (
            'mouth = lab.spin(Mouth())\n',
            'executor = MultiThreadedExecutor()\nexecutor.add_node(Mouth())\n'
            'threading.Thread(target=executor.spin, daemon=True).start()\n',
        ),
    ),
    right(
        'renamed from outside, and with another QoS profile',
        ("'mouth')", "'node', cli_args=OPTIONS)"),
        ("'thought'", "'a'"),
        ("'speech', 10", "'speech', latched"),
        (
            '\n\nclass',
            '\n'
            'latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n'
            "OPTIONS = ['--ros-args', '-r', '__node:=mouth', '-r', 'a:=thought']\n\n\n"
            'class',
        ),
        ('from std_msgs', 'from rclpy.qos import DurabilityPolicy, QoSProfile\nfrom std_msgs'),
    ),
]
