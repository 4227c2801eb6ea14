"""The quiz on chat between computers."""

from __future__ import annotations

from labkit.exercises import Choice, Number, Quiz, Several, Word, right, wrong

__all__ = ['QUIZ', 'WARM_UP']

WARM_UP = Quiz(
    'warm_up',
    Choice(
        'How does a callback hand its result to other nodes?',
        right('It publishes it.', 'So Converter did: degrees Celsius in, Fahrenheit out.'),
        wrong('It returns it.', 'ROS calls the callback, and does nothing with what it returns.'),
        wrong('It writes it into msg.', "The message is this subscriber's own copy."),
    ),
    Choice(
        '`publisher.get_subscription_count()` is 0. What happens to a message that you publish '
        'now?',
        right('Nobody hears it.', 'A publisher keeps nothing for subscribers that come later.'),
        wrong('It waits for the first subscriber.', 'By default, those who come later miss it.'),
        wrong('publish() raises an error.', 'To publish without a subscriber is no error.'),
    ),
    Choice(
        'When does a node end that you started with `%ros2 run`?',
        right('when you stop it, or the kernel ends', 'It is a process of its own.'),
        wrong('when its cell has ended', 'The cell only starts it. The process goes on.'),
        wrong('after its first message', 'A talker goes on until somebody ends it.'),
    ),
    cell_id='warm-up',
)

QUIZ = Quiz(
    'chat',
    Choice(
        'A node subscribes to the topic on which it publishes. What happens to its own messages?',
        right(
            'It hears them, too.',
            'A subscription receives all that is published on its topic, by any node.',
        ),
        wrong(
            'ROS leaves them out.',
            'ROS does not look at who published a message. So a chat shows your own words, too.',
        ),
        wrong(
            'That is an error.',
            'Nothing forbids it. But a node that replies on the same topic has to take care.',
        ),
    ),
    Word(
        'Which variable of ROS 2 says how far a node looks for others: on this computer alone, or '
        'in the network?',
        'ROS_AUTOMATIC_DISCOVERY_RANGE',
        'LOCALHOST is this computer, SUBNET is the network around it.',
        'It stands in the table of variables.',
        wrong={
            'ROS_DOMAIN_ID': 'That is the number that nodes have in common.',
            'ROS_MASTER_URI': 'That belongs to ROS 1: the address at which roscore runs.',
            'ROS_STATIC_PEERS': 'These are addresses that are asked one by one.',
        },
    ),
    Choice(
        'What did roscore do in ROS 1, and who does it in ROS 2?',
        right(
            'It kept a list of all nodes. In ROS 2 nobody does: nodes find each other.',
            'So nothing has to be started first, and no program is needed by all the others.',
        ),
        wrong(
            'It carried the messages. In ROS 2 the domain does.',
            'Messages went from node to node in ROS 1, too. And a domain is a number.',
        ),
        wrong(
            'It set the clock. In ROS 2 each node does.',
            'It knew names and addresses. The clock is another matter.',
        ),
    ),
    Several(
        'Two computers in one school do not hear each other, though both have joined domain 42. '
        'What might be the reason?',
        right(
            'One has joined with discovery_range LOCALHOST.',
            'LOCALHOST is this computer alone.',
        ),
        right(
            'The network of the school blocks multicast.',
            'Then each needs the address of the other: static_peers.',
        ),
        right(
            'One uses /chatter, the other /shared_chatter.',
            'Two names are two topics.',
        ),
        wrong(
            'Both nodes are called chat.',
            'Names of nodes do not decide who hears whom. They should differ for people.',
        ),
        wrong(
            'No roscore is running.',
            'ROS 2 has none.',
        ),
    ),
    Choice(
        'A node makes a publisher, publishes once and destroys it at once. A subscription in '
        'another process sometimes hears nothing. Why?',
        right(
            'The publisher is gone before the other process has found it.',
            'Discovery may take some tenths of a second. So wait for it.',
        ),
        wrong(
            'A publisher must not be made in a callback.',
            'It may. Whether it is found in time is the question.',
        ),
        wrong(
            'One message is too few.',
            'One is enough, if somebody is there to take it.',
        ),
    ),
    Number(
        'Three nodes reply to Hello with Hello, once to each person, and never to themselves. '
        'A fourth person says Hello once. How many replies are there in all?',
        9,
        'Each of the three greets the fourth, and each of the two others: three times three.',
        'Each of the three greets everybody else once. How many others has each of them heard?',
        wrong={
            3: 'Those are the replies to the fourth. Each reply is a Hello, too.',
            6: 'Do not forget the fourth person, who began.',
            12: 'The fourth person replies to nobody.',
        },
    ),
    Choice(
        'Somebody sends the text <b>Hi</b>. What should your program show?',
        right(
            '<b>Hi</b>, character by character',
            'Text from others is shown as text. HTML can do more than make letters bold.',
        ),
        wrong(
            'Hi, in bold letters',
            'Then the others decide what your page does. A script could come the same way.',
        ),
        wrong(
            'nothing',
            'It is a message like any other. It has to be shown as text.',
        ),
    ),
)
