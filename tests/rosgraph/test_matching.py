"""What to change where two ends of a topic do not match."""

from __future__ import annotations

import pytest
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy

from labkit.rosgraph.endpoints import Endpoint
from labkit.rosgraph.matching import how_to_match, why_apart

INT16 = 'std_msgs/msg/Int16'
BEST, RELIABLE = ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.RELIABLE
VOLATILE, KEPT = DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL
BY_ITSELF, BY_HAND = LivelinessPolicy.AUTOMATIC, LivelinessPolicy.MANUAL_BY_TOPIC
MINE, YOURS = 'the subscription of /ear', 'the publisher of /mouth'


def end(node: str, msg_type: str = INT16, **policies: object) -> Endpoint:
    return Endpoint(node, '/topic', msg_type, QoSProfile(depth=1, **policies), bytes(16))


@pytest.mark.parametrize(
    ('policy', 'offered', 'asked', 'todo'),
    [
        (
            'reliability',
            BEST,
            RELIABLE,
            f'Give {MINE} reliability BEST_EFFORT, or {YOURS} RELIABLE.',
        ),
        (
            'durability',
            VOLATILE,
            KEPT,
            f'Give {MINE} durability VOLATILE, or {YOURS} TRANSIENT_LOCAL.',
        ),
        (
            'liveliness',
            BY_ITSELF,
            BY_HAND,
            f'Give {MINE} liveliness AUTOMATIC, or {YOURS} MANUAL_BY_TOPIC.',
        ),
        (
            'deadline',
            Duration(seconds=1),
            Duration(seconds=0.5),
            f'Give {MINE} a deadline of 1 s at least, or {YOURS} one of 0.5 s at most.',
        ),
        (
            'deadline',
            Duration(),
            Duration(seconds=0.5),
            f'Take the deadline of {MINE} away, or give {YOURS} one of 0.5 s at most.',
        ),
        (
            'liveliness_lease_duration',
            Duration(seconds=3),
            Duration(seconds=2),
            f'Give {MINE} a liveliness lease duration of 3 s at least, or {YOURS} one of 2 s at '
            'most.',
        ),
    ],
)
def test_each_policy_can_be_mended_at_either_end(policy, offered, asked, todo):
    mouth, ear = end('/mouth', **{policy: offered}), end('/ear', **{policy: asked})
    assert why_apart(mouth, ear)
    assert how_to_match(mouth, ear) == todo
    # Both of what it says is true, and the other way round there is nothing to mend.
    for other in (offered, asked):
        same = end('/mouth', **{policy: other}), end('/ear', **{policy: other})
        assert (why_apart(*same), how_to_match(*same)) == ('', '')
    swapped = end('/mouth', **{policy: asked}), end('/ear', **{policy: offered})
    assert (why_apart(*swapped), how_to_match(*swapped)) == ('', '')


def test_all_policies_that_differ_are_named():
    mouth = end('/mouth', reliability=BEST)
    ear = end('/ear', durability=KEPT, deadline=Duration(seconds=0.2))
    assert why_apart(mouth, ear) == (
        'Best effort publisher and reliable subscription; volatile publisher and transient local '
        'subscription; subscription has a deadline, but publisher does not'
    )
    said = how_to_match(mouth, ear)
    assert [said.count(word) for word in ('BEST_EFFORT', 'VOLATILE', 'deadline')] == [1, 1, 1]


def test_another_type_comes_first():
    ear = end('/ear', 'std_msgs/msg/String', durability=KEPT)
    assert how_to_match(end('/mouth'), ear) == f'Give {MINE} and {YOURS} the same type.'


def test_as_the_graph_tells_it(script):
    """In the graph, what was not set has its value, and no deadline is a very long one."""
    result = script(
        """
import labkit as lab
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import Int16
from labkit.background.runtime import runtime
from labkit.rosgraph.snapshot import read_graph

lab.start()
mouth, ear = Node('mouth'), Node('ear')
mouth.create_publisher(Int16, '/topic', 10)
ear.create_subscription(Int16, '/topic', print, QoSProfile(depth=1, deadline=Duration(seconds=1)))
for pair in read_graph(runtime.helper).mismatches:
    print(pair.reason, pair.todo, sep='\\n')
"""
    )
    assert result.stdout == (
        'Subscription has a deadline, but publisher does not\n'
        f'Take the deadline of {MINE} away, or give {YOURS} one of 1 s at most.\n'
    ), result.stderr
