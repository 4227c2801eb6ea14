# In the editor, a new file nodes/stage_one.py:
mkdir -p nodes
cat > nodes/stage_one.py << END
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class StageOne(Node):
    def __init__(self):
        super().__init__('stage_one')
        self.publisher = self.create_publisher(String, 'incomplete', 10)
        self.timer = self.create_timer(0.5, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data='My name is '))


def main():
    rclpy.init()
    try:
        rclpy.spin(StageOne())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
END
# In a terminal, after the line with export:
python3 nodes/stage_one.py > stage_one.log 2>&1 &
