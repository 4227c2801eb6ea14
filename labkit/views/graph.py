"""The graph as a picture: `lab.graph()`.

JupyterLab draws Mermaid diagrams by itself, offline and in the colours of its theme. Everywhere
else, and for screen readers, the graph is told in words.

A live picture is the cell's output, replaced again and again. It has no part in the page, which
would have to bring a Mermaid of its own, as large as all of labkit. So nobody tells whether it is
looked at: it follows until its cell is run again, or ROS is stopped.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from labkit.background.discovery import soon
from labkit.errors import LabError
from labkit.rosgraph.endpoints import Endpoint
from labkit.rosgraph.matching import why_apart
from labkit.rosgraph.snapshot import (
    Graph,
    GraphAction,
    GraphNode,
    GraphTopic,
    is_whole,
    read_graph,
)
from labkit.views.live import STOPPED, Live, helper

if TYPE_CHECKING:
    from IPython.display import DisplayHandle

__all__ = ['GraphView', 'graph', 'to_mermaid']

# Above this many boxes, they are drawn closer together.
MANY = 20
# The words on an arrow hide the arrow behind them.
CSS = '.edgeLabel rect {opacity: 1}'


class GraphView(Live):
    """The computation graph, to be shown in a cell.

    Attributes:
        data: The graph as data, see `labkit.rosgraph.snapshot.Graph`.
    """

    _name = 'graph'
    _period = 0.5

    def __init__(self, *, services: bool, hidden: bool, live: bool) -> None:
        super().__init__()
        self._services, self._hidden = services, hidden
        self._follows = live and self._watched
        self._handle: DisplayHandle | None = None
        node = helper()
        soon(lambda: is_whole(node))
        self.data = self._read()

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

        follows = self._follows and not self._ended
        handle = display(  # type: ignore[no-untyped-call]
            self._repr_mimebundle_(), raw=True, display_id=follows or None
        )
        if follows:
            self._handle = handle
            self._take_place()
            if self._node is None:
                self._open()

    def _tick(self) -> None:
        now = self._read()
        if now != self.data:
            self.data = now
            self._show(self._repr_mimebundle_())

    def _say_end(self) -> None:
        # What was shown would go on telling of nodes that are gone.
        if self._ended == STOPPED:
            self._show({'text/plain': self._ended})

    def _show(self, bundle: dict[str, str]) -> None:
        if self._handle is not None:
            self._handle.update(bundle, raw=True)  # type: ignore[no-untyped-call]

    def _read(self) -> Graph:
        return read_graph(helper(), include_hidden=self._hidden, include_services=self._services)


def graph(*, services: bool = False, hidden: bool = False, live: bool = False) -> GraphView:
    """Show the computation graph: which nodes run, and which topics connect them.

    Nodes are round, topics are boxes, an arrow is the way of the messages. A thick arrow is an
    action, from who sends goals to who serves it. Nodes of other
    processes have a dashed border. Where a subscription can't hear a publisher, a dashed line with
    a cross at its end leads to it, and says whom and why.

    Args:
        services: Whether to show services too.
        hidden: Whether to show hidden nodes and topics, and those that every node has.
        live: Whether the picture follows what changes, until the cell is run again or ROS is
            stopped.

    Returns:
        What a cell shows as a picture, and `print()` as text. `.data` is the graph as data, and
        `.close()` ends a live one.

    Raises:
        LabError: An argument is neither True nor False.
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
        arrows.update(
            {f'  {ids[e.node]} --> {box}': None for e in topic.publishers if e.node in ids}
        )
        for end in topic.subscriptions:
            if end.node in ids:
                arrows.update(dict.fromkeys(_hearing(topic, end, box, ids[end.node])))
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
    for number, action in enumerate(data.actions):
        arrows.update(dict.fromkeys(_of_action(action, f'a{number}', ids)))
    return '\n'.join(
        [
            *lines,
            *arrows,
            '  classDef own stroke-width:3px',
            '  classDef foreign stroke-width:2px,stroke-dasharray:6 4',
            '  classDef topic stroke-width:1px',
        ]
    )


def _hearing(topic: GraphTopic, end: Endpoint, box: str, node: str) -> list[str]:
    """Return the arrows from a topic to a subscription: to be heard, and with a cross if not."""
    apart = {other.node: reason for other in topic.publishers if (reason := why_apart(other, end))}
    arrows = []
    if not apart or any(not why_apart(other, end) for other in topic.publishers):
        arrows += [f'  {box} --> {node}']
    if apart:
        words = '<br>'.join(
            _escape(f'does not hear {other}: {reason}') for other, reason in apart.items()
        )
        # Dashes, a cross in place of the head, and words: it needs no colour.
        arrows += [f'  {box} -. "{words}" .-x {node}']
    return arrows


def _of_action(action: GraphAction, box: str, ids: dict[str, str]) -> list[str]:
    """Return one thick arrow from each client to each server; a box stands for who is missing."""
    label = _escape(action.name) + ''.join(f'<br>{_escape(name)}' for name in action.types)
    clients = [ids[name] for name in action.clients if name in ids]
    servers = [ids[name] for name in action.servers if name in ids]
    if clients and servers:
        return [f'  {one} == "{label}" ==> {other}' for one in clients for other in servers]
    shown = f'{box}[["{label}"]]:::topic'
    return [f'  {one} ==> {shown}' for one in clients] + [f'  {shown} ==> {n}' for n in servers]


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
    apart = ''.join(
        f' {_escape(pair.subscription)} does not hear {_escape(pair.publisher)} on '
        f'{_escape(pair.topic)}: {_escape(pair.reason)}.'
        for pair in data.mismatches
    )
    actions = ', '.join(_escape(action.name) for action in data.actions)
    served = f' Actions {actions}.' if actions else ''
    return f'Nodes {nodes or "none"}. Topics {topics or "none"}.{served}{apart}'


def _escape(text: str) -> str:
    """Return text in which no character has a meaning for Mermaid or HTML."""
    return ''.join(
        char if char.isalnum() or char in ' /_.,:-' else f'#{ord(char)};' for char in text
    )
