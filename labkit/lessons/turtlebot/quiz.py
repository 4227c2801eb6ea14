"""The quiz of `07_turtlebot.ipynb`."""

from __future__ import annotations

from labkit.exercises import Choice, Number, Quiz, Several, right, wrong

__all__ = ['QUIZ', 'WARM_UP']

WARM_UP = Quiz(
    'warm_up',
    Choice(
        'A robot gets a Twist with `linear.x` = 0.2, all else 0. What does it do?',
        right('It drives ahead at 0.2 m/s.', 'A Twist is a speed, and x points ahead.'),
        wrong('It drives 0.2 m, and stops.', 'A Twist holds speeds, and no distance.'),
        wrong('It turns by 0.2 rad.', 'Turning is in angular.z, and that is a speed, too.'),
    ),
    Choice(
        'In this course, what does `command.linear.x = 1` do?',
        right('It raises an error.', 'The field is a float: write 1.0.'),
        wrong('It sets 1.0.', 'So does the command line. A message converts nothing.'),
        wrong('It sets 1.', 'So it is without the check of fields, and nonsense arrives.'),
    ),
    Choice(
        'A script calls `rate.sleep()`, and nobody spins the node. What happens?',
        right('It sleeps for ever.', 'A timer wakes the rate, and works only while it is spun.'),
        wrong('It sleeps for one round.', 'So it does in a cell, where labkit spins the node.'),
        wrong('It raises an error.', 'Nothing tells that nobody spins.'),
    ),
    cell_id='warm-up',
)

QUIZ = Quiz(
    'turtlebot',
    Choice(
        'Which topic tells where the robot is?',
        right('/odom', 'Odometry is where the robot believes it is, and how fast.'),
        wrong('/cmd_vel', 'That is what the robot is told to do. It may not be able to.'),
        wrong('/scan', 'A scan tells how far other things are, not where the robot is.'),
    ),
    Choice(
        'Which field of an Odometry holds the x of the robot?',
        wrong('msg.x', 'The x lies deeper: a message may hold other messages.'),
        wrong('msg.twist.twist.linear.x', 'That is the speed along x, in m/s.'),
        right(
            'msg.pose.pose.position.x',
            'A pose with its uncertainty, in it the pose, in it the position, in it x.',
        ),
    ),
    Number(
        'The robot gets angular.z = 0.5 and linear.x = 0.0 for 2 s. By how many radians does it '
        'turn?',
        1.0,
        'Angle = turning rate times time: 0.5 rad/s times 2 s.',
        'Multiply the turning rate by the time.',
        wrong={
            57.3: 'That is the angle in degrees; the question asks for radians.',
            0.5: 'That is the turning rate: what it turns in one second.',
            0.25: 'You divided. The robot turns for 2 s: multiply.',
            4.0: 'You divided. The robot turns for 2 s: multiply.',
        },
        unit='rad',
    ),
    Choice(
        'The goal is at -3.0 rad, and the robot faces 3.0 rad. Which way should it turn?',
        right(
            'to the left, by about 0.28 rad',
            'From 3.0 rad, across the jump at pi, it is 0.28 rad to -3.0 rad.',
        ),
        wrong(
            'to the right, by 6.0 rad',
            'That is nearly a full turn. The difference of two angles has to be wrapped.',
        ),
        wrong('not at all', 'The two headings are not the same: they differ by 0.28 rad.'),
    ),
    Several(
        'Your program ends, and its last command was linear.x = 0.2. What may happen?',
        right('This robot goes on for a second, and stops.', 'Its command timeout is 1 s.'),
        right(
            'Another robot, which has no timeout, goes on until it hits something.',
            'Not every robot waits for commands. So a program ends with a stop command.',
        ),
        wrong('It stops at once.', 'It does not know that your program has ended.'),
    ),
)
