"""Write real.json, real_messages.json, real_clouds.json: what the real packages say.

They have to be on the path:

    PYTHONPATH=FOLDER:tests:labkit/packages/stand_ins python tests/transforms/record_real.py

Those in the repository were made with ros2/geometry2, branch jazzy, commit 646342c (2024-10-04):
tf2/src and tf2_py/src/tf2_py.cpp compiled as one library for Python, tf2_ros_py/tf2_ros and
tf2_geometry_msgs/src as they are, tf2_sensor_msgs too; ros-perception/laser_geometry, branch
rolling, commit 7688a58; ros2/common_interfaces, branch jazzy, commit 5283bd9.
"""

from __future__ import annotations

import itertools
import json
import math
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import laser_geometry
import tf2_geometry_msgs
import tf2_py
import tf2_sensor_msgs
from sensor_msgs_py import point_cloud2
from transforms import clouds
from transforms.replay import KINDS, ask, make_buffer, put, transformed

SECOND = 1_000_000_000
FILE = Path(__file__).with_name('real.json')
MESSAGES = Path(__file__).with_name('real_messages.json')
CLOUDS = Path(__file__).with_name('real_clouds.json')
Step = dict[str, Any]
draw = random.Random(54)


def turn(
    axis: tuple[float, float, float] | None = None, angle: float | None = None
) -> list[float]:
    """Return a quaternion: about an axis, or any."""
    if axis is None:
        axis = (draw.gauss(0, 1), draw.gauss(0, 1), draw.gauss(0, 1))
    if angle is None:
        angle = draw.uniform(-math.pi, math.pi)
    length = math.hypot(*axis)
    return [*(math.sin(angle / 2) * part / length for part in axis), math.cos(angle / 2)]


def at(child: str, parent: str, time: float, **more: Any) -> Step:
    """Return a step that says where a frame is at a time, s."""
    step = {
        'child': child,
        'parent': parent,
        'time': round(time * SECOND),
        'shift': [draw.uniform(-5, 5) for _ in range(3)],
        'turn': turn(),
    }
    return {**step, **more}


def look(target: str, source: str, time: float = 0) -> list[Step]:
    """Return the two questions for a transform at a time, s."""
    asked = [target, source, round(time * SECOND)]
    return [{'call': f'{verb}_transform_core', 'asked': asked} for verb in ('lookup', 'can')]


def look_full(target: str, end: float, source: str, start: float, fixed: str) -> list[Step]:
    """Return the two questions for a transform between two times, s."""
    asked = [target, round(end * SECOND), source, round(start * SECOND), fixed]
    return [{'call': f'{verb}_transform_full_core', 'asked': asked} for verb in ('lookup', 'can')]


def common(target: str, source: str) -> Step:
    return {'call': 'get_latest_common_time', 'asked': [target, source]}


ALL: list[Step] = [
    {'call': f'all_frames_as_{form}', 'asked': []} for form in ('yaml', 'string')
] + [{'call': '_getFrameStrings', 'asked': []}]


def chain() -> Iterator[Step]:
    frames = ['odom', 'base', 'arm', 'hand', 'tool']
    yield from ALL
    for time in (100.0, 100.5, 101.25, 103.0):
        for parent, child in itertools.pairwise(frames):
            yield at(child, parent, time + 0.01 * frames.index(child))
    for target, source in itertools.permutations(frames, 2):
        for time in (0, 100.7, 101.29):
            yield from look(target, source, time)[:1]
    for time in (99.0, 100.01, 100.04, 102.99999, 103.01, 103.02, 104):
        yield from look('odom', 'tool', time)
        yield from look('tool', 'odom', time)
    yield from (common('odom', 'tool'), common('arm', 'base'), common('tool', 'tool'))
    yield from ALL


