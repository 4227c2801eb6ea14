"""Each learner's own numbers: the own answer passes, and a neighbour's is told to be one."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing, suppress
from pathlib import Path
from types import ModuleType

import psutil
import pytest
from proof import lessons

import labkit
from labkit import settings
from labkit.background.domains import claim_domain
from labkit.background.nodes import existing_nodes
from labkit.background.runtime import runtime
from labkit.exercises import Exercise, Outcome
from labkit.exercises.variants import ANOTHER, Variants
from labkit.sim.turtlebot import Turtlebot

VARIED = {
    f'{lesson.name}-{exercise.name}': exercise
    for lesson in lessons()
    for exercise in lesson.exercises
    if exercise.variants is not None
}
# All 200 take a quarter of an hour: LABKIT_SEEDS=200.
SEEDS = [f'learner {number}' for number in range(200)]
CHOSEN = SEEDS[: int(os.environ.get('LABKIT_SEEDS', '3'))]


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    monkeypatch.setenv('LABKIT_HOME', str(tmp_path))
    monkeypatch.chdir(tmp_path)
    # Programs in terminals find the nodes of this process, and nobody else's.
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    with closing(claim_domain()) as claim:
        monkeypatch.setenv('ROS_DOMAIN_ID', str(claim.domain_id))
        labkit.start(domain_id=claim.domain_id)
        yield labkit
        end_programs()
        labkit.stop()
    settings.after_start.clear()


def variants_of(name: str) -> Variants:
    variants = VARIED[name].variants
    assert variants is not None
    return variants


def run(lab: ModuleType, code: str) -> None:
    """Run an answer as a cell does, without anything of the one before but the robot."""
    for node in list(existing_nodes()):
        if node is not runtime.helper and not isinstance(node, Turtlebot):
            lab.remove(node)
    end_programs()
    if code.startswith('%%bash\n'):
        path = f'{Path(sys.executable).parent}{os.pathsep}{os.environ["PATH"]}'
        script = code.partition('\n')[2]
        subprocess.run(['bash', '-c', script], env={**os.environ, 'PATH': path}, check=True)
    else:
        exec(compile(code, '<cell>', 'exec'), {'lab': lab})


def end_programs() -> None:
    """End the programs in terminals, which were started in this folder."""
    mine = []
    for each in psutil.process_iter():
        with suppress(psutil.Error):
            if each.pid != os.getpid() and Path(each.cwd()) == Path.cwd():
                mine.append(each)
                each.kill()
    psutil.wait_procs(mine)


def neighbour(variants: Variants, seed: str) -> Exercise:
    """Return the exercise of the next one in the class who has another one."""
    mine = variants.of(seed)
    others = SEEDS[SEEDS.index(seed) + 1 :] + SEEDS
    return next(other for other in map(variants.of, others) if other.task != mine.task)


@pytest.mark.slow('each exercise with numbers of its own')
@pytest.mark.parametrize('seed', CHOSEN)
@pytest.mark.parametrize('name', VARIED)
def test_own_answer_passes_and_a_neighbours_is_told(lab: ModuleType, name: str, seed: str) -> None:
    variants = variants_of(name)
    mine = variants.of(seed)
    if name.startswith('turtlebot-'):
        lab.spin(lab.Turtlebot())
    run(lab, mine.answer.code)
    verdict = mine.check()
    assert verdict.outcome is Outcome.PASS, verdict
    other = neighbour(variants, seed)
    run(lab, other.answer.code)
    mine = variants.of(seed)
    told = mine.check()
    assert told.outcome is Outcome.FAIL and ANOTHER in told.why, told
    assert (told.expected, told.seen) == (mine.task, other.task)
    # Pressed again.
    again = mine.check()
    assert again.outcome is Outcome.FAIL and ANOTHER in again.why, again
