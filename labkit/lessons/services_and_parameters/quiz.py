"""The quiz on services and parameters."""

from __future__ import annotations

from labkit.exercises import Choice, Number, Quiz, Several, Word, right, wrong

__all__ = ['QUIZ', 'WARM_UP']

WARM_UP = Quiz(
    'warm_up',
    Choice(
        'What does a service have that a topic does not?',
        right('an answer', 'One node asks, and one answers it.'),
        wrong('a type', 'Both have one. That of a service has two parts.'),
        wrong('many readers', 'That is a topic: each subscriber gets a copy.'),
    ),
    Choice(
        'An executor with one thread runs a callback that takes a second. What do other callbacks '
        'do meanwhile?',
        right('They wait.', 'One thread does one thing at a time.'),
        wrong('They run, too.', 'They would, with several threads and groups that allow it.'),
        wrong('They are lost.', 'Messages wait in their queues, as many as the depth allows.'),
    ),
    Choice(
        'A reliable publisher has depth 5. A subscriber was away while 20 messages were sent. How '
        'many does it receive afterwards?',
        right('5', 'A publisher sends again only what it still has.'),
        wrong('20', 'Reliable repairs only what is still in the queue of the publisher.'),
        wrong('0', 'Best effort might end so. Reliable sends its last five again.'),
    ),
    cell_id='warm-up',
)

QUIZ = Quiz(
    'services_and_parameters',
    Choice(
        'A node wants to know once whether a gate is open, and needs the answer to go on. What '
        'fits best?',
        right(
            'a service',
            'One request, one response, and the client learns that it was answered.',
        ),
        wrong(
            'a topic',
            'A publisher does not learn whether anybody has heard it. Topics are for what comes '
            'again and again.',
        ),
        wrong(
            'a parameter',
            'A parameter is a setting of a node. Whether a gate is open is not one.',
        ),
    ),
    Number(
        'One node serves /open_gate, three nodes have a client of it. One of them calls. How many '
        'nodes get the response?',
        1,
        'A response goes to the client that has asked.',
        'Compare a service with a topic: who gets what is said?',
        wrong={
            3: 'That would be so with a topic. A response is for the one that has asked.',
            0: 'The client that has asked gets it.',
            4: 'The server sends it, and one client gets it.',
        },
    ),
    Choice(
        'Nobody serves /open_gate. What does client.call(request) do, without a time-out?',
        right(
            'It waits for ever.',
            'A request without a server is not an error. So ask wait_for_service() first, or give '
            'a time-out.',
        ),
        wrong(
            'It raises an error at once.',
            'The server may come in a moment. ROS does not know that it never will.',
        ),
        wrong(
            'It returns None at once.',
            'call() returns when the response is there. call_async() returns at once.',
        ),
    ),
    Choice(
        'Why must a callback not wait for the response with call()?',
        right(
            'The response is taken by the executor, and the executor runs this callback.',
            'Each waits for the other: a deadlock. call_async() and add_done_callback() end it.',
        ),
        wrong(
            'A callback may not have a client.',
            'It may. It may send a request, and must not wait for the response.',
        ),
        wrong(
            'The server is too slow for it.',
            'The fastest server does not help: its response waits until the callback returns.',
        ),
    ),
    Several(
        'A parameter was declared with the value 2.0 and a range from 1.0 to 20.0. Which values '
        'can be set?',
        right('20.0', 'The ends belong to the range.'),
        right('1.5', 'It lies within the range.'),
        wrong('5', 'It is an integer, and the type of this parameter is double. Write 5.0.'),
        wrong('0.5', 'It lies below the range.'),
        wrong('nan', 'It lies within no range.'),
    ),
    Choice(
        'The speed of a node was changed with ros2 param set. The command said "successful", and '
        'the node is as slow as before. Why?',
        right(
            'The node has read the parameter once, at its start.',
            'The value has changed, but not what was made from it. React in a callback, or read '
            'the value anew each time.',
        ),
        wrong(
            'A node takes new parameters only when it starts.',
            'It has taken the value: ros2 param get shows it.',
        ),
        wrong(
            'The command reached another node.',
            'It names the node, and that one has answered.',
        ),
    ),
    Word(
        'Which verb of ros2 param prints all parameters of a node, in the form of a parameter '
        'file?',
        'dump',
        'ros2 param dump prints YAML, and ros2 param load reads it.',
        '%ros2 param -h lists the verbs.',
        wrong={
            'list': 'That one prints the names alone.',
            'get': 'That one prints the value of one parameter.',
            'describe': 'That one prints what is known of a parameter besides its value.',
            'load': 'That one reads such a file.',
        },
    ),
)
