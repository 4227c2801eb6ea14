"""A node as the last value of a cell: its name, and what it publishes, subscribes to and offers.

rclpy's `Node` has no form to be shown in. IPython is told one for it by name, so that rclpy need
not be loaded; it is used while the notebook-safe functions are in place, and else the node is
shown as Python shows it.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from labkit.views.card import Card

if TYPE_CHECKING:
    from rclpy.node import Node

    from labkit.rosgraph.listings import NamesAndTypes

__all__ = ['node_card', 'register']


def register() -> None:
    """Let the running IPython show nodes as cards; without one nothing happens."""
    ipython = sys.modules.get('IPython')
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is None:
        return
    formatters = shell.display_formatter.formatters
    formatters['text/plain'].for_type_by_name('rclpy.node', 'Node', _text)
    formatters['text/html'].for_type_by_name('rclpy.node', 'Node', _html)


def node_card(node: Node) -> Card:
    """Return the card of a node: what it is asked for by `ros2 node info`, in short."""
    from labkit.background.nodes import full_name
    from labkit.background.runtime import runtime
    from labkit.rosgraph.listings import ends_of_node

    name = full_name(node)
    if not name:
        return Card('quiet', 'NODE', type(node).__name__, text='It has ended.')
    ends = ends_of_node(node, name)
    rows = [
        ('Publishes', _lines(ends.publishers)),
        ('Subscribes', _lines(ends.subscribers)),
        ('Serves', _lines(ends.service_servers, name)),
        ('Calls', _lines(ends.service_clients)),
        ('Actions', _lines(ends.action_servers)),
        ('Sends goals', _lines(ends.action_clients)),
    ]
    spun = runtime.entry_of(node) is not None
    text = 'It runs in the background.' if spun else 'It is not spun: `lab.spin(node)` runs it.'
    return Card('info', 'NODE', name, text=text, rows=rows)


def _lines(found: NamesAndTypes, name: str = '') -> str:
    """Return a line for each end; what every node has is left out."""
    from labkit.background.discovery import LAST_SERVICE, PARAMETER_SERVICES
    from labkit.rosgraph.names import EVERY_NODE_HAS

    usual = {f'{name}/{service}' for service in (*PARAMETER_SERVICES, LAST_SERVICE)}
    usual.update(EVERY_NODE_HAS)
    return '\n'.join(f'{end} [{", ".join(types)}]' for end, types in found if end not in usual)


def _is_shown(node: Node) -> bool:
    """Tell whether a node is to be shown as a card: its class has no form of its own."""
    from labkit.background.notebook_rclpy import is_installed

    own = type(node).__repr__ is not object.__repr__ or hasattr(node, '_repr_html_')
    return is_installed() and not own


def _text(node: Node, printer: Any, cycle: bool) -> None:
    # In a list or another container a card would be too much.
    as_card = _is_shown(node) and len(printer.stack) <= 1
    printer.text(repr(node_card(node) if as_card else node))


def _html(node: Node) -> str | None:
    if _is_shown(node):
        return node_card(node)._repr_html_()
    own = getattr(node, '_repr_html_', None)
    return own() if own is not None else None
