"""The quiz of `07_turtlebot.ipynb`."""

from __future__ import annotations

from labkit.exercises import Choice, Number, Quiz, Several, right, wrong

__all__ = ['QUIZ']

QUIZ = Quiz(
    'turtlebot',
    Choice(
        'Which topic tells where the robot is?',
        right('/odom', 'Odometry holds the place and the speed that the robot believes in.'),
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
        'The goal lies at -3.0 rad, the robot looks at 3.0 rad. Which way does it turn?',
        right(
            'to the left, by about 0.28 rad',
            'From 3.0 rad it is 0.28 rad over the jump at pi to -3.0 rad.',
        ),
        wrong(
            'to the right, by 6.0 rad',
            'That is nearly a full turn. The difference of two angles has to be wrapped.',
        ),
        wrong('not at all', 'The two headings are not the same: they differ by 0.28 rad.'),
    ),
    Several(
        'Your program ends, and its last command was linear.x = 0.2. What may happen?',
        right('This robot goes on for a second and then gives up.', 'Its command timeout is 1 s.'),
        right(
            'Another robot, which has no timeout, goes on until it meets something.',
            'Not every robot waits for commands. So a program ends with a stop command.',
        ),
        wrong('It stops at once.', 'It does not know that your program has ended.'),
    ),
)
