import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String


class Ear(Node):
    def __init__(self, name):
        super().__init__(name)
        self.publisher = self.create_publisher(String, 'sound', 10)
        self.timer = self.create_timer(0.2, self.listen)

    def listen(self):
        self.publisher.publish(String(data=f'{self.get_name()} hears rain'))


rclpy.init()
executor = SingleThreadedExecutor()
for ear in [Ear('left_ear'), Ear('right_ear')]:
    executor.add_node(ear)
executor.spin()
