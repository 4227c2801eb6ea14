"""A door of which a service is the only handle: it moves, and its keeper says what was done."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from labkit.lessons._partner import take_time

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['make_door']

KEEPER = 'Ada'


def make_door() -> Node:
    """Return a node that serves `/move_door`: true opens the door, false closes it.

    That takes a moment, see `take_time`, and the response comes when it is done.
    Its `keeper` is named in the responses, which succeed if the door has moved, and `asked` holds
    what was asked for.
    """
    from rclpy.node import Node
    from std_srvs.srv import SetBool

    class Door(Node):
        def __init__(self) -> None:
            super().__init__('door')
            self.keeper = KEEPER
            self.asked: list[bool] = []
            self.is_open = False
            self.create_service(SetBool, 'move_door', self.on_move)

        async def on_move(self, request: Any, response: Any) -> Any:
            self.asked.append(request.data)
            await take_time(self)
            response.success = request.data != self.is_open
            self.is_open = request.data
            response.message = f'{self.keeper} {"opened" if request.data else "closed"} the door'
            return response

    return Door()