def branches() -> Iterator[Step]:
    yield at('base', 'odom', 10.0)
    yield at('base', 'odom', 12.0)
    yield at('scan', 'base', 0, static=True)
    yield at('camera', 'base', 5, static=True)
    yield at('optical', 'camera', 0, static=True, turn=[-0.5, 0.5, -0.5, 0.5])
    yield at('left', 'base', 11.0)
    yield at('left', 'base', 11.5)
    frames = ['odom', 'base', 'scan', 'camera', 'optical', 'left']
    for target, source in itertools.permutations(frames, 2):
        yield from look(target, source)
        yield from look(target, source, 11.25)[:1]
        yield common(target, source)
    for time in (9.0, 11.75, 12.5):
        yield from look('optical', 'left', time)
        yield from look('scan', 'optical', time)
        yield from look('odom', 'scan', time)
        yield from look('scan', 'odom', time)
    yield from ALL


def forgetting() -> Iterator[Step]:
    for time in range(26):
        yield at('base', 'odom', 100 + time)
        if time % 5 == 0:
            yield from look('odom', 'base', 101.5)
            yield from ALL[:1]
    for time in (114, 114.5, 115, 115.5, 125, 125.5):
        yield from look('odom', 'base', time)
    yield at('base', 'odom', 100)
    yield from look('odom', 'base', 100)
    yield at('base', 'odom', 115.25)
    yield from look('odom', 'base', 115.3)
    yield from ALL


def short_memory() -> Iterator[Step]:
    for time in (1, 2, 3, 3.5, 6):
        yield at('base', 'odom', time)
        yield from look('odom', 'base', 2.5)
    yield from ALL


def cut() -> Iterator[Step]:
    yield at('base', 'odom', 1)
    yield at('base', 'odom', 2)
    yield at('gripper', 'arm', 1)
    yield at('gripper', 'arm', 2)
    for time in (0, 1.5, 3):
        for pair in (('odom', 'gripper'), ('gripper', 'odom'), ('arm', 'odom'), ('base', 'arm')):
            yield from look(*pair, time)
    yield from (common('odom', 'gripper'), common('odom', 'nowhere'), common('', 'odom'))
    yield at('arm', 'base', 2, static=True)
    yield from look('odom', 'gripper', 1.5)
    yield from ALL


def other_parent() -> Iterator[Step]:
    yield at('cup', 'table', 1)
    yield at('table', 'room', 0, static=True)
    yield at('hand', 'room', 0, static=True)
    yield at('cup', 'table', 2)
    yield at('cup', 'hand', 3)
    yield at('cup', 'hand', 4)
    for time in (1, 1.5, 2, 2.5, 3, 3.5, 4, 0):
        yield from look('room', 'cup', time)
        yield from look('cup', 'table', time)[:1]
    yield from ALL


def names() -> Iterator[Step]:
    yield at('/base', '/odom', 1)
    yield at('/base', 'odom', 2)
    yield at('//twice', 'odom', 2)
    good, bad = ['odom', 'base'], ['/odom', '', 'bse', '/twice', '//twice', 'NO_PARENT']
    for one in good:
        for other in bad:
            yield from look(one, other)
            yield from look(other, one)
    yield from look_full('odom', 1, 'base', 1, 'nowhere')
    yield from look_full('odom', 1, '', 1, 'odom')
    yield from look_full('/odom', 1, 'base', 1, 'odom')
    yield from (common('/odom', 'base'), common('base', 'none'))
    yield from ({'call': '_frameExists', 'asked': [one]} for one in ('odom', '/odom', 'none'))
    yield from ALL


def refused() -> Iterator[Step]:
    nan, inf = math.nan, math.inf
    yield at('a', 'a', 1)
    yield at('', 'a', 1)
    yield at('a', '', 1)
    yield at('/', 'b', 1)
    yield at('a', 'b', 1, shift=[nan, 0, 0])
    yield at('a', 'b', 1, turn=[0, nan, 0, 1])
    yield at('a', 'b', 1, turn=[0, 0, 0, 0])
    yield at('a', 'b', 1, turn=[inf, 0, 0, 1])
    yield from ALL
    yield from look('a', 'b')


