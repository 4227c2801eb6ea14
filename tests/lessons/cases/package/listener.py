"""Answers to `listener`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

BUILD = 'colcon build --packages-select ears_lab\n'
RUN = 'ros2 run ears_lab listener > listener.log 2>&1 &\n'
# As if the module had been changed, and built once more, a while after the start.
LATER = 'touch -d "5 seconds" src/*/*/listener.py\ntouch -d "9 seconds" build/*/colcon_build.rc\n'

ANSWERS = [
    wrong('not built', 'colcon build has not been run since', (BUILD, '')),
    wrong('not started', 'No program of that name runs on this machine just now.', (RUN, '')),
    wrong(
        'in another domain',
        'Nodes find each other only within one domain.',
        (RUN, f'ROS_DOMAIN_ID=220 {RUN}'),
    ),
    wrong(
        'started twice',
        '2 nodes of the name /listener',
        (RUN, f'{RUN}{RUN}until [ $(ros2 node list | grep -c listener) -ge 2 ]; do :; done\n'),
    ),
    wrong(
        'changed while it runs',
        'A program keeps the code with which it was started.',
        (RUN, f'{RUN}{LATER}'),
    ),
    wrong('in the notebook', 'A node of that name is there, of another program.'),
    wrong(
        'built too early',
        'files in src that are newer than the last build that went well',
        (BUILD, f'{BUILD}touch src/ears_lab/ears_lab/listener.py\n'),
    ),
    wrong(
        'beside src',
        'Packages lie in the folder src of a workspace.',
        ('cd ros2_ws/src\n', 'cd ros2_ws\n'),
        ('cd ..\n', ''),
    ),
    wrong('another name', 'The name is close, and it is another one.', ('ears_lab', 'ear_lab')),
    wrong('no entry', 'A module alone cannot be run', (' --node-name listener', '')),
    wrong('another function', 'If it ends at once, read there why.', ('def main()', 'def run()')),
    wrong(
        'does not spin',
        'If it ends at once, read there why.',
        ('        rclpy.spin(node)', '        print(node)'),
    ),
    wrong(
        'ends while it is looked at',
        'If it ends at once, read there why.',
        ('import rclpy\n', 'import time\n\nimport rclpy\n'),
        ('        rclpy.spin(node)', '        time.sleep(1)'),
    ),
    wrong(
        'sleeps',
        'is on the graph, and does not answer',
        ('import rclpy\n', 'import time\n\nimport rclpy\n'),
        ('        rclpy.spin(node)', '        time.sleep(1000)'),
    ),
    wrong(
        'the name of the class',
        'The name of the node is what super().__init__() gets.',
        ("__init__('listener')", "__init__('Listener')"),
    ),
    wrong('another topic', 'it subscribes to: /chater', ("'chatter'", "'chater'")),
    wrong(
        'stops after ten',
        'Some messages are logged as they came, and this one is not.',
        (
            "        self.get_logger().info(f'I heard: {msg.data}')\n",
            '        self.count = getattr(self, "count", 0) + 1\n'
            '        if self.count <= 10:\n'
            "            self.get_logger().info(f'I heard: {msg.data}')\n",
        ),
    ),
    wrong(
        'the first 1000 letters',
        'its line does not hold what the message says',
        ('{msg.data}', '{msg.data[:1000]}'),
    ),
    wrong(
        'prints',
        'The callback does not log it.',
        ("self.get_logger().info(f'I heard: {msg.data}')", 'print(msg.data)'),
    ),
    wrong(
        'logs twice',
        'Another line is logged when a message comes, beside the one that is asked for.',
        (
            "        self.get_logger().info(f'I heard: {msg.data}')\n",
            "        self.get_logger().info(f'I heard: {msg.data}')\n"
            '        self.get_logger().info(msg.data)\n',
        ),
    ),
    wrong(
        'a timer logs, too',
        'A timer or a loop logs, too.',
        (
            "        super().__init__('listener')\n",
            "        super().__init__('listener')\n"
            '        self.create_timer(3.0, self.on_timer)\n\n'
            '    def on_timer(self):\n'
            "        self.get_logger().info('still here')\n\n"
            '    def begin(self):\n',
        ),
        ('    node = Listener()\n', '    node = Listener()\n    node.begin()\n'),
    ),
    right('lab.export'),
    right('the whole workspace', (BUILD, 'colcon build\n')),
    right('links instead of copies', (BUILD, BUILD.replace('\n', ' --symlink-install\n'))),
    right(
        'an entry by hand, and another name of the module',
        (' --node-name listener', ''),
        ('cat > ears_lab/ears_lab/listener.py', 'cat > ears_lab/ears_lab/hearing.py'),
        (
            'cd ..\n',
            'entry="\'listener = ears_lab.hearing:main\'"\n'
            'sed -i "s/\'console_scripts\': \\[/&$entry/" ears_lab/setup.py\ncd ..\n',
        ),
    ),
]
