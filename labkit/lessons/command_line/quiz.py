"""The quiz on the command line itself."""

from __future__ import annotations

from labkit.exercises import Choice, Quiz, Several, Word, right, wrong
from labkit.exercises.quiz import spelling

__all__ = ['QUIZ', 'WARM_UP']

WARM_UP = Quiz(
    'warm_up',
    Choice(
        "Why does `Node('2nd_talker')` raise an error?",
        right('A name must not begin with a digit.', 'Letters, digits and _ are fine after that.'),
        wrong('There is a talker already.', 'ROS lets two nodes of one name run.'),
        wrong('It is not a class of your own.', 'Node itself makes nodes, too.'),
    ),
    Choice(
        'A talker and a listener run, and the listener hears nothing. What must be the same at '
        'both ends?',
        right('topic and type', 'A subscriber receives messages of one type on one topic.'),
        wrong('the name of the node', 'Each node needs a name of its own.'),
        wrong('the depth of the queue', 'Each end has its own queue, and chooses its depth.'),
    ),
    Choice(
        "Why do no brackets follow `self.on_message` in `create_subscription(String, 'chatter', "
        'self.on_message, 10)`?',
        right('The function is passed, not called.', 'ROS calls it later, for each message.'),
        wrong('It takes no argument.', 'It takes one, the message.'),
        wrong('Its brackets are in the class.', 'The definition has some. A call needs its own.'),
    ),
    cell_id='warm-up',
)

QUIZ = Quiz(
    'commands',
    Choice(
        'Other courses ask for three or four terminals. Why?',
        right(
            'A command that goes on keeps its terminal until it ends.',
            'echo, hz, pub without --once and every node go on. Here & sends a command to the '
            'background, and ros2 run starts a node there.',
        ),
        wrong(
            'ROS 2 allows one node in each terminal.',
            'A terminal can start many programs: & at the end sends one to the background.',
        ),
        wrong(
            'Nodes find each other only in different terminals.',
            'Terminals do not matter to discovery. The domain does.',
        ),
    ),
    Choice(
        'Which line sets the forward speed of a Twist?',
        right(
            '"{linear: {x: 0.2}}"',
            'linear is a message itself, so its fields stand in braces of their own.',
        ),
        wrong('"{linear.x: 0.2}"', 'The dot is for Python. In YAML inner fields get braces.'),
        wrong('{linear: {x: 0.2}}', 'Without quotation marks the spaces cut it into words.'),
        wrong('"{linear:{x:0.2}}"', 'After each colon YAML needs a space.'),
    ),
    Choice(
        'A lesson for ROS 1 begins with: "Start roscore in the first terminal." What do you do?',
        right('Nothing: ROS 2 has no master.', 'The nodes find each other by discovery.'),
        wrong('ros2 run roscore', 'There is no such package. ROS 2 has no master to start.'),
        wrong('ros2 core', 'There is no such command. ROS 2 has no master to start.'),
    ),
    Word(
        'rosmsg show std_msgs/String showed the fields of a message. Which two words after ros2 '
        'do it now?',
        'interface show',
        'Messages, services and actions are interfaces, so one command shows all three.',
        'Look into the table: it is not called msg any more.',
        wrong={
            'msg show': 'ros2 msg was the name in the first versions. It is interface now.',
            'topic type': 'topic type names the type of a topic, and does not show its fields.',
            'topic info': 'topic info names the type of a topic, and does not show its fields.',
            'interface list': 'That lists the names of all types.',
            'interface proto': 'That shows an empty message to copy. show lists the fields.',
            'interface': 'That is one of the two words. Which verb shows what is in a type?',
            'show': 'That is one of the two words. Which command has this verb?',
            'show interface': 'The command comes first, then its verb.',
            'rosmsg show': 'That is ROS 1. Messages are interfaces now.',
            'message show': 'ros2 has no command message. Messages are interfaces.',
            'interfaces show': 'Nearly: the command has no s at its end.',
        },
        form=spelling.ros2_command,
        how='two words',
    ),
    Several(
        'What is true of a node whose name begins with an underscore?',
        right('node list leaves it out.', 'Such names are hidden. Tools use them for themselves.'),
        right('node list -a shows it.', 'The option -a stands for all.'),
        wrong('It cannot publish.', 'It is a node like any other. Only the lists leave it out.'),
        wrong('It runs in another domain.', 'It is in the same domain, and everybody hears it.'),
    ),
    Choice(
        'A robot is running, but ros2 node list in your terminal shows nothing. What do you look '
        'at first?',
        right(
            'ROS_DOMAIN_ID in the terminal and on the robot',
            'Nodes of different domains do not see each other, and there is no error.',
        ),
        wrong('Whether roscore runs', 'ROS 2 has no roscore.'),
        wrong(
            'Whether the topics have the right type',
            'A wrong type makes a topic silent. The nodes are listed all the same.',
        ),
    ),
)
