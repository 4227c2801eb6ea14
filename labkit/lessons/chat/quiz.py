"""The quiz on chat between computers."""

from __future__ import annotations

from labkit.exercises import Choice, Number, Quiz, Several, Word, right, wrong

__all__ = ['QUIZ']

QUIZ = Quiz(
    'chat',
    Choice(
        'A node subscribes to the topic on which it publishes. What happens to its own messages?',
        right(
            'It hears them, too.',
            'A subscription gets what is published on its topic, whoever has published it.',
        ),
        wrong(
            'ROS leaves them out.',
            'ROS does not look who has published a message. So a chat shows your own words, too.',
        ),
        wrong(
            'That is an error.',
            'Nothing forbids it. But whoever replies on the same topic has to take care.',
        ),
    ),
    Word(
        'Which variable of ROS 2 says how far a node looks for others: on this computer alone, or '
        'in the network?',
        'ROS_AUTOMATIC_DISCOVERY_RANGE',
        'LOCALHOST is this computer, SUBNET is the network around it.',
        'It stands in the table beside the words of ROS 1.',
        wrong={
            'ROS_DOMAIN_ID': 'That is the number that nodes have in common.',
            'ROS_MASTER_URI': 'That belongs to ROS 1: the address at which roscore runs.',
            'ROS_STATIC_PEERS': 'These are addresses that are asked one by one.',
        },
    ),
    Choice(
        'What did roscore do in ROS 1, and who does it in ROS 2?',
        right(
            'It knew who is there. In ROS 2 nobody does: nodes find each other.',
            'That is why nothing has to be started first, and why nothing ends when one ends.',
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
        'What may be the reason?',
        right(
            'One has joined with discovery_range LOCALHOST.',
            'LOCALHOST is this computer alone.',
        ),
        right(
            'The network of the school lets no multicast pass.',
            'Then each needs the address of the other: static_peers.',
        ),
        right(
            'One says /chatter, the other one /shared_chatter.',
            'Two names are two topics.',
        ),
        wrong(
            'Both nodes are called chat.',
            'Names of nodes play no part in who hears whom. For people they should differ.',
        ),
        wrong(
            'No roscore is running.',
            'ROS 2 has none.',
        ),
    ),
    Choice(
        'A node makes a publisher, publishes once and destroys it at once. A subscription in '
        'another process now and then hears nothing. Why?',
        right(
            'The publisher is gone before the other process has found it.',
            'To find each other may take some tenths of a second. So wait for that.',
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
        'Three nodes reply to each Hello with a Hello, but to each person once, and not to '
        'themselves. A fourth person says Hello once. How many replies are there in all?',
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
            'Text of others is shown as text. What is shown as HTML can do more than be bold.',
        ),
        wrong(
            'Hi, in bold letters',
            'Then the others decide what your page does. A script could come the same way.',
        ),
        wrong(
            'nothing',
            'It is a message as any other. It has to be shown as text.',
        ),
    ),
)
