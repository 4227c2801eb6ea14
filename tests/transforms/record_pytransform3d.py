"""Write pytransform3d.json: what pytransform3d says of trees of frames that move.

It knows nothing of tf2, and so is a second witness. It needs scipy, which nothing else here does:

    pip install pytransform3d==3.17.0  # into an environment of its own
    python tests/transforms/record_pytransform3d.py
"""

from __future__ import annotations

import json
import math
import random
from pathlib import Path
from typing import Any

import numpy as np
from pytransform3d.rotations import quaternion_slerp
from pytransform3d.transform_manager import TransformManager
from pytransform3d.transformations import transform_from_pq

SECOND = 1_000_000_000
FILE = Path(__file__).with_name('pytransform3d.json')
FRAMES, CASES = 6, 40
draw = random.Random(55)


def place() -> tuple[list[float], list[float]]:
    """Return a shift, and any turn as x, y, z, w."""
    turn = [draw.gauss(0, 1) for _ in range(4)]
    length = math.hypot(*turn)
    return [draw.uniform(-5, 5) for _ in range(3)], [part / length for part in turn]


def case() -> dict[str, Any]:
    """Return a tree, a question about it, and the answer."""
    names = [f'f{number}' for number in range(FRAMES)]
    time = 10 * SECOND + draw.randrange(SECOND)
    part = time / SECOND - 10
    manager, steps = TransformManager(), []
    for number, child in enumerate(names[1:], start=1):
        parent = names[draw.randrange(number)]
        (shift, turn), (later, turned) = place(), place()
        for second, where, how in ((10, shift, turn), (11, later, turned)):
            steps.append(
                {
                    'child': child,
                    'parent': parent,
                    'time': second * SECOND,
                    'shift': where,
                    'turn': how,
                }
            )
        between = np.array(shift) + part * (np.array(later) - np.array(shift))
        w_first = [np.array([each[3], *each[:3]]) for each in (turn, turned)]
        quaternion = quaternion_slerp(*w_first, part, shortest_path=True)
        manager.add_transform(child, parent, transform_from_pq([*between, *quaternion]))
    target, source = draw.sample(names, 2)
    found = manager.get_transform(source, target)
    return {'steps': steps, 'asked': [target, source, time], 'said': found[:3].tolist()}


if __name__ == '__main__':
    lines = ',\n'.join(json.dumps(case()) for _ in range(CASES))
    FILE.write_text(f'[\n{lines}\n]\n', encoding='utf-8')
