from rclpy.node import Node
from std_srvs.srv import SetBool

import labkit as lab


class Bulb(Node):
    def __init__(self):
        super().__init__('bulb')
        self.service = self.create_service(SetBool, 'switch_lamp', self.on_switch)
        self.is_on = False

    def on_switch(self, request, response):
        response.success = request.data != self.is_on
        self.is_on = request.data
        response.message = 'on' if self.is_on else 'off'
        return response


lab.spin(Bulb())
lab.spin(Node('lamp'))
