"""A calculator that serves an action: it adds numbers, and multiplies the sum by its factor."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from labkit.lessons._partner import take_time

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['make_calculator']


def make_calculator() -> Node:
    """Return a node that serves `/add_up` (`test_msgs/action/Fibonacci`).

    The result of a goal are the sums of the numbers from 1 to `order`, each times `factor`. It
    takes a moment, see `take_time`. A goal that is canceled meanwhile ends with its first sum.
    """
    from rclpy.action.server import ActionServer, CancelResponse
    from rclpy.node import Node
    from test_msgs.action import Fibonacci

    class Calculator(Node):
        def __init__(self) -> None:
            super().__init__('calculator')
            self.factor = 1
            self.asked: list[int] = []
            self.canceled: list[int] = []
            ActionServer(  # type: ignore[no-untyped-call]
                self,
                Fibonacci,
                'add_up',
                self.execute,
                cancel_callback=lambda handle: CancelResponse.ACCEPT,
            )

        async def execute(self, handle: Any) -> Any:
            self.asked.append(handle.request.order)
            await take_time(self)
            sums = [self.factor * n * (n + 1) // 2 for n in range(1, handle.request.order + 1)]
            handle.publish_feedback(Fibonacci.Feedback(sequence=sums[:1]))
            if handle.is_cancel_requested:
                self.canceled.append(handle.request.order)
                handle.canceled()
                return Fibonacci.Result(sequence=sums[:1])
            handle.succeed()
            return Fibonacci.Result(sequence=sums)

    return Calculator()
