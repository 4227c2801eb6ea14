"""The quizzes on names and launch files: a warm-up from earlier lessons, and the lesson's own."""

from __future__ import annotations

from labkit.exercises import Choice, Number, Quiz, Several, Word, right, wrong

__all__ = ['QUIZ', 'WARM_UP']

WARM_UP = Quiz(
    'warm_up',
    Choice(
        'Two nodes of one package are to run. How often do you type `ros2 run`?',
        right('twice', 'Each one starts one program, in a terminal or in the background.'),
        wrong('once', 'It starts the program that you name, and no other one.'),
        wrong('never: colcon build starts them', 'A build starts nothing.'),
    ),
    Choice(
        'A node declares a parameter `speed` with 0.1, and is started with a file that says '
        '`speed: 0.2` for it. Which value does it begin with?',
        right('0.2', 'The value of the declaration is only for a start without another one.'),
        wrong('0.1', 'A value that is given at the start wins over that of the declaration.'),
        wrong('none: it is refused', 'It is a double, as declared, so nothing refuses it.'),
    ),
    Choice(
        'A publisher on `/chatter` and a subscriber to `/chater` run. What do they say?',
        right('nothing', 'Two names are two topics. Each of the two waits for others.'),
        wrong('an error, at both ends', 'A topic without a partner is no error in ROS.'),
        wrong('a warning, at the subscriber', 'It cannot know that another name was meant.'),
    ),
    cell_id='warm-up',
)

QUIZ = Quiz(
    'names_and_launch',
    Word(
        'A node in the namespace `/robot1` publishes on `odom`. What is the full name of the '
        'topic?',
        '/robot1/odom',
        why='odom is relative, so the namespace is put before it.',
        otherwise='Put the namespace before the name, with slashes.',
        wrong={
            '/odom': 'That it would be without a namespace, or if the code said /odom.',
        },
    ),
    Word(
        'The same node is called `driver`, and publishes on `~/log`. What is the full name?',
        '/robot1/driver/log',
        why='~ stands for the full name of the node.',
        otherwise='~ stands for the full name of the node.',
        wrong={'/robot1/log': 'That is log, a relative name. A private one has the node in it.'},
    ),
    Choice(
        'The code of a class says `/cmd_vel`, with a slash. You start two of it, in the '
        'namespaces robot1 and robot2. What happens?',
        right(
            'Both use /cmd_vel, and a command drives both robots',
            'An absolute name takes no namespace. Leave out the slash in code.',
        ),
        wrong('Each has a cmd_vel of its own', 'That it would be with the relative cmd_vel.'),
        wrong('The second one is refused', 'Many may publish and subscribe on one topic.'),
    ),
    Choice(
        'A node of the namespace `/tower` publishes on `chatter`. Which remap changes that?',
        right('from="chatter"', 'It becomes /tower/chatter, as the name in the code does.'),
        wrong('from="/chatter"', 'That is another topic: the node has /tower/chatter.'),
        wrong('from="talker"', 'That is perhaps a name of the node. __node is for that.'),
    ),
    Choice(
        'A remap matches no name of the node. What does ROS say?',
        right('nothing', 'So look at ros2 topic list when a system is quiet.'),
        wrong('an error, and the node does not start', 'A remap is a rule, not a promise.'),
        wrong('a warning', 'A rule may be for a name that the node makes later, or never.'),
    ),
    Choice(
        'A parameter file begins with `/robot1/driver:`. Which node takes its values?',
        right('driver in the namespace robot1, and no other', 'The key is a full name.'),
        wrong('each driver, in whatever namespace', 'For that, the key is /**/driver or /**.'),
        wrong('each node in the namespace robot1', 'For that, the key is /robot1/*.'),
    ),
    Several(
        'What can a launch file do?',
        right('start programs of several packages', 'Each node names its package.'),
        right('give parameters and remaps to the nodes that it starts', 'As -p and -r do.'),
        right('start a program again when it has died', 'With respawn="true".'),
        wrong('rename a node that is running', 'Names are given at the start.'),
        wrong('start the master', 'There is none in ROS 2. roslaunch did that in ROS 1.'),
    ),
    Number(
        'A launch file starts four programs, none with respawn or on_exit. One of them dies. How '
        'many go on?',
        3,
        'A launch goes on as long as one of its programs runs.',
        'Programs of a launch know nothing of each other.',
        wrong={0: 'All end together only if the node says on_exit="shutdown".'},
    ),
)
