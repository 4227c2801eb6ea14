"""Publish odd numbers: every matcher of the graph, of messages and of their values."""

from __future__ import annotations

from by_hand import ByHand

from labkit.exercises import Exercise, Probe, Solution, expect

INT16 = 'std_msgs/msg/Int16'


def judge_count_up(probe: Probe) -> str:
    source = expect.publisher(probe, '/demo_odds')
    odds = expect.messages(probe, source, count=4)
    expect.each(
        odds,
        'data',
        lambda value: value % 2 == 1,
        expected='odd numbers: 1, 3, 5, ...',
        why='These are even numbers. Adding 2 keeps a number odd only if the first one is odd.',
        todo='Start with 1.',
    )
    expect.steps(odds, 'data', 2)
    expect.first(odds, 'data', 1, 2, why='The count starts with another number than 1.')
    expect.node(probe, '/odd_publisher')
    return f'{source.node} sent {expect.show(odds.values("data"))}'


count_up = Exercise(
    name='count_up',
    task='A node `odd_publisher` that publishes 1, 3, 5, ... on /demo_odds, ten a second.',
    publishes={'/demo_odds': INT16},
    nodes=['/odd_publisher'],
    stage=ByHand(judge_count_up),
    hints=['Which line runs again and again?', 'A timer of 0.1 s, and self.number += 2.'],
    answer=Solution(
        __file__, 'count_up.py', 'The number lives in the node, so it outlives the callback.'
    ),
)
