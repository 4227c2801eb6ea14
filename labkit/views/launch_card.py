"""A launch as the last value of a cell: what runs, exit codes, how often it was started.

IPython gets the form by name, so that the room of launches need not be loaded.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from labkit import settings
from labkit.views.card import Card

if TYPE_CHECKING:
    from labkit.launching.launched import Launch

__all__ = ['launch_card', 'register']


def register() -> None:
    """Register the form of launches with the running IPython, if there is one."""
    shell = settings.shell()
    if shell is not None:
        html = shell.display_formatter.formatters['text/html']
        html.for_type_by_name('labkit.launching.launched', 'Launch', _html)


def launch_card(launch: Launch) -> Card:
    """Return a launch as a card, as it is now."""
    rows = [(one.name, repr(one).partition(': ')[2]) for one in launch.processes]
    if launch.nodes:
        rows.append(('Nodes at the start', '\n'.join(launch.nodes)))
    state = 'It runs in the background.' if launch.running else 'It has ended.'
    return Card('info' if launch.running else 'quiet', 'LAUNCH', launch.name, state, rows)


def _html(launch: Launch) -> str:
    return launch_card(launch)._repr_html_()
