from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Ear(Node):
    def __init__(self, name):
        super().__init__(name)
        self.publisher = self.create_publisher(String, 'sound', 10)
        self.timer = self.create_timer(0.2, self.listen)

    def listen(self):
        self.publisher.publish(String(data=f'{self.get_name()}: a dog'))


left_ear = lab.spin(Ear('left_ear'))
right_ear = lab.spin(Ear('right_ear'))
