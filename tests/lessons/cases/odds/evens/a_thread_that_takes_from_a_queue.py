import queue
import threading

import rclpy
from std_msgs.msg import Int16

import labkit as lab

node = rclpy.create_node('worker')
publisher = node.create_publisher(Int16, 'evens', 10)
todo = queue.Queue()
node.create_subscription(Int16, 'odds', lambda msg: todo.put(msg.data), 10)


def work(todo, publisher):
    while rclpy.ok():
        publisher.publish(Int16(data=todo.get() + 1))


threading.Thread(target=work, args=[todo, publisher], daemon=True).start()
lab.spin(node)
