"""Exercise: a package with a quality of service that serves late listeners, and with a test."""

from __future__ import annotations

from labkit.exercises import Exercise, Fail, words_of
from labkit.exercises.clauses import Asked
from labkit.lessons.package.content import TESTED, Built, InAWorkspace, Work
from labkit.lessons.package.running import Running

__all__ = ['exercise']

WORDS = words_of(__file__)

PACKAGE, TOPIC, BOOL = 'beacon_lab', '/lit', 'std_msgs/msg/Bool'

VOLATILE = WORDS.mistake('beacon/a-depth-alone')
NOTHING = WORDS.mistake('beacon/publishes-nothing')
FALSE = WORDS.mistake('beacon/false')


def _is_heard_late(work: Work) -> None:
    durability = work.end('/beacon', TOPIC, BOOL).qos.durability.name
    if durability != 'TRANSIENT_LOCAL':
        raise Fail('durability TRANSIENT_LOCAL', f'durability {durability}', VOLATILE)
    watch = work.probe.watch(TOPIC, BOOL, latched=True)
    if not work.wait(lambda: len(watch) > 0):
        raise Fail(f'True on {TOPIC}, for a subscriber that comes late', 'nothing', NOTHING)
    if watch[-1].data is not True:
        raise Fail('True', repr(watch[-1].data), FALSE)


exercise = Exercise(
    words=WORDS,
    clauses=(
        Built(PACKAGE),
        Running('beacon', 'beacon', PACKAGE),
        Asked(
            WORDS.clause('is-heard-late'),
            _is_heard_late,
        ),
        TESTED,
    ),
    stage=InAWorkspace(PACKAGE),
)
