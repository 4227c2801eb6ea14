"""Exercise: hear a sensor that promises no more than best effort."""

from __future__ import annotations

from labkit.exercises import Exercise, Mistake, Solution
from labkit.exercises.clauses import WITHIN, Answers, Matches, in_words
from labkit.exercises.draws import draw_int16s

__all__ = ['SONAR', 'millimetres']

INT16 = 'std_msgs/msg/Int16'
SONAR = '/sonar'
# Millimetres in a centimetre.
TIMES = 10


MISTAKES = (
    Mistake(
        'millimetres/passed-on',
        'The number is passed on as it came.',
        'Publish Int16(data=10 * msg.data).',
        model=int,
        change=[('10 * msg.data', 'msg.data')],
    ),
    Mistake(
        'millimetres/divided',
        'The number is divided by 10, and not multiplied.',
        '1 cm is 10 mm.',
        model=lambda number: number // 10,
        change=[('10 * msg.data', 'msg.data // 10')],
    ),
)

millimetres = Exercise(
    name='millimetres',
    task='Hear /sonar, which publishes centimetres on /range, and publish millimetres on '
    '/range_mm.',
    clauses=(
        Answers(
            '/range',
            '/range_mm',
            INT16,
            f'for each number on `/range`, publish {in_words(TIMES)} times that number on '
            f'`/range_mm` (both `{INT16}`), once, {WITHIN}',
            answer=lambda number: TIMES * number,
            draw=lambda: draw_int16s(0, 3276),
            mistakes=MISTAKES,
        ),
        Matches(
            '/range',
            SONAR,
            'the node hears `/sonar`, which stays as it is',
            start='Run the cell that starts the sonar.',
            is_as_given=lambda profile: profile.reliability.name == 'BEST_EFFORT',
        ),
    ),
    hints=[
        'What does /sonar offer, and what does a subscription with a depth alone ask for? '
        '%ros2 topic info --verbose /range',
        'A subscription that asks for best effort hears every publisher of its type.',
        'qos_profile_sensor_data, from rclpy.qos, is the last argument of create_subscription().',
    ],
    answer=Solution(
        __file__,
        'millimetres.py',
        'The subscription asks for no more than the sensor offers. So it hears a reliable '
        'publisher, too.',
    ),
)
