"""The live graph picture of JupyterLab: it follows changes and passing messages.

It reads the graph and counts messages only while the page reports that the picture is visible.
"""

from __future__ import annotations

import threading
import time
from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from labkit.asking.parameter_calls import get_parameters, parameter_names
from labkit.asking.traffic import Traffic, Way
from labkit.background.compat import RCLError, parameter_values
from labkit.background.nodes import existing_nodes, full_name
from labkit.errors import LabError, quoted
from labkit.rosgraph.parameter_values import python_value
from labkit.rosgraph.snapshot import Graph, read_graph
from labkit.silent.kinds import Fault
from labkit.silent.watch import watch
from labkit.views.graph import bundle, names_of, not_drawn
from labkit.views.graph_flow import Flow, in_hertz, parts, way_of
from labkit.views.graph_fold import fold, folded, spaces_of
from labkit.views.graph_picture import Picture
from labkit.views.graph_words import description
from labkit.views.live import helper
from labkit.views.live_page import REFRESH_SEC, LivePage, Update
from labkit.views.svg_drawing import WIDTH, fitting

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['LiveGraph']

# Period of rates, s: faster changes can't be read.
RATES_SEC = 1.0
# Name of the switch of a namespace, with that behind it.
_FOLD = 'fold '


class LiveGraph(LivePage):
    """The computation graph, live, to be shown in a cell; see `labkit.views.graph.graph`."""

    _name = 'graph'
    # Period of the dots that show messages.
    _period = 0.1

    def __init__(self, *, services: bool, actions: bool, hidden: bool) -> None:
        self._hidden = hidden
        self._shown = {'services': services, 'actions': actions}
        # Namespaces that are one node each.
        self._folded: set[str] = set()
        # Nodes that are being asked for their parameters.
        self._asked: set[str] = set()
        self._width = WIDTH
        self._visible = False
        # Whether the page shows the graph as it was when the cell was run.
        self._then = False
        self._traffic = Traffic()
        self._told: tuple[Fault, ...] = ()
        self._flows: dict[Way, Flow] = {}
        self._read_at = self._rated_at = 0.0
        self._first = self._now = self._read()
        self._drawn = self._chosen(self._first)
        self._picture = Picture(self._drawn)
        super().__init__()

    @property
    def data(self) -> Graph:
        """The current graph as data."""
        return self._chosen(self._read() if self._can_read() else self._now)

    def __repr__(self) -> str:
        return self._static()['text/plain']

    def _static(self) -> dict[str, str]:
        return bundle(self.data)

    def _can_read(self) -> bool:
        """Return whether ROS is up: a view must not restart it."""
        return not (self._ended or self._why_stopped())

    def _read(self) -> Graph:
        return read_graph(helper(), include_hidden=self._hidden, include_services=True)

    def _chosen(self, data: Graph) -> Graph:
        services = data.services if self._shown['services'] else ()
        actions = data.actions if self._shown['actions'] else ()
        return Graph(data.nodes, data.topics, services, actions)

    # -- listening ------------------------------------------------------------------------------

    def _open(self) -> None:
        with self._lock:
            super()._open()
            if self._visible:
                self._traffic.open()

    def _close(self) -> None:
        with self._lock:
            self._traffic.close()
            super()._close()

    def _handle_request(self, content: dict[str, Any]) -> None:
        if isinstance(content.get('ask'), str):
            self._ask(content['ask'])
            return
        if isinstance(content.get('width'), (int, float)):
            self._width = fitting(content['width'])
        for name in self._shown:
            self._shown[name] = bool(content.get(name, self._shown[name]))
        for space in spaces_of(self._now):
            if content.get(_FOLD + space, space in self._folded):
                self._folded.add(space)
            else:
                self._folded.discard(space)
        self._then = bool(content.get('then', self._then))
        self._visible = bool(content.get('visible', self._visible))
        if self._visible:
            self._traffic.open()
        else:
            self._traffic.close()
        self._send(everything=True)

    def _ask(self, name: str) -> None:
        """Ask a node for its parameters, in a thread: it may never answer."""
        if name not in self._asked and any(node.name == name for node in self._now.nodes):
            self._asked.add(name)
            arguments = name, helper()  # which in the thread might start ROS again
            threading.Thread(target=self._tell_parameters, args=arguments, daemon=True).start()

    def _tell_parameters(self, name: str, asking: Node) -> None:
        from rclpy.exceptions import InvalidHandle

        try:
            words = _parameters_of(name, asking)
        except (LabError, RCLError, InvalidHandle) as error:
            words = str(error)
        self._asked.discard(name)
        with self._lock:
            self._send_to_page({'parameters': {name: words}})

    # -- the page -------------------------------------------------------------------------------

    def _update(self, everything: bool) -> Update:
        now = time.monotonic()
        due = everything or (self._visible and now - self._read_at >= REFRESH_SEC)
        if due and self._can_read():
            self._read_at = now
            self._now = self._read()
            if self._visible:
                self._traffic.listen_to_others(self._now.topics)
        whole = self._first if self._then else self._now
        spaces = spaces_of(whole)
        self._folded.intersection_update(spaces)
        chosen = fold(self._chosen(whole), self._folded)
        state: dict[str, Any] = {
            'then': self._then,
            'changed': self._chosen(self._first) != self._chosen(self._now),
            # Offer no switch for what does not exist.
            'switches': {
                **{name: on for name, on in self._shown.items() if getattr(whole, name)},
                **{_FOLD + space: space in self._folded for space in spaces},
            },
        }
        if everything or chosen != self._drawn or watch.seen != self._told:
            self._told = watch.seen
            self._drawn = chosen
            self._picture = Picture(chosen, self._width, self._wrong())
            state |= self._drawing()
        passed = self._passed(now)
        if now - self._rated_at >= RATES_SEC or everything:
            self._rated_at = now
            state['rates'] = self._rates(now)
        changes = self._changes(state)
        return ({**changes, 'passed': passed} if passed else changes), []

    def _wrong(self) -> set[str]:
        """Return the nodes and topics that get a sign, and those that have one folded inside."""
        drawn = names_of(not_drawn(self._told))
        inside = {folded(name, self._folded) for name in names_of(self._told)}
        return drawn | inside - names_of(self._told)

    def _drawing(self) -> dict[str, Any]:
        told = [description(self._drawn), *map(str, self._told)]
        return {
            'svg': self._picture.svg() if self._drawn.nodes else '',
            'parts': parts(self._drawn, self._picture, self._first if self._then else self._now),
            'told': ' '.join(told) if self._drawn.nodes else '',
        }

    def _passed(self, now: float) -> dict[str, int]:
        """Return the number of messages along each arrow since the last call."""
        if not self._visible:
            return {}
        counts: Counter[Way] = Counter()
        for (kind, node, topic), count in self._traffic.passed(self._now.topics).items():
            counts[kind, folded(node, self._folded), topic] += count
        for way, count in counts.items():
            self._flows.setdefault(way, Flow()).add(now, count)
        for way in self._flows.keys() - {way for _, way in self._ways()}:
            del self._flows[way]
        if self._then:
            return {}
        return {name: counts[way] for name, way in self._ways() if way in counts}

    def _rates(self, now: float) -> dict[str, str]:
        flows = self._flows
        return {name: in_hertz(flows[way].rate(now)) for name, way in self._ways() if way in flows}

    def _ways(self) -> Iterator[tuple[str, Way]]:
        """Yield the name and the endpoint of each arrow with counted messages."""
        for number, line in enumerate(self._picture.lines):
            way = way_of(line)
            if way is not None:
                yield f'a{number}', way


def _parameters_of(node_name: str, asking: Node) -> str:
    """Return the parameters of a node and their values, in a line."""
    for node in existing_nodes():
        if full_name(node) == node_name:
            found = sorted(parameter_values(node).items())  # it need not be spun
            break
    else:
        names = parameter_names(asking, node_name)
        values = get_parameters(asking, node_name, names)
        found = [(n, python_value(values[n]) if n in values else None) for n in names]
    return ', '.join(f'{name} = {quoted(value)}' for name, value in found)
