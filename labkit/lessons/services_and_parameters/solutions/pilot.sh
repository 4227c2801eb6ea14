# In the editor, a new file nodes/pilot.py:
mkdir -p nodes
cat > nodes/pilot.py << END
import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class Pilot(Node):
    def __init__(self):
        super().__init__('pilot')
        self.declare('speed', 0.05, 'Speed ahead, in m/s')
        self.declare('limit', 0.1, 'Greatest speed, in m/s')
        self.add_on_set_parameters_callback(self.on_set)
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.on_timer)

    def declare(self, name, value, description):
        self.declare_parameter(name, value, ParameterDescriptor(description=description))

    def on_set(self, parameters):
        values = {name: self.get_parameter(name).value for name in ('speed', 'limit')}
        values.update({p.name: p.value for p in parameters if p.name in values})
        if 0.0 <= values['speed'] <= values['limit']:
            return SetParametersResult(successful=True)
        return SetParametersResult(successful=False, reason='speed must be from 0.0 to limit')

    def on_timer(self):
        msg = Twist()
        msg.linear.x = self.get_parameter('speed').value
        self.publisher.publish(msg)


def main():
    rclpy.init()
    try:
        rclpy.spin(Pilot())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
END
# In a terminal, after the line with export:
python3 nodes/pilot.py > pilot.log 2>&1 &
