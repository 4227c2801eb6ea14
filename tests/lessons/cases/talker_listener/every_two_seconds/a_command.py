import subprocess
import sys

options = ['--rate', '0.5', '--times', '600', '-w', '0']
message = ['/chatter', 'std_msgs/msg/String', '{data: hello}']
process = subprocess.Popen([f'{sys.prefix}/bin/ros2', 'topic', 'pub', *options, *message])
