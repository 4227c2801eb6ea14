"""Nodes with a life cycle in launch files: what is asked of them, and what they tell.

They are unconfigured, inactive or active, and change by transitions that others ask for. Names and
numbers are those of `lifecycle_msgs`: `msg/Transition` and `msg/State`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, ClassVar

from labkit.launching import events
from labkit.launching.actions import EmitEvent, setting
from labkit.launching.event_handlers import BaseEventHandler, EventHandler
from labkit.launching.model import Action, Context, LaunchError, perform, pieces, placed
from labkit.launching.ros_actions import Node

__all__ = [
    'ChangeState',
    'LifecycleNode',
    'LifecycleTransition',
    'OnStateTransition',
    'StateTransition',
    'matches_node_name',
]

CONFIGURE, ACTIVATE = 1, 3
# Transition -> the state in which a node is meanwhile, and the one that is reached.
_WAYS = {
    CONFIGURE: ('configuring', 'inactive'),
    2: ('cleaningup', 'unconfigured'),
    ACTIVATE: ('activating', 'active'),
    4: ('deactivating', 'inactive'),
    5: ('shuttingdown', 'finalized'),
    6: ('shuttingdown', 'finalized'),
    7: ('shuttingdown', 'finalized'),
}
_FAILED = 'errorprocessing'


class ChangeState(events.Event):
    """Nodes with a life cycle are to make a transition.

    Args:
        lifecycle_node_matcher: Which of them, as a function of the action.
        transition_id: The number of the transition.
    """

    name: ClassVar[str] = 'launch_ros.events.lifecycle.ChangeState'
    valid_transitions: ClassVar[dict[int, str]] = {
        0: 'TRANSITION_CREATE',
        CONFIGURE: 'TRANSITION_CONFIGURE',
        2: 'TRANSITION_CLEANUP',
        ACTIVATE: 'TRANSITION_ACTIVATE',
        4: 'TRANSITION_DEACTIVATE',
        5: 'TRANSITION_UNCONFIGURED_SHUTDOWN',
        6: 'TRANSITION_INACTIVE_SHUTDOWN',
        7: 'TRANSITION_ACTIVE_SHUTDOWN',
        8: 'TRANSITION_DESTROY',
    }
    valid_states: ClassVar[dict[int, str]] = {
        0: 'PRIMARY_STATE_UNKNOWN',
        1: 'PRIMARY_STATE_UNCONFIGURED',
        2: 'PRIMARY_STATE_INACTIVE',
        3: 'PRIMARY_STATE_ACTIVE',
        4: 'PRIMARY_STATE_FINALIZED',
        10: 'TRANSITION_STATE_CONFIGURING',
        11: 'TRANSITION_STATE_CLEANINGUP',
        12: 'TRANSITION_STATE_SHUTTINGDOWN',
        13: 'TRANSITION_STATE_ACTIVATING',
        14: 'TRANSITION_STATE_DEACTIVATING',
        15: 'TRANSITION_STATE_ERRORPROCESSING',
    }

    def __init__(
        self, *, lifecycle_node_matcher: Callable[[Any], bool], transition_id: int
    ) -> None:
        if transition_id not in self.valid_transitions:
            raise _unknown(transition_id, self.valid_transitions)
        self.lifecycle_node_matcher = lifecycle_node_matcher
        self.transition_id = transition_id


class StateTransition(events.Event):
    """A node with a life cycle has changed its state.

    Attributes:
        action: The action that has started it.
        msg: What the node has published, of the type `lifecycle_msgs/msg/TransitionEvent`.
        timestamp: When, as the node says; s and ns, or 0.
        transition: The label of the transition; most nodes leave it empty.
        start_state: The state before, such as `'activating'`.
        goal_state: The state now, such as `'active'`.
    """

    name: ClassVar[str] = 'launch_ros.events.lifecycle.StateTransition'

    def __init__(self, *, action: LifecycleNode, msg: Any) -> None:
        self.action, self.msg, self.timestamp = action, msg, msg.timestamp
        self.transition = msg.transition.label
        self.start_state, self.goal_state = msg.start_state.label, msg.goal_state.label


def matches_node_name(node_name: str) -> Callable[[Any], bool]:
    """Return a function that chooses the action of the node with a full name."""
    name = absolute(node_name)
    return lambda action: bool(action.node_name == name)


def absolute(node_name: str) -> str:
    """Return the name of a node with a slash before it."""
    return node_name if node_name.startswith('/') else f'/{node_name}'


class LifecycleNode(Node):
    """Start a node with a life cycle: `<lifecycle_node>`.

    Args:
        name: The name of the node; it must be known here.
        namespace: Its namespace.
        autostart: Whether it is to be configured and activated at once.
        options: See `Node`.
    """

    is_lifecycle_node = True

    def __init__(
        self, *, name: Any, namespace: Any, autostart: Any = False, **options: Any
    ) -> None:
        super().__init__(name=name, namespace=namespace, **options)
        if name is None:
            raise LaunchError('A LifecycleNode needs a name.', place=self.place)
        self.node_autostart = autostart

    def execute(self, context: Context) -> Sequence[Action] | None:
        super().execute(context)
        starts = setting(context, self.node_autostart, 'bool')
        if not self._executed:
            return None
        context.managed.append(self)
        if not starts:
            return None
        both = LifecycleTransition(
            lifecycle_node_names=[self.node_name], transition_ids=[CONFIGURE, ACTIVATE]
        )
        both.place = self.place
        return [both]


class LifecycleTransition(Action):
    """Let nodes make transitions one after the other, each when the one before has succeeded.

    Args:
        lifecycle_node_names: Full names of the nodes.
        transition_ids: The numbers of the transitions.
    """

    def __init__(
        self,
        *,
        lifecycle_node_names: Iterable[Any],
        transition_ids: Iterable[Any],
        **options: Any,
    ) -> None:
        super().__init__(**options)
        given = {'lifecycle_node_names': lifecycle_node_names, 'transition_ids': transition_ids}
        for word, value in given.items():
            if isinstance(value, str) or not value:
                raise LaunchError(
                    f'{word} is a list of one or more, and this is {value!r}.', place=self.place
                )
        self._names = [pieces(name) for name in lifecycle_node_names]
        self._ids = [pieces(str(one) if isinstance(one, int) else one) for one in transition_ids]

    def execute(self, context: Context) -> Sequence[Action]:
        ids = []
        for text in (perform(context, one) for one in self._ids):
            if not text.isdecimal() or int(text) not in _WAYS:
                raise _unknown(text, _WAYS)
            ids.append(int(text))
        rows = [_Row(absolute(perform(context, name)), ids) for name in self._names]
        for row in rows:
            context.register_event_handler(row)
        return [row.next() for row in rows]


def _unknown(given: object, known: Iterable[int]) -> LaunchError:
    names = ChangeState.valid_transitions
    return LaunchError(
        f'{given!r} is no number of a transition.',
        todo=f'There are: {", ".join(f"{number} ({names[number]})" for number in known)}. '
        'lifecycle_msgs.msg.Transition has them by these names.',
        place=placed(),
    )


class _Row(BaseEventHandler):
    """Transitions of one node: the next one is asked for when the last one has succeeded."""

    def __init__(self, node_name: str, ids: Sequence[int]) -> None:
        super().__init__(matcher=lambda event: isinstance(event, StateTransition))
        self._node_name, self._left = node_name, list(ids)

    def matches(self, event: events.Event) -> bool:
        return isinstance(event, StateTransition) and event.action.node_name == self._node_name

    def next(self) -> Action:
        """Return the action that asks for the transition that is due."""
        event = ChangeState(
            lifecycle_node_matcher=matches_node_name(self._node_name),
            transition_id=self._left[0],
        )
        return EmitEvent(event=event)

    def handle(self, event: Any, context: Context) -> Action | None:
        super().handle(event, context)
        if event.goal_state == _FAILED:
            context.say(
                'INFO',
                'launch_ros.actions.lifecycle_transition',
                f"Stopping transitions for {self._node_name} because 'error occurred during "
                "transitions'",
            )
            self._left.clear()
        elif (event.start_state, event.goal_state) == _WAYS[self._left[0]]:
            del self._left[0]
        else:
            return None
        if self._left:
            return self.next()
        context.unregister_event_handler(self)
        return None


class OnStateTransition(EventHandler):
    """Handle that a node with a life cycle has changed its state.

    Args:
        entities: The actions.
        target_lifecycle_node: The action of the node, None for any.
        transition: The label of the transition, None for any.
        start_state: The state before, None for any.
        goal_state: The state now, None for any.
        matcher: A function of the event that says instead of these whether it is meant.
    """

    def __init__(
        self,
        *,
        entities: Any,
        target_lifecycle_node: LifecycleNode | None = None,
        transition: str | None = None,
        start_state: str | None = None,
        goal_state: str | None = None,
        matcher: Callable[[events.Event], bool] | None = None,
        **options: Any,
    ) -> None:
        if not isinstance(target_lifecycle_node, (LifecycleNode, type(None))):
            raise LaunchError(
                'target_lifecycle_node of OnStateTransition is a LifecycleNode, and this is '
                f'{target_lifecycle_node!r}.',
                place=placed(),
            )
        wanted = {
            'action': target_lifecycle_node,
            'transition': transition,
            'start_state': start_state,
            'goal_state': goal_state,
        }

        def is_meant(event: events.Event) -> bool:
            return isinstance(event, StateTransition) and all(
                value is None or getattr(event, word) == value for word, value in wanted.items()
            )

        super().__init__(entities=entities, matcher=matcher or is_meant, **options)
