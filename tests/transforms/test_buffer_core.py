"""The buffer answers as the real tf2: values to 1e-9, times, and errors word by word.

What the real one says is in real.json; record_real.py has made it, and tells how. What a library
says that knows nothing of tf2 is in pytransform3d.json, made by record_pytransform3d.py.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from rclpy.duration import Duration
from transforms.replay import ask, make_buffer, put

import labkit.transforms.buffer_core as ours
from labkit.transforms import exceptions
from labkit.transforms.rotations import matrix

HERE = Path(__file__).parent
STORIES = json.loads((HERE / 'real.json').read_text(encoding='utf-8'))
SECOND_WITNESS = json.loads((HERE / 'pytransform3d.json').read_text(encoding='utf-8'))


class Module:
    """What `tf2_py` has."""

    BufferCore = ours.BufferCore
    TransformException = exceptions.TransformException


def near(said: Any) -> Any:
    """Return an answer that is equal to those whose numbers differ by 1e-9 at most."""
    if isinstance(said, dict) and 'shift' in said:
        numbers = {key: pytest.approx(said[key], abs=1e-9, rel=1e-9) for key in ('shift', 'turn')}
        return {**said, **numbers}
    return said


@pytest.mark.parametrize('story', STORIES, ids=lambda story: story['name'])
def test_it_answers_as_the_real_one(story):
    buffer = make_buffer(Module, story['cache_time'])
    for number, step in enumerate(story['steps']):
        if 'call' not in step:
            put(buffer, step)
            continue
        answer = ask(Module, buffer, step['call'], step['asked'])
        assert answer == near(step['said']), f'step {number}: {step["call"]}{step["asked"]}'


@pytest.mark.parametrize('case', SECOND_WITNESS, ids=lambda case: '-'.join(case['asked'][:2]))
def test_it_answers_as_pytransform3d(case):
    buffer = make_buffer(Module, None)
    for step in case['steps']:
        put(buffer, step)
    answer = ask(Module, buffer, 'lookup_transform_core', case['asked'])
    turned = [list(row) for row in matrix(tuple(answer['turn']))]
    found = [[*row, shift] for row, shift in zip(turned, answer['shift'], strict=True)]
    assert found == [pytest.approx(row, abs=1e-9) for row in case['said']]


def test_there_are_many_cases_of_all_kinds():
    steps = [step for story in STORIES for step in story['steps'] if 'call' in step]
    assert len(steps) >= 200
    errors = {step['said']['error'] for step in steps if 'error' in str(step['said'])}
    kinds = 'Lookup', 'Connectivity', 'Extrapolation', 'InvalidArgument', 'Transform'
    assert errors == {f'{kind}Exception' for kind in kinds}


def test_what_is_no_time_is_said_as_the_real_one_does():
    buffer = ours.BufferCore()
    for call in (
        lambda: buffer.lookup_transform_core('a', 'b', 1.5),
        lambda: buffer.can_transform_core('a', 'b', None),
    ):
        with pytest.raises(TypeError, match='time must have sec and nanosec'):
            call()
    no_duration: Any = 10.0
    with pytest.raises(TypeError, match='duration must have sec and nanosec'):
        ours.BufferCore(no_duration)
    assert ours.BufferCore(Duration(seconds=1).to_msg()).all_frames_as_yaml() == '[]'


# What the real one has logged for the steps of the story 'refused', and for an old transform.
LOGGED = """
TF_SELF_TRANSFORM: Ignoring transform from authority "the test" with frame_id and  child_frame_id \
"a" because they are the same
TF_NO_CHILD_FRAME_ID: Ignoring transform from authority "the test" because child_frame_id not set \

TF_NO_FRAME_ID: Ignoring transform with child_frame_id "a"  from authority "the test" because \
frame_id not set
TF_NO_CHILD_FRAME_ID: Ignoring transform from authority "the test" because child_frame_id not set \

TF_NAN_INPUT: Ignoring transform for child_frame_id "a" from authority "the test" because of a \
nan value in the transform (nan 0.000000 0.000000)
TF_NAN_INPUT: Ignoring transform for child_frame_id "a" from authority "the test" because of a \
nan value in the transform
TF_DENORMALIZED_QUATERNION: Ignoring transform for child_frame_id "a" from authority "the test" \
because of an invalid quaternion in the transform (nan nan nan nan)
TF_OLD_DATA ignoring data from the past for frame base at time 100.000000 according to authority \
the test
Possible reasons are listed at http://wiki.ros.org/tf/Errors%20explained
"""


def test_what_it_ignores_is_logged_in_the_words_of_the_real_one(capfd):
    for name in ('refused', 'forgetting'):
        buffer = ours.BufferCore()
        (story,) = (story for story in STORIES if story['name'] == name)
        for step in story['steps']:
            if 'call' not in step:
                put(buffer, step)
    logged = capfd.readouterr().err.replace('] [tf2]: ', '\n')
    for words in LOGGED.replace('\\\n', '').strip('\n').split('\n'):
        assert words in logged
    assert logged.count('TF_') == 12
