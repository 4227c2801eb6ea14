"""Exercise: one more stage at the end of the chain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from labkit.exercises import Exercise, Fail, Mistake, Probe, Solution, expect, words_of
from labkit.exercises.clauses import WITHIN, Answers, Evidence
from labkit.exercises.observation import Stimulus, live
from labkit.exercises.variants import varied
from labkit.lessons.my_name_is.stages import INNER, NOT_IN_IT, NOTHING_ADDED, STRING

__all__ = ['exercise']

WORDS = words_of(__file__)

HEARS, SAYS = '/complete', '/greeting'
ENDING = '. Nice to meet you.'

IN_FRONT = WORDS.mistake('third-stage/in-front')
GOES_PAST = WORDS.mistake('third-stage/goes-past')


@dataclass(frozen=True, eq=False)
class _AtTheEnd(Answers):
    """The last stage of a chain hears the one before it, and no earlier one."""

    def find(self, evidence: Evidence) -> None:
        """Look for the stage."""
        probe = evidence.probe
        hears = {endpoint.node for endpoint in probe.subscriptions(HEARS)}
        others = {endpoint.node for endpoint in probe.publishers(SAYS)} - hears
        past = [end.node for end in probe.subscriptions(INNER) if end.node in others]
        if past:
            raise Fail(
                f'a third stage that subscribes to {HEARS}',
                f'{past[0]} subscribes to {INNER}',
                GOES_PAST,
            )
        super().find(evidence)


def _trouble(ending: str, text: str, came: Sequence[str]) -> Mistake | None:
    if f'{ending}{text}' in came:
        return IN_FRONT.of(ending=ending)
    return NOT_IN_IT if came and not any(text in other for other in came) else None


def _variant(*, ending: str = ENDING) -> Exercise:
    words = WORDS.of(ending=ending, within=WITHIN)
    return Exercise(
        words=words,
        clauses=(
            _AtTheEnd(
                HEARS,
                SAYS,
                STRING,
                words.clause('at-the-end'),
                answer=lambda text: f'{text}{ending}',
                mistakes=[NOTHING_ADDED],
                explain=partial(_trouble, ending),
            ),
        ),
        answer=Solution.of(words).changed((ENDING, ending)),
    )


def _guess(probe: Probe) -> dict[str, str] | None:
    node = expect.publisher(probe, SAYS).node
    text = 'My name is Ada'
    test = Stimulus(1.0, HEARS, STRING, {'data': text}, [SAYS])
    topics = {HEARS: STRING, SAYS: STRING}
    came = live(probe, topics, 3.0, stimuli=[test], nodes=[node]).on(SAYS)
    said = came[-1].message.data if came else ''
    return {'ending': said.removeprefix(text)} if said.startswith(text) else None


_GREETINGS = (
    'Good to see you',
    'How nice to be here',
    'It is a pleasure',
    'Pleased to meet you',
    'Thank you for having me',
    'What a lovely day',
)
_CITIES = (
    'Aarhus Athens Bergen Berlin Bilbao Bogota Cairo Dublin Geneva Ghent Hanoi Helsinki Jena '
    'Kyoto Leiden Lima Lisbon Lyon Malmo Nairobi Odessa Oslo Paris Perth Porto Prague Quito Riga '
    'Rome Seoul Sofia Tartu Tunis Turin Utrecht Vienna Warsaw York Zagreb'
)
_ENDINGS = [f'. {greeting} in {city}.' for greeting in _GREETINGS for city in _CITIES.split()]

exercise = varied(_variant(), _variant, _guess, ending=_ENDINGS)
