"""Exercise: a publisher on /chatter, every 2 seconds."""

from __future__ import annotations

from labkit.exercises import Exercise, Probe, Solution
from labkit.exercises.clauses import HasText, Publishes
from labkit.exercises.variants import varied

__all__ = ['exercise']

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
    return Exercise(
        name='every_two_seconds',
        task=f'Write a node that publishes a `String` on {name} every 2 seconds.',
        clauses=(Publishes(name, 0.5, 'std_msgs/msg/String'), HasText(name)),
        hints=[
            'The class Talker is nearly what you need. Which number in it is the period?',
            'In __init__: the name of the node, create_publisher(...) and create_timer(2.0, ...). '
            'In the callback: make a message, set msg.data, publish it.',
            'self.timer = self.create_timer(2.0, self.on_timer), without brackets after on_timer; '
            'then lab.spin(SlowTalker()).',
        ],
        answer=Solution(
            __file__,
            'every_two_seconds.py',
            'The publisher is made once, in __init__, and kept in self. The timer calls on_timer '
            'every 2.0 s, and each call makes a new message.',
        ).changed(("'chatter'", f"'{topic}'")),
    )


def _guess(probe: Probe) -> dict[str, str] | None:
    names = {end.topic.removeprefix('/') for end in probe.all_publishers()}
    return next(({'topic': name} for name in (*_TOPICS, 'chatter') if name in names), None)


exercise = varied(_variant(), _variant, _guess, topic=_TOPICS)