def lengths() -> Iterator[Step]:
    for number, q in enumerate(
        ([0, 0, 0, 2], [0, 0, 1, 1], [1e-3, 0, 0, 1e-3], [3, -4, 1, -2], [0, 0, 0, -1])
    ):
        yield at(f'f{number}', 'root', 1, turn=q)
        yield from look('root', f'f{number}')
        yield from look(f'f{number}', 'root')
    yield at('infinite', 'root', 1, shift=[math.inf, 0, 0], turn=[0, 0, 0, 1])
    yield from look('root', 'infinite')[1:]


def same() -> Iterator[Step]:
    yield at('base', 'odom', 7.5)
    yield at('fixed', 'odom', 3, static=True)
    for frame in ('base', 'odom', 'fixed', 'unknown', '', '/base'):
        yield from look(frame, frame)
        yield from look(frame, frame, 2.5)
    yield from look_full('base', 7.5, 'base', 7.5, 'odom')
    yield from look_full('odom', 1, 'odom', 2, 'odom')
    yield from (common('base', 'base'), common('odom', 'odom'))


def loop() -> Iterator[Step]:
    yield at('b', 'a', 1)
    yield at('a', 'b', 1)
    yield at('c', 'd', 1)
    yield from look('a', 'b')
    yield from look('c', 'b')
    yield from look('c', 'b', 1)
    yield from look('a', 'c', 1)


def repeated() -> Iterator[Step]:
    yield at('b', 'a', 2, shift=[2, 0, 0])
    yield at('b', 'a', 1, shift=[1, 0, 0], turn=[0, 0, 0, 1])
    yield at('b', 'a', 1, shift=[1, 0, 0], turn=[0, 0, 0, 1])
    yield at('b', 'a', 1, shift=[-1, 0, 0])
    yield at('b', 'a', 1.5, shift=[5, 0, 0])
    yield at('b', 'a', 1.5, shift=[6, 0, 0])
    yield at('b', 'a', 2, shift=[7, 0, 0])
    for time in (1, 1.25, 1.5, 1.75, 2, 0):
        yield from look('a', 'b', time)[:1]
    yield from ALL


def kinds() -> Iterator[Step]:
    yield at('b', 'a', 1)
    yield at('b', 'a', 2, static=True)
    yield from look('a', 'b', 50)
    yield from ALL
    yield at('b', 'a', 3)
    yield from look('a', 'b', 50)
    yield from look('a', 'b', 3)
    yield from ALL


def between_times() -> Iterator[Step]:
    for time in (1, 2, 3, 4):
        yield at('turtle1', 'world', time)
        yield at('turtle2', 'world', time + 0.25)
        yield at('eye', 'turtle1', time, turn=[0.5, -0.5, 0.5, 0.5])
    frames = ['world', 'turtle1', 'turtle2', 'eye']
    for target, source in itertools.product(frames, repeat=2):
        yield from look_full(target, 3.5, source, 1.5, 'world')[:1]
        yield from look_full(target, 0, source, 2.125, 'turtle1')
    yield from look_full('turtle2', 0.5, 'turtle1', 1.5, 'world')
    yield from look_full('turtle2', 1.5, 'turtle1', 9.5, 'world')


def half_turns() -> Iterator[Step]:
    axes = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 1, 1), (-1, 2, 0.5)]
    for number, axis in enumerate(axes):
        for angle in (math.pi, -math.pi, 2 * math.pi / 3, -2 * math.pi / 3, math.pi / 2, 1e-9):
            name = f'f{number}_{angle:.3f}'
            yield at(name, 'root', 1, turn=turn(axis, angle))
            yield from look('root', name)[:1]
            yield from look(name, 'root')[:1]


