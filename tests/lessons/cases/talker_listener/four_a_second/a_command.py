import subprocess
import sys

options = ['--rate', '4', '--times', '600', '-w', '0']
message = ['/beacon', 'std_msgs/msg/String', '{data: I am here}']
process = subprocess.Popen([f'{sys.prefix}/bin/ros2', 'topic', 'pub', *options, *message])
