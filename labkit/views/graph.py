"""The graph as a picture: `lab.graph()`.

The drawing is an SVG in the colours of the course's pictures, which every notebook viewer shows.
In JupyterLab the same drawing is live. Terminals and screen readers get the graph in words.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from labkit import settings
from labkit.asking.discovery import poll_until
from labkit.errors import LabError, quoted
from labkit.rosgraph.snapshot import Graph, is_whole, read_graph
from labkit.silent.kinds import Fault, in_words
from labkit.silent.watch import faults
from labkit.views.graph_picture import Picture
from labkit.views.live import helper
from labkit.views.themed import as_source, picture

if TYPE_CHECKING:
    from labkit.views.graph_live import LiveGraph

__all__ = ['GraphView', 'bundle', 'graph', 'names_of', 'not_drawn']

EMPTY = 'No node is running. Start one with lab.spin(node) and look again.'


class GraphView:
    """The computation graph at one moment, to be shown in a cell."""

    def __init__(self, data: Graph) -> None:
        self.data = data

    def __repr__(self) -> str:
        return bundle(self.data)['text/plain']

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        forms = bundle(self.data)
        drawing = forms.get('image/svg+xml')
        if drawing and settings.audience().live:
            # JupyterLab would show an SVG without its text, and at any width.
            source = as_source('image/svg+xml', drawing.encode())
            forms['text/html'] = picture(forms['text/plain'], source)
        return forms


def bundle(data: Graph) -> dict[str, str]:
    """Return a graph as text, and as a picture if it has nodes."""
    if not data.nodes:
        return {'text/plain': EMPTY}
    found = not_drawn(faults())
    text = '\n'.join(filter(None, [str(data), in_words(found)]))
    return {'text/plain': text, 'image/svg+xml': Picture(data, wrong=names_of(found)).svg()}


def not_drawn(found: Iterable[Fault]) -> list[Fault]:
    """Leave out the faults that the picture itself shows: two ends that do not match."""
    return [one for one in found if not one.kind.id.startswith(('qos.', 'types.'))]


def names_of(found: Iterable[Fault]) -> set[str]:
    """Return the nodes and topics that faults are about."""
    return {name for one in found for name in one.names}


def graph(
    *, services: bool = False, actions: bool = True, hidden: bool = False, live: bool = True
) -> GraphView | LiveGraph:
    """Show the computation graph: which nodes run, and which topics connect them.

    Nodes are round, topics are boxes, and arrows show where messages go. Services are hexagons,
    actions have double sides and thick arrows. Nodes of other processes have a dashed border.
    What is in a namespace is in a frame. Where a subscription can't receive from a publisher, a
    dashed arrow with a red cross says why. A part with another silent fault has a warning sign.

    In JupyterLab the picture is live: it follows changes, dots show passing messages, and each
    part tells more when pointed at, or reached with Tab and the arrow keys, a fault included; a
    node, when it is clicked or with Enter, its parameters.
    It is a screen high at most; buttons, the keys + - 0, and the mouse wheel with Ctrl make it
    larger or smaller, and it can be dragged. A namespace of several nodes can be folded into one.
    Messages of this notebook are counted as they pass; those of other processes are subscribed to
    by a hidden node, while the picture is visible and no cell is running.

    Args:
        services: Whether to show services too.
        actions: Whether to show actions, each as one thing instead of its topics and services.
        hidden: Whether to show hidden nodes and topics, and those that every node has.
        live: Whether the picture is live in JupyterLab, until the cell is run again or ROS is
            stopped. False for a picture of this moment.

    Returns:
        A picture in a cell, text for `print()`. `.data` is the graph as data, and `.close()` ends
        a live picture.

    Raises:
        LabError: An argument is neither True nor False.
    """
    given = {'services': services, 'actions': actions, 'hidden': hidden, 'live': live}
    for name, value in given.items():
        if not isinstance(value, bool):
            raise LabError(f'{name} must be True or False, but it is {quoted(value)}.')
    node = helper()
    poll_until(lambda: is_whole(node))
    if live and settings.audience().live:
        from labkit.views.graph_live import LiveGraph

        return LiveGraph(services=services, actions=actions, hidden=hidden)
    return GraphView(
        read_graph(node, include_hidden=hidden, include_services=services, include_actions=actions)
    )
