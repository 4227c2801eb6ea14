"""The nodes with a life cycle that a launch has started: asked to change, and listened to.

It takes a node of ROS, in the process that launches; that is started with the first of them.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from labkit.launching.lifecycle_nodes import ChangeState, LifecycleNode, StateTransition
from labkit.launching.model import Action

__all__ = ['ManagedNodes']

# Who says so in the real one.
WHO = 'launch_ros.utilities.lifecycle_event_manager'
# How often to look whether a service is there: its coming is not told.
LOOK_SEC = 0.05
# After which to ask for the state again: who has not discovered this process yet drops its answer.
AGAIN_SEC = 0.5


class _Managed:
    """What is needed of ROS for one node."""

    def __init__(self, action: LifecycleNode, node: Any, hear: Callable[[Any], None]) -> None:
        from lifecycle_msgs.msg import TransitionEvent
        from lifecycle_msgs.srv import ChangeState, GetState

        self.action, self.name = action, action.node_name
        # In this order: the other process discovers them in it, so when it has answered the last
        # client, it knows the others, and neither a transition nor an answer is lost.
        topic = f'{self.name}/transition_event'
        self.subscription = node.create_subscription(TransitionEvent, topic, hear, 10)
        self.change = node.create_client(ChangeState, f'{self.name}/change_state')
        self.state = node.create_client(GetState, f'{self.name}/get_state')
        self.turn = asyncio.Lock()

    @property
    def is_ready(self) -> bool:
        """Whether its services are there."""
        return bool(self.change.service_is_ready() and self.state.service_is_ready())


@dataclass
class _Request:
    """A transition that is asked of a node; whether all but the answer is there."""

    one: _Managed
    number: int
    sent: bool = False


class ManagedNodes:
    """The nodes with a life cycle of a launch.

    Args:
        loop: The loop of the launch.
        say: Shows a line: level, who, text.
        emit: Is given each state that a node tells, in the loop.
        runs: Says whether the program of an action runs, or is about to.
    """

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        say: Callable[[str, str, str], None],
        emit: Callable[[StateTransition], None],
        runs: Callable[[Action], bool],
    ) -> None:
        self._loop, self._say, self._emit, self._runs = loop, say, emit, runs
        self._nodes: list[_Managed] = []
        self._requests: dict[asyncio.Task[None], _Request] = {}

    def watch(self, action: LifecycleNode) -> None:
        """Listen to a node from now on, before it is there."""
        from labkit.background.runtime import runtime

        runtime.start()

        def hear(msg: Any) -> None:
            event = StateTransition(action=action, msg=msg)
            self._loop.call_soon_threadsafe(self._emit, event)

        self._nodes.append(_Managed(action, runtime.helper, hear))

    def change(self, event: ChangeState) -> None:
        """Ask the nodes that an event is about for a transition."""
        name = event.valid_transitions[event.transition_id]
        meant = [one for one in self._nodes if event.lifecycle_node_matcher(one.action)]
        if not meant:
            self._say('WARNING', 'launch', f'{name} is asked of no LifecycleNode that was started')
        for one in meant:
            if not self._runs(one.action):
                self._say('WARNING', WHO, f"{name} can't be asked of {one.name}: it has ended")
                continue
            request = _Request(one, event.transition_id)
            task = self._loop.create_task(self._change(request))
            self._requests[task] = request
            task.add_done_callback(self._end)

    def _end(self, task: asyncio.Task[None]) -> None:
        self._requests.pop(task, None)
        if not task.cancelled():
            task.result()

    async def _change(self, request: _Request) -> None:
        from lifecycle_msgs.srv import ChangeState as Change
        from lifecycle_msgs.srv import GetState

        one = request.one
        async with one.turn:  # in the order in which they were asked for
            while not one.is_ready:
                await asyncio.sleep(LOOK_SEC)
            before = await self._answer(one.state, GetState.Request(), AGAIN_SEC)
            request.sent = True
            asked = Change.Request()
            asked.transition.id = request.number
            if (await self._answer(one.change, asked)).success:
                return
        self._say(
            'ERROR',
            WHO,
            f"Failed to make transition '{ChangeState.valid_transitions[request.number]}' for "
            f"LifecycleNode '{one.name}', which was {before.current_state.label}",
        )

    async def _answer(self, client: Any, request: Any, again_sec: float | None = None) -> Any:
        """Return the answer of a service; one that changes nothing may be asked again."""
        answered = self._loop.create_future()

        def note(future: Any) -> None:
            if not answered.done():
                answered.set_result(future)

        def hear(future: Any) -> None:
            self._loop.call_soon_threadsafe(note, future)

        while not answered.done():
            client.call_async(request).add_done_callback(hear)
            await asyncio.wait([answered], timeout=again_sec)
        return answered.result().result()

    def abandon(self, why: str, action: Action | None = None) -> None:
        """Wait no more for the node of an action; without one, for all that can't be asked yet.

        Args:
            why: The reason, `''` if nobody wants to know.
            action: The action.
        """
        for task, request in list(self._requests.items()):
            if request.one.action is action or (action is None and not request.sent):
                del self._requests[task]
                task.cancel()
                what = 'service response' if request.sent else 'service'
                name = f'{request.one.name}/change_state'
                text = f"Abandoning wait for the '{name}' {what}, due to {why}."
                if why:
                    self._say('WARNING', WHO, text)

    def close(self) -> None:
        """End what was started of ROS."""
        if self._nodes:
            from labkit.background.runtime import runtime

            runtime.stop()
