# In a terminal:
cd ros2_ws/src
ros2 pkg create ears_lab --build-type ament_python --node-name listener \
    --dependencies rclpy std_msgs
# In the editor, instead of what is in ears_lab/ears_lab/listener.py:
cat > ears_lab/ears_lab/listener.py << END
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Listener(Node):
    def __init__(self):
        super().__init__('listener')
        self.subscription = self.create_subscription(String, 'chatter', self.on_chatter, 10)

    def on_chatter(self, msg):
        self.get_logger().info(f'I heard: {msg.data}')


def main():
    rclpy.init()
    node = Listener()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
END
# A new file, ears_lab/launch/ears.launch.xml:
mkdir ears_lab/launch
cat > ears_lab/launch/ears.launch.xml << END
<launch>
  <node pkg="ears_lab" exec="listener"/>
</launch>
END
# In the editor, one more line in data_files of ears_lab/setup.py. The same by a command:
line="('share/ears_lab/launch', ['launch/ears.launch.xml']),"
sed -i "s|data_files=\[|&$line|" ears_lab/setup.py
# In the terminal:
cd ..
colcon build --packages-select ears_lab
# In the second terminal, after: cd ros2_ws
source install/setup.bash
ros2 run ears_lab listener > listener.log 2>&1 &
