"""The quiz of lesson 01; some answers are read off the graph."""

from __future__ import annotations

from labkit.exercises import Choice, Number, Quiz, Several, Word, right, wrong


def publishers_of_sight() -> int:
    """Count the publishers of /sight at this moment."""
    from labkit.asking.discovery import asking_node

    return asking_node().count_publishers('/sight')


def _no_eye(number: float) -> str:
    """Say which cell makes an Eye, if none runs."""
    if publishers_of_sight():
        return ''
    return 'At this moment it has none. Run the cell with the class Eye, and count again.'


QUIZ = Quiz(
    'theory',
    Choice(
        'What is ROS?',
        right(
            'Libraries and tools for robot programs',
            'You imported it as a module. Around it there are tools such as ros2.',
        ),
        wrong('An operating system', 'The name says so. It runs on one, here on Linux.'),
        wrong('A programming language', 'Your nodes are written in Python; others in C++.'),
        wrong('A simulator', 'Simulators such as Gazebo are programs that talk to ROS.'),
    ),
    Several(
        'Which of these jobs does ROS do for you?',
        right('Passing messages between programs', 'That is what topics and services do.'),
        right(
            'One form of data for all laser scanners',
            'This is hardware abstraction: LaserScan is the same for every maker.',
        ),
        right('A way to share code in packages', 'This is package management.'),
        wrong(
            'Deciding what the robot does',
            'What the robot thinks is up to your code. ROS carries messages to it and from it.',
        ),
    ),
    Choice(
        'Two nodes exchange messages. What lies between them?',
        right('A topic, and no other program', 'ROS is peer to peer: nodes talk directly.'),
        wrong('The master', 'Even in ROS 1 it only introduced the nodes to each other.'),
        wrong('The notebook', 'It started the nodes. Nodes in other processes need none.'),
    ),
    Choice(
        'What took the place of the master in ROS 2?',
        right('Discovery', 'Every node announces itself, and hears of the others.'),
        wrong('The parameter server', 'That is gone too: each node keeps its own parameters.'),
        wrong('The command ros2', 'It asks the graph. Nodes find each other without it.'),
    ),
    Choice(
        'Two nodes publish on /sight, two subscribe to it. Both publish one message. '
        'How many messages does each subscriber get?',
        right('2', 'A topic copies: every subscriber gets every message.'),
        wrong('1', 'A topic does not share messages out, it copies them.'),
        wrong('4', 'Four copies travel in all, but each subscriber gets two of them.'),
    ),
    Choice(
        'May a node that subscribes also publish?',
        right('Yes', 'Brain does both. A node may have many of each.'),
        wrong('No', 'A subscription cannot publish. The node that has it can.'),
        wrong('Only on the topic that it hears', 'Then it would hear itself, and answer itself.'),
    ),
    Choice(
        'The robot has to drive to the kitchen and report on the way. What fits?',
        right('An action', 'A goal that takes time, with reports on the way and a result.'),
        wrong('A service', 'A service gives one answer, and says nothing before.'),
        wrong('A topic', 'A topic carries reports, but it knows no goal and no result.'),
        wrong('A bag', 'A bag records messages.'),
    ),
    Choice(
        'In which way is a node not like a mailbox?',
        right(
            'A message is copied for every subscriber',
            'A letter has one reader, a message as many as there are subscribers.',
        ),
        wrong('It has limited room', 'A node is like that: the depth of its queue is the room.'),
        wrong('Messages wait in it', 'A node is like that: they wait until it reads them.'),
    ),
    Choice(
        'A book says: rosrun turtlesim turtlesim_node. What do you type in ROS 2?',
        right('ros2 run turtlesim turtlesim_node', 'One command, ros2, and a verb: run.'),
        wrong('roscore turtlesim', 'roscore started the master. There is none any more.'),
        wrong('ros2 node turtlesim', 'ros2 node asks about nodes that run already.'),
    ),
    Choice(
        'Where does ROS 2 keep the parameter speed of the node brain?',
        right(
            'In the node brain',
            'Other nodes ask it, through services such as /brain/get_parameters.',
        ),
        wrong('In the parameter server', 'That is ROS 1.'),
        wrong('In a file', 'A file may set it at the start. Then the node keeps it.'),
    ),
    Number(
        'Look at the graph of this notebook now: how many publishers does /sight have?',
        publishers_of_sight,
        'Each node Eye that runs has one.',
        'Draw the graph with lab.graph() and count the arrows that lead to /sight.',
        explain=_no_eye,
    ),
    Word(
        'Which topic do the legs of this lesson listen to?',
        '/move',
        'Inside the node it is move; the graph shows the full name, /move.',
        'Draw the graph with lab.graph() and follow the arrows to the legs.',
        wrong={
            '/sight': 'That is what the brain listens to.',
            '/sneeze': 'That is a service: somebody asks, and one node answers.',
            'left_leg': 'That is a leg, a node. The topic that it listens to is asked for.',
            'right_leg': 'That is a leg, a node. The topic that it listens to is asked for.',
        },
    ),
)
