"""A door of which a service is the only handle: it moves, and its keeper says what was done."""

from __future__ import annotations

from rclpy.node import Node
from std_srvs.srv import SetBool

__all__ = ['Door']


class Door(Node):
    """Serves `/move_door`: true opens it, false closes it.

    Attributes:
        keeper: Who looks after it; the responses name them.
        calls: What was asked for, in the order of the calls.
    """

    def __init__(self) -> None:
        super().__init__('door')
        self.keeper = 'Ada'
        self.calls: list[bool] = []
        self.create_service(SetBool, 'move_door', self.on_move)

    def on_move(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Move it."""
        self.calls.append(request.data)
        response.success = True
        response.message = f'{self.keeper} {"opened" if request.data else "closed"} the door'
        return response
