"""The questions on the harbour: what the commands say is what is right."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator

import pytest

from labkit.background import domains

# Asks as a learner does, answers, and prints what came of each answer.
SCRIPT = """
import contextlib, io, json, re
import labkit as lab
from labkit.lessons.command_line.harbour import MEASURES, open_harbour
from labkit.ros2.shell import run_line

quiz = lab.lesson('command_line').quiz('harbour')
try:
    quiz.answer(1, '/pier_east')
except lab.LabError as error:
    closed = str(error)

def ask(line, pattern=r'(.*)'):
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        run_line(line)
    return re.search(pattern, out.getvalue())[1]

def answer(number, given):
    return repr(quiz.answer(number, given))

open_harbour()
tide = ask('topic info -v /tide', r'Node name: (\\w+)')
other = next(name for name in ('pier_east', 'pier_north') if name != tide)
water = ask('topic type /water')
field = ask('topic echo --once /water', r'(\\w+): 12.5')
hz = float(ask('topic hz --count 3 /beacon', r'(?s).*average rate: ([0-9.]+)'))
boats = int(ask('topic info /radio', r'Subscription count: (\\d+)'))
range_km = int(ask('param get /lighthouse range_km', r'value is: (\\d+)'))
height_m = int(ask('param get /lighthouse height_m', r'value is: (\\d+)'))
reliability = ask('topic info -v /camera', r'Reliability: (\\w+)')
foghorn = ask('service type /foghorn')
opposite = {'RELIABLE': 'BEST_EFFORT', 'BEST_EFFORT': 'RELIABLE'}[reliability]

right = [(1, tide), (1, f'/{tide}'), (1, f'Node name: {tide}.'), (2, water),
         (2, water.replace('/msg', '')), (3, field), (3, f'{field}: 12.5'), (4, round(hz)),
         (4, f'{round(hz)},0 Hz'), (5, boats), (5, f' {boats} subscriptions'), (6, range_km),
         (6, f'{range_km} km'), (7, reliability), (7, reliability.lower().replace('_', ' ')),
         (7, reliability.title()), (8, foghorn), (8, foghorn.replace('/srv', ''))]
wrong = [
    (1, f'/{other}', 'does not publish on /tide'),
    (1, '/wind', 'is a topic'),
    (1, f'/{tide}'.title(), 'Capital and small letters'),
    (2, water.rsplit('/')[-1], 'Its name has three parts'),
    (2, water.replace('/', '.'), 'So it is called in a program.'),
    (2, water.replace('/msg/', '/srv/'), 'The word in the middle says what it is: msg.'),
    (2, water.lower(), 'Capital and small letters'),
    (2, 'sensor_msgs/Imu', 'copy what it says'),
    (2, 'std_msgs/String', 'type of the messages on /radio'),
    (3, field[:-1], 'letter by letter'),
    (3, field.title(), 'Capital and small letters' if '_' in field else 'That is '),
    (2, 'std_msgs/msg/String', 'type of the messages on /radio'),
    (3, 'data', 'The types of std_msgs have'),
    (3, water, 'That is the type.'),
    (3, next(f for f in MEASURES.values() if f != field), 'a field of another type'),
    (4, 1 / hz, 'Divide 1 by it'),
    (4, 77, 'topic hz --count 2'),
    (5, 1, 'That is the number of publishers'),
    (5, 4, 'not all of them listen'),
    (6, height_m, 'That is height_m.'),
    (7, 'VOLATILE', 'That is the durability.'),
    (7, opposite, 'It is the other one.'),
    (7, 'Volatile', 'That is the durability.'),
    (7, 'fast', 'It is one of two words'),
    (8, foghorn.rsplit('/')[-1], 'the word srv'),
    (8, foghorn.replace('/srv/', '/msg/'), 'The word in the middle says what it is: srv.'),
]
rights = [[w[:2], answer(*w)] for w in right]
wrongs = [[list(w), answer(*w[:2])] for w in wrong]
lab.stop()  # the harbour goes on
rights += [[['again', *w[:2]], answer(*w)] for w in right[::3]]
print(json.dumps([closed, rights, wrongs]))
lab.processes().stop()
"""


@pytest.fixture
def domain_id() -> Iterator[int]:
    claim = domains.claim_domain()
    yield claim.domain_id
    claim.close()


@pytest.mark.slow('a whole lesson')
def test_commands_answer_the_questions_on_the_harbour(
    domain_id: int, lab_env: dict[str, str]
) -> None:
    env = {
        **lab_env,
        'ROS_DOMAIN_ID': str(domain_id),
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
    }
    done = subprocess.run(
        [sys.executable, '-c', SCRIPT], env=env, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr
    closed, right, wrong = json.loads(done.stdout.splitlines()[-1])
    assert closed.startswith('The harbour is closed.')
    for given, text in right:
        assert text.startswith('RIGHT'), (given, text)
    for (number, answer, sentence), text in wrong:
        assert text.startswith('NOT YET'), (number, answer, text)
        assert sentence in ' '.join(text.split()), (number, answer, text)
