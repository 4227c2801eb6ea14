"""Answers to `listener`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'not built',
        'colcon build has not been run since',
        ('!colcon build --packages-select ears_lab\n', ''),
    ),
    wrong(
        'built too early',
        'files in src that are newer than the last build that went well',
        (
            "Path('src/ears_lab/ears_lab/listener.py').write_text(LISTENER)\n"
            '!colcon build --packages-select ears_lab\n',
            '!colcon build --packages-select ears_lab\n'
            "Path('src/ears_lab/ears_lab/listener.py').write_text(LISTENER)\n",
        ),
    ),
    wrong(
        'beside src',
        'Packages lie in the folder src of a workspace.',
        (' --destination-directory src', ''),
        ('src/ears_lab', 'ears_lab'),
    ),
    wrong(
        'another name',
        'The name is close, and it is another one.',
        (
            "shutil.rmtree('src/ears_lab', ignore_errors=True)\n"
            '%ros2 pkg create ears_lab --build-type ament_python '
            '--destination-directory src \\\n',
            "shutil.rmtree('src/ear_lab', ignore_errors=True)\n"
            '%ros2 pkg create ear_lab --build-type ament_python '
            '--destination-directory src \\\n',
        ),
        (
            "Path('src/ears_lab/ears_lab/listener.py').write_text(LISTENER)\n"
            '!colcon build --packages-select ears_lab\n',
            "Path('src/ear_lab/ear_lab/listener.py').write_text(LISTENER)\n"
            '!colcon build --packages-select ear_lab\n',
        ),
    ),
    wrong(
        'no entry',
        'A module alone cannot be run',
        ('    --node-name listener --dep', '    --dep'),
    ),
    wrong(
        'another function',
        'The entry in setup.py names a function that the module does not have.',
        ('def main()', 'def run()'),
    ),
    wrong(
        'does not spin',
        'main() returned at once',
        ('        rclpy.spin(node)', '        print(node)'),
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
    wrong(
        'raises', "has no attribute 'rmtre'", ('shutil.rmtree(', 'shutil.rmtre('), outcome=ERROR
    ),
    right('lab.export'),
    right(
        'the whole workspace', ('!colcon build --packages-select ears_lab\n', '!colcon build\n')
    ),
    right(
        'links instead of copies',
        (
            '!colcon build --packages-select ears_lab\n',
            '!colcon build --packages-select ears_lab --symlink-install\n',
        ),
    ),
    right(
        'an entry by hand, and another name of the module',
        ('    --node-name listener --dep', '    --dep'),
        ('ears_lab/listener.py', 'ears_lab/hearing.py'),
        (
            '!colcon build --packages-select ears_lab\n',
            "setup = Path('src/ears_lab/setup.py')\n"
            "entry = \"'console_scripts': ['listener = ears_lab.hearing:main'\"\n"
            'text = setup.read_text().replace("\'console_scripts\': [", entry)\n'
            'setup.write_text(text)\n!colcon build --packages-select ears_lab\n',
        ),
    ),
]
