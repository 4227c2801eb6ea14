import queue
import threading

from rclpy.node import Node
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool

import labkit as lab


class Porter(Node):
    def __init__(self):
        super().__init__('porter')
        self.wishes = queue.Queue()
        self.client = self.create_client(SetBool, 'move_door')
        self.publisher = self.create_publisher(String, 'news', 10)
        self.create_subscription(Bool, 'wish', self.on_wish, 10)
        threading.Thread(target=self.work, daemon=True).start()

    def on_wish(self, msg):
        self.wishes.put(msg.data)

    def work(self):
        while True:
            wish = self.wishes.get()
            response = self.client.call(SetBool.Request(data=wish))
            self.publisher.publish(String(data=response.message))


lab.spin(Porter())
