"""Say something once, before the check: what is recorded."""

from __future__ import annotations

from by_hand import ByHand

from labkit.exercises import Exercise, Mistake, Probe, Solution, expect

STRING = 'std_msgs/msg/String'


def judge_say_once(probe: Probe) -> str:
    heard = probe.recorded['/demo_news'].values('data')
    if not heard:
        source = expect.publisher(probe, '/demo_news')
        expect.messages(probe, source, count=1)
    expect.that(
        heard[-1:] == ['late'],
        expected="the text 'late'",
        seen=repr(heard[-1]),
        mistake=Mistake('', 'Another text was published.'),
    )
    expect.that(
        len(heard) == 1,
        expected='one message',
        seen=f'{len(heard)} messages',
        mistake=Mistake('', 'It was published more than once.'),
    )
    return 'One message, once.'


say_once = Exercise(
    name='say_once',
    task='Publish the text late on /demo_news, once.',
    publishes={'/demo_news': STRING},
    stage=ByHand(judge_say_once),
    hints=['publish() without a timer', 'pub.publish(String(data="late"))'],
    answer=Solution(__file__, 'say_once.py', 'Nothing more is needed: somebody listens already.'),
    records=['/demo_news'],
)
