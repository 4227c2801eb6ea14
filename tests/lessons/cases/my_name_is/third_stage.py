"""Answers to `third_stage`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'one full stop',
        'were answered correctly, the others were not',
        ('msg.data + ', "msg.data.rstrip('.') + "),
    ),
    wrong(
        'publishes where it listens',
        'The node hears what it says itself',
        ("String, 'greeting', 10", "String, 'complete', 10"),
    ),
    wrong(
        'space missing',
        'The spaces are not where they should be.',
        ("msg.data + '. Nice to meet you.'", "msg.data + '.Nice to meet you.'"),
    ),
    wrong(
        'full stop missing',
        "The text ends too early: '.' is missing.",
        ("msg.data + '. Nice to meet you.'", "msg.data + '. Nice to meet you'"),
    ),
    wrong(
        'string built once',
        'the string is made beforehand',
        ("msg.data + '. Nice to meet you.'", "'My name is Ada. Nice to meet you.'"),
    ),
    wrong(
        'nothing added',
        'The text is passed on as it came',
        ("msg.data + '. Nice to meet you.'", 'msg.data'),
    ),
    wrong(
        'publishes a text',
        'publish() takes a message of the type',
        ("String(data=msg.data + '. Nice to meet you.')", "msg.data + '. Nice to meet you.'"),
        outcome=ERROR,
    ),
    wrong('another topic', 'names must be equal to the last letter'),
    wrong(
        'answers twice',
        'A message is answered more than once.',
        (
            "        self.publisher.publish(String(data=msg.data + '. Nice to meet you.'))\n",
            "        msg.data = msg.data + '. Nice to meet you.'\n"
            '        self.publisher.publish(msg)\n        self.publisher.publish(msg)\n',
        ),
    ),
    wrong(
        'passes on, and answers',
        'The input is published too',
        (
            '        self.publisher.publish(',
            '        self.publisher.publish(msg)\n        self.publisher.publish(',
        ),
    ),
    wrong(
        'small letters',
        'Make the string in the callback, from msg.data as it is.',
        ('msg.data + ', 'msg.data.lower() + '),
    ),
    wrong(
        'only texts of the chain',
        'nothing on /greeting',
        (
            '        self.publisher.publish(',
            "        if not msg.data.startswith('My name is '):\n            return\n"
            '        self.publisher.publish(',
        ),
    ),
    wrong(
        'no empty text',
        'messages were answered correctly, the others were not',
        (
            '        self.publisher.publish(',
            '        if not msg.data:\n            return\n        self.publisher.publish(',
        ),
    ),
    wrong(
        'repeats its answer',
        'a timer or a loop publishes it',
        (
            "super().__init__('polite')\n",
            "super().__init__('polite')\n        self.text = ''\n"
            '        self.timer = self.create_timer(0.5, self.on_timer)\n',
        ),
        (
            "        self.publisher.publish(String(data=msg.data + '. Nice to meet you.'))\n",
            "        self.text = msg.data + '. Nice to meet you.'\n\n"
            '    def on_timer(self):\n'
            '        self.publisher.publish(String(data=self.text))\n',
        ),
    ),
    wrong(
        'says all that it has heard',
        'no timer sends them',
        ("super().__init__('polite')\n", "super().__init__('polite')\n        self.texts = []\n"),
        (
            "        self.publisher.publish(String(data=msg.data + '. Nice to meet you.'))\n",
            "        self.texts.append(msg.data + '. Nice to meet you.')\n"
            '        for text in self.texts:\n'
            '            self.publisher.publish(String(data=text))\n',
        ),
    ),
    wrong(
        'answers both stages',
        'What comes on /incomplete is answered, too.',
        (
            "String, 'complete', self.on_text, 10)\n",
            "String, 'complete', self.on_text, 10)\n"
            "        self.create_subscription(String, 'incomplete', self.on_text, 10)\n",
        ),
    ),
    wrong(
        'only the first text',
        'does not hold the text that came in',
        ("super().__init__('polite')\n", "super().__init__('polite')\n        self.text = ''\n"),
        (
            "        self.publisher.publish(String(data=msg.data + '. Nice to meet you.'))\n",
            "        self.text = self.text or msg.data + '. Nice to meet you.'\n"
            '        self.publisher.publish(String(data=self.text))\n',
        ),
    ),
    wrong('wrong type', 'Use the same type on both sides', outcome=ERROR),
    right('functions'),
    right('a list and a timer'),
    right('names that are remapped'),
    right(
        'an executor of its own, in a thread',
        (
            'from rclpy.node',
            'import threading\n\nfrom rclpy.executors import MultiThreadedExecutor\n'
            'from rclpy.node',
        ),
        (
            'polite = lab.spin(Polite())\n',
            'executor = MultiThreadedExecutor()\nexecutor.add_node(Polite())\n'
            'threading.Thread(target=executor.spin, daemon=True).start()\n',
        ),
    ),
]
