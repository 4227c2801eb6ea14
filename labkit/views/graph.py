"""The graph as a picture: `lab.graph()`.

JupyterLab draws Mermaid diagrams by itself, offline and in the colours of its theme. Everywhere
else, and for screen readers, the graph is told in words.
"""

from __future__ import annotations

from typing import Any

from labkit import settings
from labkit.background.discovery import soon
from labkit.background.runtime import runtime
from labkit.errors import LabError
from labkit.rosgraph.snapshot import Graph, GraphNode, is_whole, read_graph

__all__ = ['GraphView', 'graph', 'to_mermaid']

UPDATE_SEC = 0.5
# Above this many boxes, they are drawn closer together.
MANY = 20
# The words on an arrow hide the arrow behind them.
CSS = '.edgeLabel rect {opacity: 1}'

# Live pictures by the id of their cell, so that a cell that is run again ends its earlier one.
_live: dict[str, GraphView] = {}


class GraphView:
    """The computation graph, to be shown in a cell.

    Attributes:
        data: The graph as data, see `labkit.rosgraph.snapshot.Graph`.
    """

    def __init__(self, *, services: bool, hidden: bool, live: bool) -> None:
        self._services = services
        self._hidden = hidden
        self._is_live = live and settings.audience().live
        self._handle: Any = None
        self._timer: Any = None
        runtime.start()
        helper = runtime.helper
        assert helper is not None
        soon(lambda: is_whole(helper))
        self.data = self._read()

    def close(self) -> None:
        """Follow changes no more. The picture stays as it is."""
        if self._timer is not None and runtime.helper is not None:
            runtime.helper.destroy_timer(self._timer)
        self._timer = None

    def __enter__(self) -> GraphView:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        if not self.data.nodes:
            return 'No node is running. Start one with lab.spin(node) and look again.'
        return str(self.data)

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        bundle = {'text/plain': repr(self)}
        if self.data.nodes:
            bundle['text/vnd.mermaid'] = to_mermaid(self.data)
        return bundle

    def _ipython_display_(self) -> None:
        from IPython.display import display

        bundle = self._repr_mimebundle_()
        if not self._is_live:
            display(bundle, raw=True)  # type: ignore[no-untyped-call]
            return
        self._handle = display(  # type: ignore[no-untyped-call]
            bundle, raw=True, display_id=True
        )
        self._follow()

    def _follow(self) -> None:
        cell_id = runtime.console.current_cell().cell_id
        earlier = _live.pop(cell_id, None)
        if earlier is not None:
            earlier.close()
        self.close()
        runtime.start()
        assert runtime.helper is not None
        self._timer = runtime.helper.create_timer(UPDATE_SEC, self._update)
        _live[cell_id] = self

    def _update(self) -> None:
        now = self._read()
        if now != self.data:
            self.data = now
            self._handle.update(self._repr_mimebundle_(), raw=True)

    def _read(self) -> Graph:
        runtime.start()
        assert runtime.helper is not None
        return read_graph(
            runtime.helper,
            include_hidden=self._hidden,
            include_services=self._services,
        )


def graph(*, services: bool = False, hidden: bool = False, live: bool = False) -> GraphView:
    """Show the computation graph: which nodes run, and which topics connect them.

    Nodes are round, topics are boxes, an arrow is the way of the messages. Nodes of other
    processes have a dashed border. A pair that can't exchange messages is marked with a dashed
    arrow and the reason.

    Args:
        services: Whether to show services too.
        hidden: Whether to show hidden nodes and topics, and those that every node has.
        live: Whether the picture follows what changes, until the cell is run again.

    Returns:
        What a cell shows as a picture, and `print()` as text. `.data` is the graph as data.
    """
    for name, value in (('services', services), ('hidden', hidden), ('live', live)):
        if not isinstance(value, bool):
            raise LabError(f'{name} must be True or False, but it is {value!r}.')
    return GraphView(services=services, hidden=hidden, live=live)


def to_mermaid(data: Graph) -> str:
    """Return the graph as a Mermaid flowchart.

    Args:
        data: The graph.
    """
    close = len(data.nodes) + len(data.topics) > MANY
    spacing = '"nodeSpacing": 12, "rankSpacing": 60' if close else '"nodeSpacing": 30'
    lines = [
        f'%%{{init: {{"flowchart": {{{spacing}, "htmlLabels": false}}, "themeCSS": "{CSS}"}}}}%%',
        'flowchart LR',
        '  accTitle: Computation graph',
        f'  accDescr: {_summary(data)}',
    ]
    ids = {node.name: f'n{number}' for number, node in enumerate(data.nodes)}
    for node in data.nodes:
        shape = 'own' if node.own else 'foreign'
        lines.append(f'  {ids[node.name]}("{_node_label(node)}"):::{shape}')
    arrows: dict[str, None] = {}
    for number, topic in enumerate(data.topics):
        box = f't{number}'
        label = _escape(topic.name) + ''.join(f'<br>{_escape(name)}' for name in topic.types)
        lines.append(f'  {box}["{label}"]:::topic')
        apart = {mismatch.subscription: mismatch.reason for mismatch in topic.mismatches()}
        arrows.update(
            {f'  {ids[e.node]} --> {box}': None for e in topic.publishers if e.node in ids}
        )
        for end in topic.subscriptions:
            reason = _escape(f'no match: {apart[end.node]}') if end.node in apart else ''
            arrow = f'-. "{reason}" .->' if reason else '-->'
            if end.node in ids:
                arrows[f'  {box} {arrow} {ids[end.node]}'] = None
    for number, service in enumerate(data.services):
        box = f's{number}'
        label = _escape(service.name) + ''.join(f'<br>{_escape(name)}' for name in service.types)
        lines.append(f'  {box}{{{{"{label}"}}}}:::topic')
        arrows.update(
            {f'  {ids[name]} --> {box}': None for name in service.clients if name in ids}
        )
        arrows.update(
            {f'  {box} --> {ids[name]}': None for name in service.servers if name in ids}
        )
    return '\n'.join(
        [
            *lines,
            *arrows,
            '  classDef own stroke-width:3px',
            '  classDef foreign stroke-width:2px,stroke-dasharray:6 4',
            '  classDef topic stroke-width:1px',
        ]
    )


def _node_label(node: GraphNode) -> str:
    label = _escape(node.name)
    if not node.own:
        label += '<br>another process'
    if node.count > 1:
        label += f'<br>{node.count} nodes of this name'
    return label


def _summary(data: Graph) -> str:
    nodes = ', '.join(_escape(node.name) for node in data.nodes)
    topics = ', '.join(_escape(topic.name) for topic in data.topics)
    return f'Nodes {nodes or "none"}. Topics {topics or "none"}.'


def _escape(text: str) -> str:
    """Return text in which no character has a meaning for Mermaid or HTML."""
    return ''.join(
        char if char.isalnum() or char in ' /_.,:-' else f'#{ord(char)};' for char in text
    )
