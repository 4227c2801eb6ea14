"""The panel of `lab.dock()` without a page: what it takes, and what it leaves."""

from __future__ import annotations

import pytest

SETUP = 'import labkit as lab\nfrom labkit.views import dock'
PANEL = 'print([(p.title, len(p.outputs), p.comm is not None) for p in dock._panels.values()])'


def test_views_are_under_the_cell_and_in_the_panel(kernel):
    kernel.run(SETUP)
    result = kernel.run('view = lab.arena()\nlab.dock(view, lab.teleop())')
    assert not result.error, result.error
    # Two of each view, as without it: its stored form, and its widget.
    assert len(result.outputs) == 4
    assert kernel.run(PANEL).text == "[('Robot', 2, True)]\n"
    assert kernel.run("panel = dock._panels['Robot']\nlab.dock(view)").error == ''
    assert kernel.run(PANEL).text == "[('Robot', 1, True)]\n"
    assert kernel.run('print(panel.comm)').text == 'None\n'


def test_without_views_it_takes_those_that_are_live(kernel):
    kernel.run(f'{SETUP}\nlab.arena()')
    kernel.run('display(lab.arena(), lab.teleop())')
    result = kernel.run('lab.dock()')
    assert (result.error, result.outputs) == ('', [])
    assert kernel.run(PANEL).text.startswith("[('Robot', ")


@pytest.mark.parametrize(
    ('code', 'words'),
    [
        ('lab.dock()', 'lab.dock() has found no live view in this notebook.'),
        ('lab.dock(3)', 'lab.dock takes live views, and got 3.'),
        ("lab.dock(lab.arena(), 'x' * 10_000)", 'lab.dock takes live views, and got '),
    ],
)
def test_what_is_no_view_is_refused(kernel, code, words):
    kernel.run(SETUP)
    error = kernel.run(code).error
    assert words in error
    assert 'lab.dock(lab.arena(), lab.teleop())' in error
    assert len(error) < 1500


def test_headless_it_shows_the_stills_and_no_panel(start_kernel):
    kernel = start_kernel(LABKIT_HEADLESS='1')
    kernel.run(f'{SETUP}\nrobot = lab.spin(lab.Turtlebot(lockstep=0.1))')
    shown = kernel.run('display(lab.arena(), lab.teleop())')
    docked = kernel.run('lab.dock(lab.arena(), lab.teleop())')
    data = [[output['data'] for output in result.outputs] for result in (shown, docked)]
    assert data[0] == data[1] and len(data[0]) == 2
    assert kernel.run(PANEL).text == '[]\n'