def turning() -> Iterator[Step]:
    pairs = [(0.0, 3.0), (-3.0, 3.0), (0.1, 0.1), (0.1, 0.1 + 1e-9), (0.0, 1e-12), (0.0, math.pi)]
    for number, (first, second) in enumerate(pairs):
        name = f'f{number}'
        yield at(name, 'root', 1, turn=turn((0, 0, 1), first))
        yield at(name, 'root', 2, turn=turn((0, 0, 1), second))
        for time in (1.0, 1.25, 1.999999999):
            yield from look('root', name, time)[:1]
    yield at('any', 'root', 1)
    yield at('any', 'root', 2)
    for tenth in range(1, 10):
        yield from look('root', 'any', 1 + tenth / 10)[:1]


def cleared() -> Iterator[Step]:
    yield at('base', 'odom', 1)
    yield at('base', 'odom', 2)
    yield at('scan', 'base', 1, static=True)
    yield {'clear': True}
    for time in (0, 1.5):
        yield from look('odom', 'base', time)
        yield from look('base', 'odom', time)
        yield from look('base', 'scan', time)
        yield from look('odom', 'scan', time)
        yield from look('scan', 'odom', time)
    yield from ALL
    yield at('base', 'odom', 1)
    yield from look('odom', 'scan')


def today() -> Iterator[Step]:
    for step in range(4):
        yield at('base', 'odom', 1_790_000_000 + step / 30)
    yield at('later', 'odom', 0)
    for time in (1_790_000_000 + 1 / 60, 1_790_000_000.099999, 1_790_000_000.2, 1.0):
        yield from look('odom', 'base', time)
    yield from look('later', 'base')
    yield from ALL


def messages() -> Iterator[dict[str, Any]]:
    turns = [turn() for _ in range(6)]
    turns += [[0, 0, 0, 1], [0, 0, 0, 0], [2, -1, 0.5, 3], [0.5, 0.5, 0.5, 0.5], [0, 0, 1, 1e-3]]
    for kind, length in KINDS.items():
        for number, one in enumerate(turns):
            given = [draw.uniform(-5, 5) for _ in range(length)]
            if kind.startswith('pose'):
                given[3:7] = turns[-number - 1]
            shift = [draw.uniform(-5, 5) for _ in range(3)]
            yield {'kind': kind, 'shift': shift, 'turn': one, 'given': given}


def main() -> None:
    makers = [
        *(chain, branches, forgetting, short_memory, cut, other_parent, names, refused, lengths),
        *(same, loop, repeated, kinds, between_times, half_turns, turning, cleared, today),
    ]
    stories, cases = [], 0
    for maker in makers:
        cache_time = 2 * SECOND if maker is short_memory else None
        buffer = make_buffer(tf2_py, cache_time)
        steps = []
        for step in maker():
            if 'call' in step:
                step = {**step, 'said': ask(tf2_py, buffer, step['call'], step['asked'])}
                cases += 1
            else:
                put(buffer, step)
            steps.append(step)
        name = maker.__name__.replace('_', ' ')
        stories.append({'name': name, 'cache_time': cache_time, 'steps': steps})
    FILE.write_text(
        '[\n' + ',\n'.join(_in_lines(one, 'steps') for one in stories) + '\n]\n', encoding='utf-8'
    )
    print(f'{cases} questions in {len(stories)} stories, asked of {tf2_py.__file__}')
    found = [{**one, 'said': transformed(tf2_geometry_msgs, one)} for one in messages()]
    MESSAGES.write_text('[\n' + ',\n'.join(map(json.dumps, found)) + '\n]\n', encoding='utf-8')
    print(f'{len(found)} messages')
    made = [clouds.cloud_of(laser_geometry, case) for case in clouds.CASES]
    said = [clouds.told(one, point_cloud2, tf2_sensor_msgs) for one in made]
    CLOUDS.write_text('[\n' + ',\n'.join(map(json.dumps, said)) + '\n]\n', encoding='utf-8')
    print(f'{len(said)} clouds')


def _in_lines(story: dict[str, Any], key: str) -> str:
    head = json.dumps({name: value for name, value in story.items() if name != key})
    return f'{head[:-1]}, "{key}": [\n' + ',\n'.join(map(json.dumps, story[key])) + '\n]}'


if __name__ == '__main__':
    main()
