"""Publish odd numbers: every matcher of the graph and of messages."""

from __future__ import annotations

from by_hand import ByHand

from labkit.exercises import Exercise, Mistake, Probe, Solution, expect

INT16 = 'std_msgs/msg/Int16'
OTHER_NUMBERS = Mistake('', 'The count does not begin with 1, or does not grow by 2.')


def judge_count_up(probe: Probe) -> str:
    source = expect.publisher(probe, '/demo_odds')
    odds = expect.messages(probe, source, count=4)
    # A message carries the number that it has among those of its publisher.
    expect.that(
        odds.values('data') == [2 * sample.number - 1 for sample in odds.samples],
        expected='odd numbers: 1, 3, 5, ...',
        seen=expect.show(odds.values('data')),
        mistake=OTHER_NUMBERS,
    )
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
