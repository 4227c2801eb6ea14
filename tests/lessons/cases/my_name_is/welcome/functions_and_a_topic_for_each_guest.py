import rclpy
from std_msgs.msg import String

import labkit as lab


def relay(name, hears, says, ending):
    node = rclpy.create_node(name)
    publisher = node.create_publisher(String, says, 10)

    def answer(text):
        publisher.publish(String(data=text.data + ending))

    for topic in hears:
        node.create_subscription(String, topic, answer, 10)
    lab.spin(node)


relay('eve', ['/incomplete'], '/says_eve', 'Eve')
relay('finn', ['/incomplete'], '/says_finn', 'Finn')
relay('door', ['/says_eve', '/says_finn'], '/welcome', '. Welcome!')
