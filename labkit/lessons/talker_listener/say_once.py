"""Exercise: publish one message, when somebody listens."""

from __future__ import annotations

import random

from labkit.exercises import Exercise, Fail, Mistake, Solution, Watch, expect
from labkit.exercises.clauses import Asked, Evidence, GraphClause, Runs
from labkit.exercises.expect.timing import FOUND_SEC
from labkit.exercises.observation import LIFE_SEC, live

__all__ = ['exercise']

TOPIC, STRING = '/door', 'std_msgs/msg/String'
TEXT = 'The door is open'
# So long time passes while nobody listens, s: another one each time, but never so long that a node
# that looks once a minute is just about to.
ALONE_SEC = (20.0, 29.0)
# What comes soon after a message comes from a node that keeps a time of its own, s of real time.
SOON_SEC = 1.2

_AGAIN = 'Run the cell of your node again before each check: it speaks once only.'
NOT_HEARD = Mistake(
    'say-once/not-heard',
    'If it was published before somebody listened, it is lost: nobody keeps it for those who come '
    'later. Or publish() was not reached at all.',
    f'Publish only when get_subscription_count() is not 0. {_AGAIN}',
    change=[('if self.publisher.get_subscription_count() > 0:', 'if True:')],
)
TOO_EARLY = Mistake(
    'say-once/too-early',
    'The earlier ones were published while nobody listened.',
    f'Look at get_subscription_count() before you publish. {_AGAIN}',
    change=[
        ('if self.publisher.get_subscription_count() > 0:', 'if True:'),
        ('            self.timer.cancel()\n', ''),
    ],
)
GOES_ON = Mistake(
    'say-once/goes-on',
    'Nothing stops the node after its first message.',
    'self.timer.cancel() ends the timer.',
    change=[('            self.timer.cancel()\n', '')],
)
HEARD_BEFORE = Mistake(
    'say-once/heard-before',
    'The node speaks once. If it has spoken to somebody else, the check hears nothing.',
    'End the other subscription, and run the cell of your node again.',
)


class _SaysIt(GraphClause):
    """When somebody listens, the node says the text."""

    text = (
        f'within {LIFE_SEC:.0f} seconds of the first subscription to `{TOPIC}`, publish `{TEXT}` '
        f'there (`{STRING}`)'
    )

    def find(self, evidence: Evidence) -> None:
        """Look for the publisher."""
        evidence.publisher(TOPIC)

    def judge(self, evidence: Evidence) -> str:
        """Judge the first message."""
        watch, source = _heard(evidence), evidence.publisher(TOPIC)
        if not evidence.probe.wait(lambda: len(watch), FOUND_SEC):
            expect.hanging()
            raise Fail(
                f'one message on {TOPIC}, as soon as somebody subscribes',
                f'{source.node} has a publisher, but no message came',
                NOT_HEARD,
            )
        first, said = watch.samples[0], watch.samples[0].message.data
        if first.number <= 1 and said != TEXT:
            trouble = expect.text_trouble(said, TEXT)
            raise Fail(f'data = {TEXT!r} on {TOPIC}', f'data = {said!r}', trouble, todo=_AGAIN)
        return f'{source.node} waited, and said {TEXT!r} once.'


class _SilentBefore(GraphClause):
    """As long as nobody listens, the node says nothing."""

    text = 'publish nothing before that subscription'

    def find(self, evidence: Evidence) -> None:
        """Let time pass while nobody listens, and then listen."""
        from labkit.rosgraph.endpoints import subscriptions
        from labkit.rosgraph.names import is_hidden

        probe = evidence.probe
        others = {end.node for end in subscriptions(probe.node, TOPIC)}
        if others:
            names = sorted({'a view' if is_hidden(name) else name for name in others})
            raise Fail(
                f'nobody subscribes to {TOPIC} before the check does',
                f'{", ".join(names)} subscribes there',
                HEARD_BEFORE,
            )
        # Nothing is written down here, so its times need not be known.
        seconds, node = random.uniform(*ALONE_SEC), evidence.publisher(TOPIC).node
        evidence.life = live(probe, {}, seconds, nodes=[node], step=0.5)
        evidence.refuse_trouble(())
        evidence.heard[TOPIC] = probe.watch(TOPIC, STRING)

    def judge(self, evidence: Evidence) -> str:
        """Judge as which one the first message came."""
        number = _heard(evidence).samples[0].number
        if number > 1:
            raise Fail(
                f'one message on {TOPIC}, as soon as somebody subscribes',
                f'the first message that came was number {number} of its publisher',
                TOO_EARLY,
            )
        return ''


def _silent_after(evidence: Evidence) -> None:
    """Judge what else came."""
    watch = _heard(evidence)
    if evidence.probe.wait(lambda: len(watch) > 1, SOON_SEC):
        raise Fail(
            f'one message on {TOPIC}, and no other',
            f'{len(watch)} messages: {expect.show(watch.values("data"))}',
            GOES_ON,
        )


def _heard(evidence: Evidence) -> Watch:
    """Return what has come on the topic since the check listens."""
    watch = evidence.heard[TOPIC]
    watch.pump()
    return watch


exercise = Exercise(
    name='say_once',
    task=f'Write a node that says "{TEXT}" on {TOPIC} once, when somebody subscribes.',
    publishes={TOPIC: STRING},
    clauses=(
        _SaysIt(),
        Runs('the node is spun, and it does not block while it waits', topic=TOPIC),
        _SilentBefore(),
        Asked('publish nothing after that message', _silent_after),
    ),
    hints=[
        'The node must look again and again whether somebody is there. What calls a callback '
        'again and again?',
        'In the callback of a timer: if self.publisher.get_subscription_count() > 0, publish.',
        'After publishing, self.timer.cancel() ends the timer. So nothing is said twice.',
    ],
    answer=Solution(
        __file__,
        'say_once.py',
        'The timer looks ten times a second, and the processor rests in between. A loop without '
        'a pause would keep it busy, and no other callback could run.',
    ),
    once=True,
)
