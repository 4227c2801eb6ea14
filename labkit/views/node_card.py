"""A node as the last value of a cell: its name and its endpoints.

rclpy's `Node` has no rich representation. IPython gets one by name, so that rclpy need not be
loaded; it is used while the notebook-safe functions are installed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from labkit import settings
from labkit.views.card import Card

if TYPE_CHECKING:
    from rclpy.node import Node

    from labkit.rosgraph.listings import NamesAndTypes

__all__ = ['node_card', 'register']


def register() -> None:
    """Register the node form with the running IPython, if there is one."""
    shell = settings.shell()
    if shell is None:
        return
    formatters = shell.display_formatter.formatters
    formatters['text/plain'].for_type_by_name('rclpy.node', 'Node', _text)
    formatters['text/html'].for_type_by_name('rclpy.node', 'Node', _html)


def node_card(node: Node) -> Card:
    """Return a node as a card: `ros2 node info` in short."""
    from labkit.background.nodes import full_name, has_begun, state_of
    from labkit.background.runtime import runtime
    from labkit.rosgraph.listings import ends_of_node
    from labkit.silent.watch import about

    name = full_name(node)
    if not name:
        text = 'It has ended.'
        if not has_begun(node):
            text = 'It is not a node yet: its __init__ has not called the one of Node.'
        return Card('quiet', 'NODE', type(node).__name__, text=text)
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
    told = [fault for fault in about(name) if fault.kind.id != 'life.unspun']
    rows += [('⚠', f'{fault}\n→ {fault.advice}') for fault in told]
    text = 'It runs in the background.' if spun else 'It is not spun: `lab.spin(node)` runs it.'
    always, now = state_of(node)
    text += f' It {now or always}.' if now or always else ''
    return Card('info', 'NODE', name, text=text, rows=rows)


def _lines(found: NamesAndTypes, name: str = '') -> str:
    """Return one line per endpoint, without those that every node has."""
    from labkit.rosgraph.names import EVERY_NODE_HAS, EVERY_NODE_OFFERS

    usual = {f'{name}/{service}' for service in EVERY_NODE_OFFERS}
    usual.update(EVERY_NODE_HAS)
    return '\n'.join(f'{end} [{", ".join(types)}]' for end, types in found if end not in usual)


def _is_shown(node: Node) -> bool:
    """Return whether to show a node as a card: unless its class has its own representation."""
    from labkit.background.notebook_rclpy import is_installed

    own = type(node).__repr__ is not object.__repr__ or hasattr(node, '_repr_html_')
    return is_installed() and not own


def _text(node: Node, printer: Any, cycle: bool) -> None:
    # Inside a list or another container a card would be too much.
    as_card = _is_shown(node) and len(printer.stack) <= 1
    printer.text(repr(node_card(node) if as_card else node))


def _html(node: Node) -> str | None:
    if _is_shown(node):
        return node_card(node)._repr_html_()
    own = getattr(node, '_repr_html_', None)
    return own() if own is not None else None
