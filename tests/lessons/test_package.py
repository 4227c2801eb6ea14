"""Lesson 11: its workspace is a folder of its own, and goes with the process."""

from __future__ import annotations

from pathlib import Path

WORKSPACE = """
from labkit.lessons.package.made import make_broken
from labkit.lessons.package.workspace import make_workspace, workspace

assert workspace() is None
made = make_workspace()
assert made == make_workspace() == workspace(), 'another one'
setup = make_broken()
text = setup.read_text()
setup.write_text('')
assert make_broken().read_text() == text, 'not made anew'
print(made, text.count(',\\n'), setup.is_relative_to(made))
"""


def test_the_workspace_is_made_once_and_goes_with_the_process(script, tmp_path):
    place = tmp_path / 'temporary'
    place.mkdir()
    result = script(WORKSPACE, TMPDIR=str(place))
    assert result.exit_code == 0, result.stderr
    made, _, inside = result.stdout.split()
    assert Path(made).name == 'ros2_ws' and inside == 'True'
    assert Path(made).is_relative_to(place) and list(place.iterdir()) == []


def test_what_is_recorded_has_a_workspace_that_is_always_called_the_same(script, tmp_path):
    code = 'from labkit.lessons.package.workspace import make_workspace\nprint(make_workspace())\n'
    result = script(code, TMPDIR=str(tmp_path), LABKIT_HEADLESS='1')
    assert result.stdout == f'{tmp_path}/ros2_ws\n', result.stderr
