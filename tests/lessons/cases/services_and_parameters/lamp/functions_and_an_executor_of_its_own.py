import threading

import rclpy
from rclpy.executors import SingleThreadedExecutor
from std_srvs.srv import SetBool

node = rclpy.create_node('lamp')
state = {'on': False}


def on_switch(request, response):
    response.success = state['on'] is not request.data
    state['on'] = request.data
    response.message = ('off', 'on')[request.data]
    return response


node.create_service(SetBool, '/switch_lamp', on_switch)
executor = SingleThreadedExecutor()
executor.add_node(node)
threading.Thread(target=executor.spin, daemon=True).start()
