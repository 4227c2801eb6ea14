"""The picture of the graph in JupyterLab: it follows what comes and goes, and what passes.

The graph is read, and messages are counted, only while the page says that a person can see the
picture.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

from labkit.background.traffic import Traffic, Way
from labkit.rosgraph.snapshot import Graph, read_graph
from labkit.views.graph import bundle
from labkit.views.graph_flow import Flow, in_hertz, parts, way_of
from labkit.views.graph_picture import WIDTH, Picture
from labkit.views.graph_words import description
from labkit.views.live import helper
from labkit.views.live_page import LOOK_SEC, LivePage, News

__all__ = ['LiveGraph']

# A page may be narrower; then the picture is made smaller, px.
NARROWEST = 340.0
# Rates are told so often, s: more often they can't be read.
RATES_SEC = 1.0


class LiveGraph(LivePage):
    """The computation graph, live, to be shown in a cell; see `labkit.views.graph.graph`."""

    _name = 'graph'
    # So often dots start on their way.
    _period = 0.1

    def __init__(self, *, services: bool, actions: bool, hidden: bool) -> None:
        self._hidden = hidden
        self._shown = {'services': services, 'actions': actions}
        self._width = WIDTH
        self._visible = False
        # Whether the page shows how it was when the cell was run.
        self._then = False
        self._traffic = Traffic()
        self._flows: dict[Way, Flow] = {}
        self._read_at = self._rated_at = 0.0
        self._first = self._now = self._read()
        self._drawn = self._chosen(self._first)
        self._picture = Picture(self._drawn)
        super().__init__()

    @property
    def data(self) -> Graph:
        """The graph as data, as it is now, see `labkit.rosgraph.snapshot.Graph`."""
        return self._chosen(self._read() if self._can_look() else self._now)

    def __repr__(self) -> str:
        return self._still()['text/plain']

    def _still(self) -> dict[str, str]:
        return bundle(self.data)

    def _can_look(self) -> bool:
        """Tell whether ROS is up: it is not started again from here."""
        return not (self._ended or self._cut_off())

    def _read(self) -> Graph:
        return read_graph(helper(), include_hidden=self._hidden, include_services=True)

    def _chosen(self, data: Graph) -> Graph:
        """Return what is to be shown of a graph."""
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

    def _hear(self, content: dict[str, Any]) -> None:
        if isinstance(content.get('width'), (int, float)):
            self._width = min(max(float(content['width']), NARROWEST), WIDTH)
        for name in self._shown:
            self._shown[name] = bool(content.get(name, self._shown[name]))
        self._then = bool(content.get('then', self._then))
        self._visible = bool(content.get('visible', self._visible))
        if self._visible:
            self._traffic.open()
        else:
            self._traffic.close()
        self._send(everything=True)

    # -- the page -------------------------------------------------------------------------------

    def _news(self, everything: bool) -> News:
        now = time.monotonic()
        due = everything or (self._visible and now - self._read_at >= LOOK_SEC)
        if due and self._can_look():
            self._read_at = now
            self._now = self._read()
            if self._visible:
                self._traffic.listen_to_others(self._now.topics)
        whole = self._first if self._then else self._now
        chosen = self._chosen(whole)
        state: dict[str, Any] = {
            'then': self._then,
            'changed': self._chosen(self._first) != self._chosen(self._now),
            # Nobody is asked for what is not there.
            'switches': {name: on for name, on in self._shown.items() if getattr(whole, name)},
        }
        if everything or chosen != self._drawn:
            self._drawn, self._picture = chosen, Picture(chosen, self._width)
            state |= self._drawing()
        passed = self._passed(now)
        if now - self._rated_at >= RATES_SEC or everything:
            self._rated_at = now
            state['rates'] = self._rates(now)
        news = self._new_of(state)
        return ({**news, 'passed': passed} if passed else news), []

    def _drawing(self) -> dict[str, Any]:
        return {
            'svg': self._picture.svg() if self._drawn.nodes else '',
            'parts': parts(self._drawn, self._picture),
            'told': description(self._drawn) if self._drawn.nodes else '',
        }

    def _passed(self, now: float) -> dict[str, int]:
        """Return how many messages have passed along each arrow since the last time."""
        if not self._visible:
            return {}
        counts = self._traffic.passed(self._now.topics)
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
        """Yield the arrows on which messages are counted, and what passes there."""
        for number, line in enumerate(self._picture.lines):
            way = way_of(line)
            if way is not None:
                yield f'a{number}', way
