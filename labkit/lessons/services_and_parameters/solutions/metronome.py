from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.node import Node
from std_msgs.msg import Empty

import labkit as lab


class Metronome(Node):
    def __init__(self):
        super().__init__('metronome')
        descriptor = ParameterDescriptor(
            description='Ticks a second, in Hz',
            floating_point_range=[FloatingPointRange(from_value=1.0, to_value=20.0)],
        )
        self.declare_parameter('rate', 2.0, descriptor)
        self.publisher = self.create_publisher(Empty, 'tick', 10)
        self.start_timer(2.0)
        self.add_post_set_parameters_callback(self.on_change)

    def start_timer(self, rate):
        self.timer = self.create_timer(1.0 / rate, self.on_timer)

    def on_change(self, parameters):
        for parameter in parameters:
            if parameter.name == 'rate':
                self.destroy_timer(self.timer)
                self.start_timer(parameter.value)

    def on_timer(self):
        self.publisher.publish(Empty())


lab.spin(Metronome())
