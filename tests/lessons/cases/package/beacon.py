"""Answers to `beacon`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'not built',
        'colcon build has not been run',
        (
            '!colcon build --packages-select beacon_lab\n'
            '!colcon test --packages-select beacon_lab\n',
            '',
        ),
    ),
    wrong(
        'not tested',
        'colcon build does not run tests.',
        ('!colcon test --packages-select beacon_lab\n', ''),
    ),
    wrong(
        'built after the test',
        'no result of a test since the last build',
        (
            '!colcon build --packages-select beacon_lab\n'
            '!colcon test --packages-select beacon_lab\n',
            '!colcon build --packages-select beacon_lab\n'
            '!colcon test --packages-select beacon_lab\n'
            '!colcon build --packages-select beacon_lab\n',
        ),
    ),
    wrong('another topic', 'it publishes on: /light', ("'lit'", "'light'")),
    wrong(
        'another node name',
        'The name of the node is what super().__init__() gets.',
        ("__init__('beacon')", "__init__('lamp')"),
    ),
    wrong(
        'a test that fails',
        '1 failures and 0 errors in 1 tests',
        ('from rclpy.node', 'from pathlib import Path\n\nfrom rclpy.node'),
        (
            '!colcon build --packages-select beacon_lab\n',
            "Path('src/beacon_lab/test/test_beacon.py').write_text('def "
            "test_sum():\\n    assert 1 + 1 == 3\\n')\n"
            '!colcon build --packages-select beacon_lab\n',
        ),
    ),
    wrong(
        'a test that is not found',
        'no test that has run',
        ('from rclpy.node', 'from pathlib import Path\n\nfrom rclpy.node'),
        (
            '!colcon build --packages-select beacon_lab\n',
            "Path('src/beacon_lab/test/test_beacon.py').write_text('assert 1 + 1 "
            "== 2\\n')\n!colcon build --packages-select beacon_lab\n",
        ),
    ),
    right(
        'the whole workspace', ('!colcon build --packages-select beacon_lab\n', '!colcon build\n')
    ),
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
    right(
        'a test of its own',
        ('from rclpy.node', 'from pathlib import Path\n\nfrom rclpy.node'),
        (
            '!colcon build --packages-select beacon_lab\n',
            "Path('src/beacon_lab/test/test_beacon.py').write_text('def "
            "test_sum():\\n    assert 1 + 1 == 2\\n')\n"
            '!colcon build --packages-select beacon_lab\n',
        ),
    ),
]
