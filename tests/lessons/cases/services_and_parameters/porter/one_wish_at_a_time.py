from collections import deque

from rclpy.node import Node
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool

import labkit as lab


class Porter(Node):
    def __init__(self):
        super().__init__('porter')
        self.wishes = deque()
        self.is_busy = False
        self.client = self.create_client(SetBool, 'move_door')
        self.publisher = self.create_publisher(String, 'news', 10)
        self.create_subscription(Bool, 'wish', self.on_wish, 10)

    def on_wish(self, msg):
        self.wishes.append(msg.data)
        self.ask()

    def ask(self):
        if self.is_busy or not self.wishes:
            return
        self.is_busy = True
        future = self.client.call_async(SetBool.Request(data=self.wishes.popleft()))
        future.add_done_callback(self.on_response)

    def on_response(self, future):
        self.publisher.publish(String(data=future.result().message))
        self.is_busy = False
        self.ask()


lab.spin(Porter())
