"""The quiz on packages."""

from __future__ import annotations

from labkit.exercises import Choice, Quiz, Several, Word, right, wrong

__all__ = ['QUIZ', 'WARM_UP']

WARM_UP = Quiz(
    'warm_up',
    Choice(
        'What are the two words after `ros2 run`?',
        right('a package, and a program in it', 'As in ros2 run demo_nodes_py talker.'),
        wrong('a node, and its topic', 'Both are named by the program itself.'),
        wrong('a folder, and a file', 'ros2 finds the folder by the name of the package.'),
    ),
    Choice(
        'A program in Python makes a node before `rclpy.init()`. What happens?',
        right('It fails, and says so.', 'Nothing of ROS works before init.'),
        wrong('It works: the order is free.', 'init starts what a node needs.'),
        wrong('It waits for init.', 'Making a node does not wait. It raises an error.'),
    ),
    Choice(
        'On the command line of a program, what is `--ros-args` for?',
        right('What follows is for ROS.', 'A file of parameters, for instance, or another name.'),
        wrong('It starts the master.', 'ROS 2 has none.'),
        wrong('It lists the arguments.', 'It is a sign between the arguments, and lists nothing.'),
    ),
    cell_id='warm-up',
)

QUIZ = Quiz(
    'package',
    Choice(
        'What is package.xml for?',
        right(
            'It says what the package is called, who looks after it, and what it needs.',
            'Tools such as colcon and rosdep read it, and people, too.',
        ),
        wrong(
            'It holds the code of the nodes.',
            'The code is in the folder that has the name of the package.',
        ),
        wrong(
            'It says which programs ros2 run can start.',
            'That is what entry_points in setup.py says.',
        ),
    ),
    Word(
        'Which file says which function `ros2 run robot_basics_lab talker` calls?',
        'setup.py',
        why='In its console_scripts: talker = robot_basics_lab.talker:main',
        otherwise='Look for the word console_scripts in the files of the package.',
        wrong={
            'package.xml': 'package.xml names what the package needs, not what it runs.',
            'setup.cfg': 'setup.cfg says into which folder the programs are put.',
        },
    ),
    Choice(
        'You have changed talker.py in src. What do you do before ros2 run runs the change?',
        right(
            'colcon build',
            'ros2 run starts what is in install, and the build puts it there. After one '
            '`colcon build --symlink-install` a link lies there, and the change counts at once.',
        ),
        wrong(
            'source install/setup.bash',
            'The terminal knows the workspace already. The old file is still in install.',
        ),
        wrong('ros2 pkg create', 'That makes a new package. Yours is there.'),
    ),
    Choice(
        'A new terminal says: Package robot_basics_lab not found. In another one it works. Why?',
        right(
            'The new terminal has not sourced install/setup.bash.',
            'Sourcing sets variables, and variables belong to one terminal.',
        ),
        wrong('The build has failed.', 'Then it would not work in the other terminal either.'),
        wrong(
            'The other terminal has locked the package.',
            'Any number of terminals can use a package at once.',
        ),
    ),
    Several(
        'The talker runs in one terminal, and `ros2 topic list` in another one does not show '
        '/chatter. What may be the reason?',
        right(
            'ROS_DOMAIN_ID is 7 in one terminal and 8 in the other one.',
            'Nodes of two domains never find each other.',
        ),
        right('The talker has ended with an error.', 'A node that is gone has no topics.'),
        wrong(
            'The second terminal is in another folder.',
            'Nodes do not care about folders. They find each other by the network.',
        ),
        wrong(
            'colcon build has to be run in the second terminal, too.',
            'A build is for the disk, and not for a terminal.',
        ),
    ),
    Choice(
        'In setup.py, listener = robot_basics_lab.listener:mian stands where main is meant. When '
        'do you find out?',
        right(
            'When you run the listener.',
            'The build writes a small program, and does not look into your module.',
        ),
        wrong('When you build.', 'colcon build does not import your module.'),
        wrong('Never: ROS finds the function.', 'It takes exactly the name that stands there.'),
    ),
    Choice(
        'A guide for ROS 1 says: catkin_make, then source devel/setup.bash. What do you write?',
        right(
            'colcon build, then source install/setup.bash',
            'The same two steps. devel is not there any more: what is run is in install.',
        ),
        wrong(
            'catkin_make, then source install/setup.bash',
            'catkin_make belongs to ROS 1. It does not know packages of ROS 2.',
        ),
        wrong(
            'colcon build, then source devel/setup.bash',
            'colcon makes the folders build, install and log, and no devel.',
        ),
    ),
)
