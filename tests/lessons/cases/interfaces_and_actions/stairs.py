"""Answers to `stairs`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

RUN = 'python3 nodes/stairs.py > stairs.log 2>&1 &\n'

ANSWERS = [
    wrong('in the notebook', 'A node of a notebook ends with the notebook.'),
    wrong('not started', 'No program of that name runs on this machine', (RUN, '')),
    wrong(
        'without the line with export',
        'it has none: domain 0',
        (RUN, f'env -u ROS_DOMAIN_ID {RUN}'),
    ),
    wrong(
        'changed while it runs',
        'A program keeps the code with which it was started.',
        (RUN, f'{RUN}touch -d "5 seconds" nodes/stairs.py\n'),
    ),
    wrong(
        'another node name',
        'The name of the node is what super().__init__() gets.',
        ("__init__('stairs'", "__init__('stair'"),
    ),
    wrong('another file', 'the file nodes/stair.py', ('> nodes/stairs.py', '> nodes/stair.py')),
    wrong(
        'never the same twice',
        'goal_callback did not return GoalResponse.ACCEPT for it.',
        (
            '        if 1 <=',
            '        before, self.before = getattr(self, "before", 0), goal.order\n'
            '        if goal.order != before and 1 <=',
        ),
        ('"before"', "'before'"),
    ),
    wrong(
        'in a namespace',
        'The name of the node is what super().__init__() gets.',
        ("__init__('stairs'", "__init__('stairs', namespace='my_own'"),
    ),
    wrong(
        'another topic',
        "Write the name as '/stairs'",
        ("Fibonacci, 'stairs'", "Fibonacci, 'stair'"),
    ),
    wrong(
        'no goal_callback',
        'No goal at all was rejected',
        ('        self.server.register_goal_callback(self.on_goal)\n', ''),
    ),
    wrong('all rejected', 'it was rejected', ('1 <= goal.order <= 20', 'goal.order > 99')),
    wrong('20 rejected', 'order = 20 is succeeded', ('<= 20', '< 20')),
    wrong('1 rejected', 'order = 1 is succeeded', ('1 <=', '1 <')),
    wrong(
        'goal_callback accepts all',
        'or it accepts each goal',
        ('return GoalResponse.REJECT', 'return GoalResponse.ACCEPT'),
    ),
    wrong('0 accepted', 'Others were rejected, and this one was not.', ('1 <=', '0 <=')),
    wrong(
        'below 0 only',
        'Others were rejected, and this one was not.',
        ('1 <= goal.order <= 20', 'goal.order >= 0'),
    ),
    wrong(
        'modulo 100',
        'Others were rejected, and this one was not.',
        ('1 <= goal.order <= 20', '1 <= goal.order % 100 <= 20'),
    ),
    wrong(
        'what is huge is accepted',
        'Others were rejected, and this one was not.',
        ('1 <= goal.order <= 20', '1 <= goal.order <= 20 or goal.order > 1000'),
        (', goal_handle.request.order + 1', ', min(goal_handle.request.order, 20) + 1'),
    ),
    wrong(
        'thirty goals and no more',
        'it was rejected',
        (
            '        if 1 <=',
            "        self.count = getattr(self, 'count', 0) + (1 <= goal.order <= 20)\n"
            '        if self.count <= 30 and 1 <=',
        ),
    ),
    wrong('no lower limit', 'is rejected', ('1 <= goal.order <= 20', 'goal.order <= 20')),
    wrong(
        'True in the place of ACCEPT',
        'goal_callback did not return GoalResponse.ACCEPT',
        (
            '        if 1 <= goal.order <= 20:\n            return GoalResponse.ACCEPT\n'
            '        return GoalResponse.REJECT\n',
            '        return 1 <= goal.order <= 20\n',
        ),
    ),
    wrong(
        'refused too late',
        'comes too late to reject a goal',
        ('        self.server.register_goal_callback(self.on_goal)\n', ''),
        (
            '        goal_handle.succeed()\n',
            '        if not 1 <= goal_handle.request.order <= 20:\n'
            '            goal_handle.abort()\n            return Fibonacci.Result()\n'
            '        goal_handle.succeed()\n',
        ),
    ),
    wrong('one number too few', 'result = ', ('order + 1', 'order')),
    wrong('from 0 on', 'The numbers are not those of the task.', ('range(1, ', 'range(')),
    wrong(
        'a typing error in goal_callback',
        'The server of /stairs has ended meanwhile.',
        ('1 <= goal.order', '1 <= goal.ordr'),
    ),
    right(
        'lambda',
        ('(self.on_goal)', '(lambda goal: GoalResponse(1 + (0 < goal.order < 21)))'),
        (
            '    def on_goal(self, goal):\n        if 1 <= goal.order <= 20:\n'
            '            return GoalResponse.ACCEPT\n        return GoalResponse.REJECT\n'
            '\n',
            '',
        ),
    ),
    right(
        'a keyword',
        (
            "        self.server = ActionServer(self, Fibonacci, 'stairs', "
            'self.execute)\n        self.server.register_goal_callback(self.on_goal)\n',
            '        self.server = ActionServer(\n'
            "            self, Fibonacci, 'stairs', self.execute, "
            'goal_callback=self.on_goal\n        )\n',
        ),
    ),
    right('own process, several threads'),
    right('in the folder', (RUN, f'cd nodes\n{RUN.replace("nodes/", "")}')),
]
