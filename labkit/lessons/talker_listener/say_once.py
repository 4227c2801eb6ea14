"""Exercise: publish one message, when somebody listens."""

from __future__ import annotations

import random

from labkit.exercises import Exercise, Fail, Watch, expect, words_of
from labkit.exercises.clauses import Asked, Evidence, GraphClause, Runs
from labkit.exercises.expect.timing import FOUND_SEC
from labkit.exercises.figures import many
from labkit.exercises.observation import LIFE_SEC, live

__all__ = ['exercise']

WORDS = words_of(__file__)

TOPIC, STRING = '/door', 'std_msgs/msg/String'
TEXT = 'The door is open'
# So long time passes while nobody listens, s: another one each time, but never so long that a node
# that looks once a minute is just about to.
ALONE_SEC = (20.0, 29.0)
# What comes soon after a message comes from a node that keeps a time of its own, s of real time.
SOON_SEC = 1.2

_AGAIN = 'Run the cell of your node again before each check: it speaks once only.'
NOT_HEARD = WORDS.mistake('say-once/not-heard')
TOO_EARLY = WORDS.mistake('say-once/too-early')
SAID_AGAIN = WORDS.mistake('say-once/said-again')
GOES_ON = WORDS.mistake('say-once/goes-on')
HEARD_BEFORE = WORDS.mistake('say-once/heard-before')


class _SaysIt(GraphClause):
    """When somebody listens, the node says the text."""

    text = WORDS.of(life=f'{LIFE_SEC:.0f}').clause('says-it')

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

    text = WORDS.clause('silent-before')

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
    node = evidence.probe.node_object(evidence.publisher(TOPIC).node)
    stopped = node is not None and all(timer.is_canceled() for timer in node.timers)
    # A second subscriber is no reason to say it again.
    evidence.probe.watch(TOPIC, STRING)
    if evidence.probe.wait(lambda: len(watch) > 1, SOON_SEC):
        raise Fail(
            f'one message on {TOPIC}, and no other',
            f'{many(len(watch), "message")}: {expect.show(watch.values("data"))}',
            SAID_AGAIN if stopped else GOES_ON,
        )


def _heard(evidence: Evidence) -> Watch:
    """Return what has come on the topic since the check listens."""
    watch = evidence.heard[TOPIC]
    watch.pump()
    return watch


exercise = Exercise(
    words=WORDS,
    publishes={TOPIC: STRING},
    clauses=(
        _SaysIt(),
        Runs(WORDS.clause('runs'), topic=TOPIC),
        _SilentBefore(),
        Asked(WORDS.clause('silent-after'), _silent_after),
    ),
    once=True,
)
