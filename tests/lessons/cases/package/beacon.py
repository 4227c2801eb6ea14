"""Answers to `beacon`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

BUILD = 'colcon build --packages-select beacon_lab\n'
TEST = 'colcon test --packages-select beacon_lab\n'
RUN = 'ros2 run beacon_lab beacon > beacon.log 2>&1 &\n'

ANSWERS = [
    wrong('not built', 'colcon build has not been run', (BUILD, ''), (TEST, '')),
    wrong('not started', 'No program of that name runs on this machine just now.', (RUN, '')),
    wrong('not tested', 'colcon build does not run tests.', (TEST, '')),
    wrong(
        'built after the test',
        'no result of a test since the last build',
        (TEST, f'{TEST}{BUILD}'),
    ),
    wrong('another topic', 'it publishes on: /light', ("'lit'", "'light'")),
    wrong(
        'another node name',
        'The name of the node is what super().__init__() gets.',
        ("__init__('beacon')", "__init__('lamp')"),
    ),
    wrong('a test that fails', '1 failure and 0 errors in 1 test', ("== 'beacon'", "== 'lamp'")),
    wrong('a test that is not found', 'no test that has run', ('def test_name', 'def name')),
    wrong(
        'true, and then false',
        'Seen: False',
        (
            '        self.publisher.publish(Bool(data=True))\n',
            '        self.publisher.publish(Bool(data=True))\n'
            '        self.publisher.publish(Bool(data=False))\n',
        ),
    ),
    right('lab.export'),
    right('the whole workspace', (BUILD, 'colcon build\n')),
    right(
        'the profile inside',
        ('\nLATE = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n', ''),
        (
            '        self.publisher = self.create_publisher(Bool, ',
            '        late = QoSProfile(depth=1)\n'
            '        late.durability = DurabilityPolicy.TRANSIENT_LOCAL\n'
            '        self.publisher = self.create_publisher(Bool, ',
        ),
        ("'lit', LATE", "'lit', late"),
    ),
    right(
        'again and again',
        (
            '        self.publisher.publish(Bool(data=True))\n',
            '        self.create_timer(0.5, self.on_timer)\n\n    def on_timer(self):\n'
            '        self.publisher.publish(Bool(data=True))\n',
        ),
    ),
]
