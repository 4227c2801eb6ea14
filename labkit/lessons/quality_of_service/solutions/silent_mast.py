from rclpy.node import Node
from rclpy.qos import QoSCompatibility, qos_check_compatible, qos_profile_sensor_data
from std_msgs.msg import Int16

import labkit as lab

LINKS = [('level', 'level_a'), ('level_a', 'level_b'), ('level_b', 'level_c')]


class SpareMast(Node):
    def __init__(self):
        super().__init__('spare_mast')
        hears, says = self.silent_link()
        self.publisher = self.create_publisher(Int16, says, 10)
        self.subscription = self.create_subscription(
            Int16, hears, self.on_level, qos_profile_sensor_data
        )

    def silent_link(self):
        for hears, says in LINKS:
            (source,) = self.get_publishers_info_by_topic(hears)
            (mast,) = self.get_subscriptions_info_by_topic(hears)
            fits, reason = qos_check_compatible(source.qos_profile, mast.qos_profile)
            if fits == QoSCompatibility.ERROR:
                print(f'{mast.node_name} does not hear {source.node_name}: {reason}')
                return hears, says

    def on_level(self, msg):
        self.publisher.publish(msg)


spare_mast = lab.spin(SpareMast())
