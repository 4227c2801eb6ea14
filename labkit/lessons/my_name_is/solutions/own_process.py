from labkit.lessons.my_name_is.programs import start_program

program = r'''
"""Say how a sentence begins, twice a second."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Opener(Node):
    def __init__(self):
        super().__init__('opener')
        self.publisher = self.create_publisher(String, 'incomplete', 10)
        self.timer = self.create_timer(0.5, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data='My name is '))


rclpy.init()
rclpy.spin(Opener())
'''

process = start_program(program)
