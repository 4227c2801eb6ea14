import threading

import rclpy
from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class LeftEar(Node):
    def __init__(self):
        super().__init__('left_ear')
        self.pub = self.create_publisher(String, 'sound', 10)


class RightEar(Node):
    def __init__(self):
        super().__init__('right_ear')
        self.pub = self.create_publisher(String, 'sound', 10)


ears = [lab.spin(LeftEar()), lab.spin(RightEar())]
stop = threading.Event()


def work(ears):
    while not stop.wait(0.2) and rclpy.ok():
        for ear in ears:
            try:
                ear.pub.publish(String(data='wind'))
            except Exception:
                return


threading.Thread(target=work, args=(ears,), daemon=True).start()
