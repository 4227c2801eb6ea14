"""Answers to `count_up`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'set anew in the callback',
        'Every message says 1',
        ('        self.number = 1\n', ''),
        ('        msg = Int16()', '        self.number = 1\n        msg = Int16()'),
    ),
    wrong(
        '=+ for +=',
        'Every message says 2',
        ('self.number += 2', 'self.number =+ 2'),
        refused='No formatter writes =+ without a space.',
    ),
    wrong(
        'in the namespace of the node',
        'it lies in another namespace',
        ("'odds', 10", "'~/odds', 10"),
    ),
    wrong('wrong type', 'A topic carries one type of message.', ('Int16', 'Int32')),
    wrong(
        'forgot to publish',
        'publish() is not called there',
        ('        self.publisher.publish(msg)\n', ''),
    ),
    wrong('off by ten', 'times too fast', ('create_timer(0.2,', 'create_timer(0.02,')),
    wrong('two copies running', 'Two copies of the node run at once', run='two copies'),
    wrong('a third too slow', '1.5 times too slow', ('create_timer(0.2,', 'create_timer(0.3,')),
    wrong(
        'three per cent too slow',
        '1.03 times too slow',
        ('create_timer(0.2,', 'create_timer(0.206,'),
    ),
    wrong(
        'every 5 s',
        'A rate in Hz and a period in seconds were mixed up',
        ('create_timer(0.2,', 'create_timer(5,'),
    ),
    wrong(
        'ends at 19',
        'They stop coming.',
        (
            '        self.number += 2\n',
            '        self.number += 2\n        if self.number > 19:\n'
            '            self.timer.cancel()\n',
        ),
    ),
    wrong('publishes twice', 'Twice as many messages come as were asked for'),
    right('functions'),
    right('a loop with a rate, in a thread'),
    right(
        'a timer that wakes a thread',
        ('from rclpy', '\nimport queue\nimport threading\n\nfrom rclpy'),
        ('self.on_timer)\n', 'lambda: self.ticks.put(1))\n'),
        (
            'self.number = 1\n',
            'self.number = 1\n        self.ticks = queue.Queue()\n'
            '        threading.Thread(target=self.work, daemon=True).start()\n\n'
            '    def work(self):\n        while self.ticks.get():\n'
            '            sum(range(100_000))  # it takes its time\n'
            '            self.on_timer()\n',
        ),
    ),
    wrong(
        'other numbers at its beginning',
        'The count does not start with 1.',
        ('msg.data = self.number', 'msg.data = max(self.number, 5)'),
        ('Odds())\n', 'Odds())\nlab.wait_until(lambda: odds.number > 9)\n'),
    ),
    right('a fast timer, and every fourth call counts'),
    right(
        'in a namespace, with the full name of the topic',
        ("super().__init__('odd_source')", "super().__init__('add_one', namespace='sums')"),
        ("'odds', 10", "'/odds', 10"),
    ),
]
