"""Answers to `lamp`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'compares after the change',
        'success is always False',
        (
            '        response.success = request.data != self.is_on\n'
            '        self.is_on = request.data\n',
            '        self.is_on = request.data\n'
            '        response.success = request.data != self.is_on\n',
        ),
    ),
    wrong(
        'forgets',
        'or the node has not remembered that',
        (
            '        self.is_on = request.data\n'
            "        response.message = 'on' if self.is_on else 'off'\n",
            "        on = request.data\n        response.message = 'on' if on else 'off'\n",
        ),
    ),
    wrong(
        'toggles',
        'or the opposite of what was asked for',
        ('        self.is_on = request.data\n', '        self.is_on = not self.is_on\n'),
    ),
    wrong(
        'no return',
        'End the callback with: return response',
        ('        return response\n', ''),
        outcome=ERROR,
    ),
    wrong('another topic', 'A slip of the pen?'),
    wrong('a private name', 'it lies in another namespace', ("'switch_lamp'", "'~/switch_lamp'")),
    wrong(
        'Trigger',
        'with the type std_srvs/srv/Trigger',
        ('SetBool', 'Trigger'),
        ('request.data', 'bool(request)'),
    ),
    wrong('not spun', 'Hand the node over: lab.spin(node)'),
    wrong(
        'waits in the callback',
        'While a callback runs, no other one can',
        (
            '        return response\n',
            '        import time\n\n        time.sleep(3)\n        return response\n',
        ),
    ),
    wrong(
        'always success, in a process of its own',
        'success is always True',
        ('request.data != self.is_on', 'True'),
        run='process',
    ),
    wrong('another node serves', 'Another node serves /switch_lamp.'),
    wrong(
        'goes off by itself',
        'success = False for data = True, while the lamp is on',
        (
            '        self.is_on = False\n',
            '        self.is_on = False\n        self.timer = self.create_timer(1.0, self.off)\n\n'
            '    def off(self):\n        self.is_on = False\n',
        ),
    ),
    wrong(
        'thirty requests and no more',
        "message = ''",
        (
            '    def on_switch(self, request, response):\n',
            '    def on_switch(self, request, response):\n'
            "        self.count = getattr(self, 'count', 0) + 1\n"
            '        if self.count > 30:\n            return response\n',
        ),
    ),
    right('functions, and an executor of its own'),
    right(
        'if and else',
        (
            '        response.success = request.data != self.is_on\n'
            '        self.is_on = request.data\n',
            '        if request.data == self.is_on:\n'
            '            response.success = False\n        else:\n'
            '            response.success = True\n'
            '            self.is_on = not self.is_on\n',
        ),
    ),
    right(
        'a new response, and a coroutine',
        ('    def on_switch', '    async def on_switch'),
        ('        response.success = request', '        changes = request'),
        (
            "        response.message = 'on' if self.is_on else 'off'\n        return response\n",
            "        word = 'on' if self.is_on else 'off'\n"
            '        return SetBool.Response(success=changes, message=word)\n',
        ),
    ),
]
