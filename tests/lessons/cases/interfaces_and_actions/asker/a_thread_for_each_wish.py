import threading

from rclpy.action import ActionClient
from rclpy.node import Node
from std_msgs.msg import Int16, Int32
from test_msgs.action import Fibonacci

import labkit as lab


class Asker(Node):
    def __init__(self):
        super().__init__('asker')
        self.client = ActionClient(self, Fibonacci, 'add_up')
        self.publisher = self.create_publisher(Int32, 'sum', 10)
        self.create_subscription(Int16, 'wish', self.on_wish, 10)

    def on_wish(self, msg):
        threading.Thread(target=self.ask, args=(msg.data,), daemon=True).start()

    def ask(self, order):
        answer = self.client.send_goal(Fibonacci.Goal(order=order))
        self.publisher.publish(Int32(data=answer.result.sequence[-1]))


lab.spin(Asker())
