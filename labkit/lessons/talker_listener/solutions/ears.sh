# In the editor, a new file nodes/ear.py:
cat > nodes/ear.py << END
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Ear(Node):
    def __init__(self):
        super().__init__('ear')
        self.publisher = self.create_publisher(String, 'sound', 10)
        self.timer = self.create_timer(0.2, self.listen)

    def listen(self):
        self.publisher.publish(String(data=f'{self.get_name()}: a dog'))


def main():
    rclpy.init()
    try:
        rclpy.spin(Ear())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
END
# In a terminal, after the line with export:
python3 nodes/ear.py --ros-args -r __node:=left_ear > left_ear.log 2>&1 &
# In a second terminal, after that line, too:
python3 nodes/ear.py --ros-args -r __node:=right_ear > right_ear.log 2>&1 &
