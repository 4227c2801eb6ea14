"""`ros2 action`: list actions and their endpoints, and send goals."""

from __future__ import annotations

import queue
import sys
from argparse import Namespace
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalStatus

from labkit import settings
from labkit.asking.action_goals import ActionGoals, shown_id
from labkit.asking.discovery import poll_until
from labkit.errors import LabError
from labkit.ros2.graph_completion import action_names, types_of_action
from labkit.ros2.graph_queries import (
    add_discovery_options,
    asking_node,
    full_name,
    known_names,
    print_names,
    unknown,
    values_text,
)
from labkit.ros2.parser import Command, Parser, Verb, real_one
from labkit.ros2.streams import tell
from labkit.rosgraph import interfaces
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.listings import NamesAndTypes, action_types, actions
from labkit.rosgraph.message_yaml import fill, prototype, read_yaml, to_yaml
from labkit.rosgraph.refusals import Refusal, Refused
from labkit.rosgraph.servers import action_ends

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['COMMAND']

# Time for a server to end a canceled goal, s.
CANCEL_SEC = 5.0
_STATUS = {
    GoalStatus.STATUS_ACCEPTED: 'ACCEPTED',
    GoalStatus.STATUS_EXECUTING: 'EXECUTING',
    GoalStatus.STATUS_CANCELING: 'CANCELING',
    GoalStatus.STATUS_SUCCEEDED: 'SUCCEEDED',
    GoalStatus.STATUS_CANCELED: 'CANCELED',
    GoalStatus.STATUS_ABORTED: 'ABORTED',
}


def list_actions(args: Namespace) -> None:
    """Print the names of the actions."""
    found = known_names(args, 'actions')
    print_names(args, found, args.count_actions)


def show_info(args: Namespace) -> None:
    """Print the nodes at both ends of an action."""
    node = asking_node(args)
    name = full_name(args.action_name, node)
    nobody = f'Action: {args.action_name}\nAction clients: 0\nAction servers: 0'
    with real_one(says='', shows=nobody, code=0):
        _types_of(node, name)
    ends = poll_until(lambda: action_ends(node, name))
    print(f'Action: {args.action_name}')
    _print_ends('clients', ends.clients, args)
    _print_ends('servers', ends.servers, args)


def _print_ends(what: str, found: NamesAndTypes, args: Namespace) -> None:
    print(f'Action {what}: {len(found)}')
    for name, types in [] if args.count else found:
        print(f'    {name} [{", ".join(types)}]' if args.show_types else f'    {name}')


def show_type(args: Namespace) -> None:
    """Print the type of an action."""
    node = asking_node(args)
    name = full_name(args.action_name, node)
    with real_one(says=''):
        types = _types_of(node, name)
    print('\n'.join(types))


def send_goal(args: Namespace) -> None:
    """Send a goal, and print whether it is accepted, its feedback and its result."""
    action_type = interfaces.action_class(args.action_type)
    goal = action_type.Goal()
    fill(goal, read_yaml(values_text(args, 'action send_goal', args.goal)))
    node = asking_node(args)
    name = full_name(args.action_name, node)
    _check_type(node, name, type_name(action_type))
    limit = settings.audience().patience_sec
    with ActionGoals(node, action_type, name) as goals:
        tell('Waiting for an action server to become available...')
        if not goals.wait_until_ready(limit):
            # This client has put the name into the graph, too.
            names = [other for other, _ in actions(node) if other != name]
            raise LabError(f'{name} has no server.', todo=unknown(name, names, 'action'))
        tell(f'Sending goal:\n     {to_yaml(goal)}')
        feedback: queue.SimpleQueue[Any] = queue.SimpleQueue()

        def show_feedback() -> None:
            while not feedback.empty():
                tell(f'Feedback:\n    {to_yaml(feedback.get().feedback)}')

        handle = goals.send(goal, limit, feedback=feedback.put if args.feedback else None)
        if not handle.accepted:
            print('Goal was rejected.')
            return
        tell(f'Goal accepted with ID: {shown_id(handle)}\n')
        try:
            result = goals.result(handle, limit, between=show_feedback)
        except (KeyboardInterrupt, LabError):
            _cancel(goals, handle)
            raise
        print(f'Result:\n    {to_yaml(result.result)}')
        print(f'Goal finished with status: {_STATUS.get(result.status, "UNKNOWN")}')


def _cancel(goals: ActionGoals, handle: Any) -> None:
    if not goals.wait_until_ready(0.0):
        return
    tell('Canceling goal...')
    try:
        accepted = goals.cancel(handle, CANCEL_SEC)
    except LabError as error:
        print(error, file=sys.stderr)
        return
    if accepted:
        print('Goal canceled.')
    else:
        print('Failed to cancel goal: the server goes on with it.', file=sys.stderr)


def _check_type(node: Node, name: str, wanted: str) -> None:
    """Raise a LabError if an action exists with another type: the goal would never arrive."""
    types = poll_until(lambda: action_types(node, name), 0.3)
    if types and wanted not in types:
        raise Refused(
            f'{name} is of type {", ".join(types)}, not {wanted}.', reason=Refusal.OTHER_TYPE
        )
    if not types:
        hint = unknown(name, [other for other, _ in actions(node)], 'action')
        if hint.startswith('Did you mean'):
            print(hint, file=sys.stderr, flush=True)


def _types_of(node: Node, name: str) -> list[str]:
    types = poll_until(lambda: action_types(node, name))
    if not types:
        names = [other for other, _ in actions(node)]
        raise LabError(f"Unknown action '{name}'", todo=unknown(name, names, 'action'))
    return types


def _prototype(args: Namespace) -> Iterable[str]:
    action_type = interfaces.action_class(getattr(args, 'action_type', '') or '')
    return [f'"{prototype(action_type.Goal)}"']


def _name_argument(parser: Parser, text: str) -> None:
    add_discovery_options(parser)
    parser.add('action_name', help=text, complete=action_names)


def _types_option(parser: Parser) -> None:
    parser.flag('-t, --show-types', 'Additionally show the action type')


def _list_arguments(parser: Parser) -> None:
    add_discovery_options(parser)
    _types_option(parser)
    parser.flag('-c, --count-actions', 'Only display the number of actions discovered')


def _info_arguments(parser: Parser) -> None:
    _name_argument(parser, "Name of the ROS action to get info (e.g. '/fibonacci')")
    _types_option(parser)
    parser.flag('-c, --count', 'Only display the number of action clients and action servers')


def _type_arguments(parser: Parser) -> None:
    _name_argument(parser, "Name of the ROS action to get type (e.g. '/fibonacci')")


def _goal_arguments(parser: Parser) -> None:
    _name_argument(parser, "Name of the ROS action (e.g. '/fibonacci')")
    parser.add(
        'action_type',
        help="Type of the ROS action (e.g. 'test_msgs/action/Fibonacci')",
        complete=types_of_action,
    )
    parser.add(
        'goal',
        nargs='?',
        default='{}',
        help="Goal request values in YAML format (e.g. '{order: 10}')",
        complete=_prototype,
    )
    parser.flag('--stdin', 'Read goal from standard input')
    parser.flag('-f, --feedback', 'Echo feedback messages for the goal')


COMMAND = Command(
    'action',
    'Various action related sub-commands',
    (
        Verb('info', 'Print information about an action', show_info, _info_arguments),
        Verb('list', 'Output a list of action names', list_actions, _list_arguments),
        Verb('send_goal', 'Send an action goal', send_goal, _goal_arguments),
        Verb('type', "Print an action's type", show_type, _type_arguments),
    ),
)
