from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Inspector(Node):
    def __init__(self):
        super().__init__('inspector')
        self.publisher = self.create_publisher(String, 'wrong_gate', 10)
        self.timer = self.create_timer(0.2, self.on_timer)

    def on_timer(self):
        for info in self.get_publishers_info_by_topic('/visitors'):
            if info.topic_type != 'std_msgs/msg/Int16':
                self.publisher.publish(String(data=info.node_name))


inspector = lab.spin(Inspector())
