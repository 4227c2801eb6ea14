"""A check of a launch file starts nothing where a node that it is to start is there already."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest
from rclpy.node import Node

import labkit
from labkit.exercises import Fail, NotAttempted, Probe
from labkit.launching.launched import Launch
from labkit.lessons.names_and_launch.learner_launch import Launched
from labkit.lessons.names_and_launch.system import exercise
from labkit.programs.child_processes import processes

LAUNCH = """<launch>
  <node pkg="demo_nodes_py" exec="talker" name="driver" namespace="robot1"/>
</launch>
"""


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    monkeypatch.setenv('LABKIT_HOME', str(tmp_path))
    labkit.start()
    yield labkit
    labkit.stop()


def test_a_node_that_runs_already_is_refused_before_anything_is_launched(
    lab: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / 'system.launch.xml'
    path.write_text(LAUNCH)
    monkeypatch.setattr(Launched, '_path', lambda self: path)
    lab.spin(Node('driver', namespace='robot1'))
    before = len(processes())
    with (
        Probe('system') as probe,
        pytest.raises(Fail, match='/robot1/driver is running already'),
        exercise.stage.scenes(probe, exercise.clauses) as scenes,
    ):
        next(iter(scenes))
    assert len(processes()) == before


def test_a_node_that_is_late_is_not_told_as_missing(
    lab: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / 'system.launch.xml'
    path.write_text(LAUNCH)
    monkeypatch.setattr(Launched, '_path', lambda self: path)
    # As if the time for it were over.
    monkeypatch.setattr(Launch, 'wait_for_nodes', lambda *_: False)
    with (
        Probe('system') as probe,
        pytest.raises(NotAttempted, match='Too early to tell: talker-1 was started'),
        exercise.stage.scenes(probe, exercise.clauses) as scenes,
    ):
        next(iter(scenes))
