"""Answers to `wall`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'two beams more on each side',
        'Something beside or behind the robot was taken for the wall ahead.',
        ('[:10]', '[:12]'),
        ('[-10:]', '[-12:]'),
    ),
    wrong(
        'forgets to stop',
        'leaves it driving',
        (
            '            self.driving = False\n',
            '            self.driving = False\n            return\n',
        ),
    ),
    wrong(
        'looks back',
        'ranges[180] back',
        ('msg.ranges[:10] + msg.ranges[-10:]', 'msg.ranges[180:181]'),
    ),
    wrong(
        'does not wait for the next sign',
        'It stands, and still publishes',
        ('        else:\n            self.driving = False\n', ''),
    ),
    wrong(
        'the first time only',
        'Something is used up by the first drive',
        ('        self.publisher =', '        self.used = False\n        self.publisher ='),
        (
            '        self.driving = True\n',
            '        if not self.used:\n            self.used = True\n'
            '            self.driving = True\n',
        ),
    ),
    wrong(
        'says it once',
        'have to say so again and again',
        (
            '            msg.linear.x = 0.2\n',
            '            msg.linear.x = 0.2\n            self.driving = False\n',
        ),
    ),
    wrong(
        'to the left',
        'or looked elsewhere',
        ('msg.ranges[:10] + msg.ranges[-10:]', 'msg.ranges[80:100]'),
    ),
    wrong(
        'an int in a float field', 'takes values of type float', ('= 0.2', '= 1'), outcome=ERROR
    ),
    wrong(
        'one beam',
        'It saw the wall too late',
        ('msg.ranges[:10] + msg.ranges[-10:]', 'msg.ranges[:1]'),
    ),
    wrong(
        'the left half of the beams',
        'It saw the wall too late',
        ('msg.ranges[:10] + msg.ranges[-10:]', 'msg.ranges[:10]'),
    ),
    wrong(
        'the inner half of the beams',
        'It saw the wall too late',
        ('msg.ranges[:10] + msg.ranges[-10:]', 'msg.ranges[:5] + msg.ranges[-5:]'),
    ),
    wrong(
        'the outer half of the beams',
        'It saw the wall too late',
        ('msg.ranges[:10] + msg.ranges[-10:]', 'msg.ranges[5:10] + msg.ranges[-10:-5]'),
    ),
    wrong(
        'all but the outermost beam on the left',
        'It saw the wall too late',
        ('msg.ranges[:10] + msg.ranges[-10:]', 'msg.ranges[:9] + msg.ranges[-10:]'),
    ),
    wrong(
        'all but the outermost beam on the right',
        'It saw the wall too late',
        ('msg.ranges[:10] + msg.ranges[-10:]', 'msg.ranges[:10] + msg.ranges[-9:]'),
    ),
    wrong(
        'every even beam',
        'It saw the wall too late',
        ('msg.ranges[:10] + msg.ranges[-10:]', 'msg.ranges[:10:2] + msg.ranges[-10::2]'),
    ),
    wrong(
        'every odd beam',
        'It saw the wall too late',
        ('msg.ranges[:10] + msg.ranges[-10:]', 'msg.ranges[1:10:2] + msg.ranges[-9::2]'),
    ),
    wrong(
        'every second beam of each half, counted from the middle',
        'It saw the wall too late',
        ('msg.ranges[:10] + msg.ranges[-10:]', 'msg.ranges[:10:2] + msg.ranges[-1:-11:-2]'),
    ),
    wrong(
        'a speed that is nearly right',
        'a command with linear.x = 0.20001',
        ('= 0.2\n', '= 0.20001\n'),
    ),
    wrong('the farthest one', 'It saw the wall too late', ('min(ahead', 'max(ahead')),
    wrong(
        'the median',
        'It saw the wall too late',
        ('min(ahead, default=math.inf)', 'sorted(ahead or [math.inf])[len(ahead) // 2]'),
    ),
    wrong(
        'a box of 45 degrees to each side',
        'was taken for the wall ahead',
        ('msg.ranges[:10] + msg.ranges[-10:]', 'msg.ranges[:45] + msg.ranges[-45:]'),
    ),
    wrong(
        'nine drives and no more',
        'drives after 9 of them, and nothing after the next one',
        (
            '        self.driving = True\n',
            "        self.count = getattr(self, 'count', 0) + 1\n"
            '        if self.count <= 9:\n            self.driving = True\n',
        ),
    ),
    right(
        'by the angles of the message',
        (
            'msg.ranges[:10] + msg.ranges[-10:]',
            '[msg.ranges[i] for i in range(-10, 10)]',
        ),
    ),
    right(
        'in the callback of the scan',
        ('        self.timer = self.create_timer(0.1, self.on_timer)\n', ''),
        ('default=math.inf)\n', 'default=math.inf)\n        self.on_timer()\n'),
    ),
    right(
        'twenty commands a second, and any distance above 0',
        ('create_timer(0.1,', 'create_timer(0.05,'),
        ('if msg.range_min <= way <= msg.range_max', 'if way > 0.0'),
    ),
    right('functions and a loop with a rate'),
]
