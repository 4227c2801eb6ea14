from rclpy.node import Node
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool

import labkit as lab


class Porter(Node):
    def __init__(self):
        super().__init__('porter')
        self.client = self.create_client(SetBool, 'move_door')
        self.publisher = self.create_publisher(String, 'news', 10)
        self.subscription = self.create_subscription(Bool, 'wish', self.on_wish, 10)

    def on_wish(self, msg):
        future = self.client.call_async(SetBool.Request(data=msg.data))
        future.add_done_callback(self.on_response)

    def on_response(self, future):
        self.publisher.publish(String(data=future.result().message))


lab.spin(Porter())
