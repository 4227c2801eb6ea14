"""`ros2 lifecycle`: the states of nodes that have some, and the ways between them."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from lifecycle_msgs.srv import ChangeState, GetAvailableTransitions, GetState

from labkit.asking.discovery import poll_until
from labkit.asking.service_calls import call_node
from labkit.errors import LabError
from labkit.ros2.graph_queries import add_discovery_options, asking_node, check_node_name
from labkit.ros2.parser import Command, Parser, Verb, real_one
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.listings import services
from labkit.rosgraph.names import is_hidden

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['COMMAND']

_ASKS = '/get_state'


def list_nodes(args: Namespace) -> None:
    """Print the nodes that have states."""
    node = asking_node(args)
    names = poll_until(lambda: _with_states(node, args.all)) or []
    if args.count_nodes:
        print(len(names))
        return
    for name in names:
        print(name)


def get(args: Namespace) -> None:
    """Print the state of one node or of all."""
    node = asking_node(args)
    if args.node_name:
        print(_state(node, _checked(node, args.node_name)))
        return
    for name in poll_until(lambda: _with_states(node, args.include_hidden_nodes)) or []:
        print(f'{name}: {_state(node, name)}')


def list_transitions(args: Namespace) -> None:
    """Print the ways out of the state of a node, or all that it has."""
    node = asking_node(args)
    service = 'get_transition_graph' if args.all else 'get_available_transitions'
    for each in _transitions(node, _checked(node, args.node_name), service):
        print(f'- {_shown(each.transition)}')
        print(f'\tStart: {each.start_state.label}\n\tGoal: {each.goal_state.label}')


def set_state(args: Namespace) -> str | None:
    """Let a node go one of the ways out of its state."""
    node = asking_node(args)
    name = _checked(node, args.node_name)
    known = [each.transition for each in _transitions(node, name)]
    chosen = [
        *(each for each in known if each.label == args.transition),
        *(each for each in known if str(each.id) == args.transition),
    ]
    if not chosen:
        there = ''.join(f'\n- {_shown(each)}' for each in known)
        return f'Unknown transition requested, available ones are:{there}'
    request = ChangeState.Request(transition=chosen[0])
    if not call_node(node, ChangeState, name, 'change_state', request).success:
        return 'Transitioning failed'
    print('Transitioning successful')
    return None


def _state(node: Node, name: str) -> str:
    return _shown(call_node(node, GetState, name, 'get_state', GetState.Request()).current_state)


def _transitions(node: Node, name: str, service: str = 'get_available_transitions') -> list[Any]:
    request = GetAvailableTransitions.Request()
    answer = call_node(node, GetAvailableTransitions, name, service, request)
    return list(answer.available_transitions)


def _shown(state: Any) -> str:
    """Return a state or a transition in words."""
    return f'{state.label} [{state.id}]'


def _with_states(node: Node, include_hidden: bool = True) -> list[str]:
    wanted = type_name(GetState)
    return [
        name.removesuffix(_ASKS)
        for name, types in services(node)
        if name.endswith(_ASKS) and wanted in types
        if include_hidden or not is_hidden(name.removesuffix(_ASKS))
    ]


def _checked(node: Node, typed: str) -> str:
    """Return the full name of a node that has states."""
    name = check_node_name(node, typed)
    if not poll_until(lambda: name in _with_states(node)):
        with real_one(says='Node not found'):
            raise LabError(
                f'{name} has no states: it is no LifecycleNode.',
                todo='ros2 lifecycle nodes lists those that have some.',
            )
    return name


def _names(args: Namespace) -> Iterable[str]:
    return _with_states(asking_node(args))


def _nodes_arguments(parser: Parser) -> None:
    add_discovery_options(parser)
    parser.flag('-a, --all', 'Display all nodes even hidden ones')
    parser.flag('-c, --count-nodes', 'Only display the number of nodes discovered')


def _get_arguments(parser: Parser) -> None:
    add_discovery_options(parser)
    parser.add('node_name', nargs='?', help='Name of the ROS node', complete=_names)
    parser.flag('--include-hidden-nodes', 'Consider hidden nodes as well')


def _list_arguments(parser: Parser) -> None:
    add_discovery_options(parser)
    parser.add('node_name', help='Name of the ROS node', complete=_names)
    parser.flag('-a, --all', 'Display all existing transitions')


def _set_arguments(parser: Parser) -> None:
    add_discovery_options(parser)
    parser.add('node_name', help='Name of the ROS node', complete=_names)
    parser.add('transition', help='The lifecycle transition, by its name or number')


COMMAND = Command(
    'lifecycle',
    'Various lifecycle related sub-commands',
    (
        Verb('get', 'Get lifecycle state for one or more nodes', get, _get_arguments),
        Verb('list', 'Output a list of available transitions', list_transitions, _list_arguments),
        Verb('nodes', 'Output a list of nodes with lifecycle', list_nodes, _nodes_arguments),
        Verb('set', 'Trigger lifecycle state transition', set_state, _set_arguments),
    ),
)
