"""Say something once, before the check: what is recorded."""

from __future__ import annotations

from labkit.exercises import Exercise, Probe, Solution, Style, Wrong, changed, expect

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
        why='Another text was published.',
    )
    expect.that(
        len(heard) == 1,
        expected='one message',
        seen=f'{len(heard)} messages',
        why='It was published more than once.',
    )
    return 'One message, once.'


SAY = """
import rclpy
from std_msgs.msg import String

node = rclpy.create_node('once')
pub = node.create_publisher(String, 'demo_news', 10)
pub.publish(String(data='late'))
"""

say_once = Exercise(
    name='say_once',
    task='Publish the text late on /demo_news, once.',
    publishes={'/demo_news': STRING},
    judge=judge_say_once,
    hints=['publish() without a timer', 'pub.publish(String(data="late"))'],
    answer=Solution(SAY, 'Nothing more is needed: somebody listens already.'),
    styles=[Style('node gone again', SAY + 'node.destroy_node()\n')],
    wrong=[
        Wrong('twice', SAY + "pub.publish(String(data='late'))\n", 'more than once'),
        Wrong('other text', changed(SAY, ("'late'", "'Late'")), 'Another text was published'),
        Wrong(
            'never', changed(SAY, ("pub.publish(String(data='late'))\n", '')), 'no loop publishes'
        ),
    ],
    records=['/demo_news'],
)
