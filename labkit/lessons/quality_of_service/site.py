"""Exercise: keep the newest message for subscriptions that come later."""

from __future__ import annotations

from labkit.exercises import Exercise, Mistake, Solution, anything
from labkit.exercises.clauses import WITHIN, Answers, Latched

__all__ = ['exercise']

STRING = 'std_msgs/msg/String'


MORE = Mistake(
    'site/more',
    'What is published is not the name alone, as it came.',
    'Publish the message as it came: self.publisher.publish(msg)',
    model=anything,
    change=[('publish(msg)', "publish(String(data=f'site {msg.data}'))")],
)

exercise = Exercise(
    name='site',
    task='Publish each name that comes on /move on /site, and keep the newest one for who '
    'subscribes later.',
    clauses=(
        Answers(
            '/move',
            '/site',
            STRING,
            f'for each name on `/move`, publish that name on `/site` (both `{STRING}`), once, '
            f'{WITHIN}',
            answer=str,
            mistakes=[MORE],
        ),
        Latched(
            '/site',
            'a later subscriber to `/site` that asks for transient local receives the newest name '
            'at once, and no older one',
        ),
    ),
    hints=[
        'Which policy lets a publisher keep what it has said?',
        'The durability is transient local. How many messages are kept is the depth.',
        'QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL) is the last argument of '
        'create_publisher().',
    ],
    answer=Solution(
        __file__,
        'site.py',
        'The publisher keeps one message, the newest. So it publishes when something has changed, '
        'and needs no timer that repeats it for late ones.',
    ),
)
