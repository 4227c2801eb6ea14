# In a terminal:
cd ros2_ws/src
ros2 pkg create beacon_lab --build-type ament_python --node-name beacon \
    --dependencies rclpy std_msgs
rm beacon_lab/test/*
# In the editor, instead of what is in beacon_lab/beacon_lab/beacon.py:
cat > beacon_lab/beacon_lab/beacon.py << END
import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Bool

LATE = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Beacon(Node):
    def __init__(self):
        super().__init__('beacon')
        self.publisher = self.create_publisher(Bool, 'lit', LATE)
        self.publisher.publish(Bool(data=True))


def main():
    rclpy.init()
    node = Beacon()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
END
# A new file, beacon_lab/test/test_beacon.py:
cat > beacon_lab/test/test_beacon.py << END
import rclpy
from beacon_lab.beacon import Beacon


def test_name():
    rclpy.init()
    assert Beacon().get_name() == 'beacon'
    rclpy.shutdown()
END
# In the terminal:
cd ..
colcon build --packages-select beacon_lab
colcon test --packages-select beacon_lab
# In the second terminal, after: cd ros2_ws
source install/setup.bash
ros2 run beacon_lab beacon > beacon.log 2>&1 &
