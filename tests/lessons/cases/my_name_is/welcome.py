"""Answers to `welcome`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

APPENDS = '        self.publisher.publish(String(data=msg.data + self.first_name))\n'
GREETS = "        self.publisher.publish(String(data=msg.data + '. Welcome!'))\n"
BOB = "bob = lab.spin(Guest('bob', 'Bob'))\n"

ANSWERS = [
    wrong('one guest only', 'Were two nodes of the same name started?', (BOB, '')),
    wrong(
        'three guests',
        'Each text would come 3 times',
        (BOB, f"{BOB}zoe = lab.spin(Guest('zoe', 'Zoe'))\n"),
    ),
    wrong(
        'a second host',
        'it does it for both names',
        (
            'host = lab.spin(Host())',
            "lab.spin(Node('door')).create_publisher(String, 'welcome', 1)",
        ),
        ('ada = ', 'host = lab.spin(Host())\nada = '),
    ),
    wrong('same first name', "Both say 'Ada'", ("'bob', 'Bob'", "'bob', 'Ada'")),
    wrong(
        'second one not spun',
        '/bob is there, but it is not spun',
        ("lab.spin(Guest('bob', 'Bob'))", "Guest('bob', 'Bob')"),
    ),
    wrong(
        'one guest hears the other one',
        'this one may have nothing to say',
        (
            '\n\nhost = ',
            '\n\nclass Follower(Guest):\n    def __init__(self):\n'
            "        super().__init__('bob', 'Bob')\n        self.heard = []\n"
            "        self.create_subscription(String, 'names', self.on_name, 10)\n\n"
            '    def on_text(self, msg):\n        self.heard.append(msg.data)\n\n'
            '    def on_name(self, msg):\n        while self.heard:\n'
            "            self.publisher.publish(String(data=self.heard.pop(0) + 'Bob'))\n\n\n"
            'host = ',
        ),
        (BOB, 'bob = lab.spin(Follower())\n'),
    ),
    wrong(
        'the host waits for both',
        'it waits for the other one',
        (
            "        super().__init__('host')\n",
            "        super().__init__('host')\n        self.waiting = {}\n",
        ),
        (
            GREETS,
            '        other = self.waiting.pop(msg.data[:-3], None)\n'
            '        if other is None:\n'
            '            self.waiting[msg.data[:-3]] = msg\n'
            '            return\n'
            '        for text in (other.data, msg.data):\n'
            "            self.publisher.publish(String(data=text + '. Welcome!'))\n",
        ),
    ),
    wrong(
        'the host welcomes one of them',
        'were answered correctly, the others were not',
        (GREETS, f"        if msg.data.endswith('Ada'):\n    {GREETS}"),
    ),
    wrong(
        'string built once',
        'What goes out does not hold the text that came in',
        ('msg.data + self', "'My name is ' + self"),
    ),
    wrong(
        'nothing for a namesake',
        'were answered correctly, the others were not',
        (APPENDS, f"        if not msg.data.startswith('Ada'):\n    {APPENDS}"),
    ),
    wrong(
        'the first 1000 letters',
        'What goes out does not hold the text that came in',
        ('msg.data + self', 'msg.data[:1000] + self'),
    ),
    wrong(
        'thirty texts and no more',
        'were answered correctly, the others were not',
        (
            APPENDS,
            "        self.count = getattr(self, 'count', 0) + 1\n"
            f'        if self.count <= 30:\n    {APPENDS}',
        ),
    ),
    wrong(
        'at most ten a second',
        'were answered correctly, the others were not',
        (
            APPENDS,
            '        now = self.get_clock().now().nanoseconds\n'
            "        if now - getattr(self, 'before', 0) < 1e8:\n            return\n"
            f'        self.before = now\n{APPENDS}',
        ),
    ),
    wrong(
        'space too many',
        'There is a space too many beside the name.',
        ('msg.data + self', "msg.data + ' ' + self"),
    ),
    wrong(
        'a name that changes',
        'The name is another one than with the first text.',
        (APPENDS, f'{APPENDS}        self.first_name = self.first_name[::-1]\n'),
    ),
    wrong(
        'a guest speaks before it has heard',
        'It publishes although nothing has come.',
        (
            "        self.publisher = self.create_publisher(String, 'names', 10)\n",
            "        self.publisher = self.create_publisher(String, 'names', 10)\n"
            "        self.publisher.publish(String(data='My name is ' + first_name))\n",
        ),
    ),
    wrong(
        'the host speaks before it has heard',
        'It publishes although nothing has come.',
        (
            "super().__init__('host')\n",
            "super().__init__('host')\n        self.create_timer(0.05, self.on_timer)\n",
        ),
        (
            '\n\nclass Guest',
            '\n    def on_timer(self):\n'
            "        if not hasattr(self, 'begun'):\n"
            '            self.begun = True\n'
            "            self.publisher.publish(String(data='Hello'))\n\n\nclass Guest",
        ),
    ),
    wrong(
        'Bob hears Ada',
        'Only /ada hears /incomplete.',
        (
            '(self, node_name, first_name)',
            "(self, node_name, first_name, hears='incomplete', says='names')",
        ),
        ("String, 'incomplete', self", 'String, hears, self'),
        (
            "self.publisher = self.create_publisher(String, 'names', 10)",
            'self.publisher = self.create_publisher(String, says, 10)',
        ),
        ("'bob', 'Bob'", "'bob', 'Bob', 'names', 'more'"),
        (
            "super().__init__('host')\n",
            "super().__init__('host')\n"
            "        self.create_subscription(String, 'more', self.on_text, 10)\n",
        ),
    ),
    wrong(
        'the host is not started',
        'nobody publishes on /welcome',
        ('host = lab.spin(Host())\n', ''),
    ),
    wrong('capital letter', 'Capital and small letters differ in names'),
    wrong('publishes twice', 'A message is answered more than once.'),
    wrong('another welcome', 'Capital and small letters differ', ("'. Welcome!'", "'. welcome!'")),
    wrong('wrong type', 'Use the same type on both sides', outcome=ERROR),
    wrong(
        'in a process of their own',
        'the check sees in this notebook alone',
        ('from rclpy.node', 'import rclpy\nfrom rclpy.node'),
        ('host = lab.spin(Host())', 'rclpy.init()\nexecutor = SingleThreadedExecutor()'),
        ('import rclpy\n', 'import rclpy\nfrom rclpy.executors import SingleThreadedExecutor\n'),
        (
            f"ada = lab.spin(Guest('ada', 'Ada'))\n{BOB}",
            "for node in (Host(), Guest('ada', 'Ada'), Guest('bob', 'Bob')):\n"
            '    executor.add_node(node)\nexecutor.spin()\n',
        ),
        run='process',
    ),
    right('functions, and a topic for each guest'),
    right(
        'a class each, and other names',
        ("'names'", "'half'"),
        (
            '\n\nhost = ',
            '\n\nclass Ada(Guest):\n    def __init__(self):\n'
            "        super().__init__('observer', 'Ada')\n\n\nclass Bob(Guest):\n"
            "    def __init__(self):\n        super().__init__('display', 'Bob')\n\n\nhost = ",
        ),
        ("Guest('ada', 'Ada')", 'Ada()'),
        ("Guest('bob', 'Bob')", 'Bob()'),
    ),
    right(
        'a list and a timer',
        (
            APPENDS,
            '        self.waiting.append(msg.data)\n\n    def on_timer(self):\n'
            '        while self.waiting:\n            text = self.waiting.pop(0)\n'
            '            self.publisher.publish(String(data=text + self.first_name))\n',
        ),
        (
            '        self.first_name = first_name\n',
            '        self.first_name = first_name\n        self.waiting = []\n'
            '        self.create_timer(0.3, self.on_timer)\n',
        ),
    ),
    right(
        'executors of their own, in threads',
        (
            'from rclpy.node',
            'import threading\n\nfrom rclpy.executors import SingleThreadedExecutor\n'
            'from rclpy.node',
        ),
        (
            f"host = lab.spin(Host())\nada = lab.spin(Guest('ada', 'Ada'))\n{BOB}",
            "for node in (Host(), Guest('ada', 'Ada'), Guest('bob', 'Bob')):\n"
            '    executor = SingleThreadedExecutor()\n'
            '    executor.add_node(node)\n'
            '    threading.Thread(target=executor.spin, daemon=True).start()\n',
        ),
    ),
    right(
        'joins the chain that is there',
        ("'names'", "'complete'"),
        ("ada = lab.spin(Guest('ada', 'Ada'))\n", ''),
    ),
]
