"""Say something as the node ends: a check that uses up what it checks."""

from __future__ import annotations

from by_hand import ByHand

from labkit.exercises import Exercise, Mistake, Probe, Solution, expect

NO_WORD = Mistake(
    '', 'The node ends without a word, and whoever listens goes on with the last speed.'
)


def judge_goodbye(probe: Probe) -> str:
    source = expect.publisher(probe, '/demo_speed')
    speeds = expect.messages(probe, source, count=2)
    expect.that(
        {*speeds.values('data')} == {1.0},
        expected='1.0 while it runs',
        seen=expect.show(speeds.values('data')),
    )
    last = expect.ends_with_node(probe, source)
    expect.that(
        last.values('data')[-1] == 0.0,
        expected='0.0 as the last message',
        seen=f'{last.values("data")[-1]!r}',
        mistake=NO_WORD,
    )
    return 'Its last word was 0.0.'


goodbye = Exercise(
    name='goodbye',
    task='A node that publishes 1.0 on /demo_speed, and 0.0 as its last word.',
    publishes={'/demo_speed': 'std_msgs/msg/Float64'},
    stage=ByHand(judge_goodbye),
    hints=['What is called when a node ends?', 'destroy_node()'],
    answer=Solution(__file__, 'goodbye.py', 'destroy_node() is called whatever ends the node.'),
    once=True,
)
