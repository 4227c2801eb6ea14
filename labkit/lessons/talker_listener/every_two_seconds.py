"""Exercise: a publisher on /chatter, every 2 seconds."""

from __future__ import annotations

from labkit.exercises import Exercise, Probe, Solution, words_of
from labkit.exercises.clauses import HasText, Publishes
from labkit.exercises.variants import varied

__all__ = ['exercise']

WORDS = words_of(__file__)

# Names of which none is another one with a slip of the pen.
_NAMES = (
    'anthem ballad bulletin carillon chorus diary echoes fable fanfare forecast gazette gossip '
    'greetings herald hymn journal legend letters lullaby melody memo minutes news_flash oracle '
    'poetry postcards prayer proverbs quotes radio report rhymes riddles rumours saga serenade '
    'sermon signals slogans sonnet spells tales telegram tidings verses weather whispers yodel'
)
_TOPICS = _NAMES.split()


def _variant(*, topic: str = 'chatter') -> Exercise:
    name = f'/{topic}'
    words = WORDS.of(topic=name)
    return Exercise(
        words=words,
        clauses=(Publishes(name, 0.5, 'std_msgs/msg/String'), HasText(name)),
        answer=Solution.of(words).changed(("'chatter'", f"'{topic}'")),
    )


def _guess(probe: Probe) -> dict[str, str] | None:
    names = {end.topic.removeprefix('/') for end in probe.all_publishers()}
    return next(({'topic': name} for name in (*_TOPICS, 'chatter') if name in names), None)


exercise = varied(_variant(), _variant, _guess, topic=_TOPICS)
