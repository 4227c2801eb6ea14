from rclpy.node import Node
from std_msgs.msg import Int16

import labkit as lab

counter = Node('counter', cli_args=['--ros-args', '-r', 'number:=/ones'])
publisher = counter.create_publisher(Int16, 'number', 10)
counter.create_timer(0.1, lambda: publisher.publish(Int16(data=1)))
lab.spin(counter)
