"""Namespaces of a graph, each folded into one node: what a fleet has inside is out of sight."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace
from typing import TypeVar

from labkit.rosgraph.endpoints import Endpoint
from labkit.rosgraph.snapshot import Graph, GraphAction, GraphNode, GraphService

__all__ = ['fold', 'folded', 'spaces_of']

Offer = TypeVar('Offer', bound='GraphService | GraphAction')


def spaces_of(data: Graph) -> list[str]:
    """Return the namespaces that hold more than one node, but not all of them; sorted."""
    found = {space for node in data.nodes for space in _around(node.name)}
    counts = {space: sum(_is_in(node.name, space) for node in data.nodes) for space in found}
    return sorted(space for space, count in counts.items() if 1 < count < len(data.nodes))


def folded(name: str, spaces: Collection[str]) -> str:
    """Return a name, or `/robot1/*` for one in that namespace, if it is among those folded."""
    around = [space for space in spaces if _is_in(name, space)]
    return f'{min(around, key=len)}/*' if around else name


def fold(data: Graph, spaces: Collection[str]) -> Graph:
    """Return a graph in which each of some namespaces is one node.

    Topics, services and actions that only nodes within one of them use are left out.
    """
    if not spaces:
        return data
    nodes: dict[str, GraphNode] = {}
    for node in data.nodes:
        name = folded(node.name, spaces)
        before = nodes.get(name, GraphNode(name, node.own, 0))
        nodes[name] = GraphNode(name, before.own and node.own, before.count + node.count)

    def names(found: Iterable[str]) -> tuple[str, ...]:
        return tuple(dict.fromkeys(folded(node, spaces) for node in found))

    def ends(found: tuple[Endpoint, ...]) -> tuple[Endpoint, ...]:
        return tuple(replace(end, node=folded(end.node, spaces)) for end in found)

    def offers(found: tuple[Offer, ...]) -> Iterator[Offer]:
        for each in found:
            servers, clients = names(each.servers), names(each.clients)
            if not _is_inside((*servers, *clients)):
                yield replace(each, servers=servers, clients=clients, lost=names(each.lost))

    topics = [
        replace(one, publishers=ends(one.publishers), subscriptions=ends(one.subscriptions))
        for one in data.topics
    ]
    return Graph(
        tuple(nodes.values()),
        tuple(
            one
            for one in topics
            if not _is_inside(end.node for end in (*one.publishers, *one.subscriptions))
        ),
        tuple(offers(data.services)),
        tuple(offers(data.actions)),
    )


def _around(name: str) -> list[str]:
    """Return the namespaces that a name is in, but for the root."""
    parts = name.split('/')[1:-1]
    return ['/' + '/'.join(parts[: count + 1]) for count in range(len(parts))]


def _is_in(name: str, space: str) -> bool:
    return name.startswith(f'{space}/')


def _is_inside(nodes: Iterable[str]) -> bool:
    """Return whether some nodes are all the same folded namespace."""
    names = set(nodes)
    return len(names) == 1 and names.pop().endswith('/*')
