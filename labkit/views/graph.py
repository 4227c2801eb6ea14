"""The graph as a picture: `lab.graph()`.

The drawing is an SVG of our own, in the colours of the course's pictures, which every viewer of a
notebook shows. In JupyterLab the same drawing is live. In a terminal, and for screen readers, the
graph is told in words.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from labkit import settings
from labkit.background.discovery import soon
from labkit.errors import LabError
from labkit.rosgraph.snapshot import Graph, is_whole, read_graph
from labkit.views.graph_picture import Picture
from labkit.views.live import helper
from labkit.views.themed import as_source, picture

if TYPE_CHECKING:
    from labkit.views.graph_live import LiveGraph

__all__ = ['GraphView', 'bundle', 'graph']

EMPTY = 'No node is running. Start one with lab.spin(node) and look again.'


class GraphView:
    """The computation graph of one moment, to be shown in a cell.

    Attributes:
        data: The graph as data, see `labkit.rosgraph.snapshot.Graph`.
    """

    def __init__(self, data: Graph) -> None:
        self.data = data

    def __repr__(self) -> str:
        return bundle(self.data)['text/plain']

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        forms = bundle(self.data)
        drawing = forms.get('image/svg+xml')
        if drawing and settings.audience().live:
            # JupyterLab shows an SVG without its words, and as wide as it likes.
            source = as_source('image/svg+xml', drawing.encode())
            forms['text/html'] = picture(forms['text/plain'], source)
        return forms


def bundle(data: Graph) -> dict[str, str]:
    """Return a graph as text, and as a picture if there is something to draw."""
    if not data.nodes:
        return {'text/plain': EMPTY}
    return {'text/plain': str(data), 'image/svg+xml': Picture(data).svg()}


def graph(
    *, services: bool = False, actions: bool = True, hidden: bool = False, live: bool = True
) -> GraphView | LiveGraph:
    """Show the computation graph: which nodes run, and which topics connect them.

    Nodes are round, topics are boxes, an arrow is the way of the messages. A service has six
    corners, an action has double sides and thick arrows. Nodes of other processes have a dashed
    border. Where a subscription can't hear a publisher, a dashed arrow with a red cross leads to
    it, and says whom and why.

    In JupyterLab the picture is live: it follows what comes and goes, dots show messages that
    pass, and each part tells more when it is pointed at, or reached with Tab and the arrow keys.
    For that, what this notebook publishes and hears is counted. What other processes publish is
    subscribed to by a hidden node, while the picture is seen and no cell runs.

    Args:
        services: Whether to show services too.
        actions: Whether to show actions; one is drawn as one thing, not as what it consists of.
        hidden: Whether to show hidden nodes and topics, and those that every node has.
        live: Whether the picture is live in JupyterLab, until the cell is run again or ROS is
            stopped. False for a picture of this moment.

    Returns:
        What a cell shows as a picture, and `print()` as text. `.data` is the graph as data, and
        `.close()` ends a live one.

    Raises:
        LabError: An argument is neither True nor False.
    """
    given = {'services': services, 'actions': actions, 'hidden': hidden, 'live': live}
    for name, value in given.items():
        if not isinstance(value, bool):
            raise LabError(f'{name} must be True or False, but it is {value!r}.')
    node = helper()
    soon(lambda: is_whole(node))
    if live and settings.audience().live:
        from labkit.views.graph_live import LiveGraph

        return LiveGraph(services=services, actions=actions, hidden=hidden)
    return GraphView(
        read_graph(node, include_hidden=hidden, include_services=services, include_actions=actions)
    )
