"""The quiz on interfaces and actions."""

from __future__ import annotations

from labkit.exercises import Choice, Number, Quiz, Several, Word, right, wrong

__all__ = ['QUIZ', 'WARM_UP']

WARM_UP = Quiz(
    'warm_up',
    Choice(
        'What does `call_async()` of a client return?',
        right('a future', 'A place for the response, which comes later.'),
        wrong('the response', 'That is what call() returns, when it has come.'),
        wrong('None', 'Then nothing could tell you when the response is there.'),
    ),
    Choice(
        'A type of a service has two parts. What stands between them?',
        right('a line of three hyphens', 'Above it is the request, below it the response.'),
        wrong('an empty line', 'An empty line means nothing in such a file.'),
        wrong('the word response', 'No words: three hyphens.'),
    ),
    Choice(
        'Your package imports std_msgs, and `package.xml` does not name it. Where does that fail?',
        right('on a machine without std_msgs', 'Nothing there says that it has to be installed.'),
        wrong('in colcon build', 'A build of Python does not look into your modules.'),
        wrong('in ros2 run, on any machine', 'Where std_msgs is installed, the import works.'),
    ),
    cell_id='warm-up',
)

QUIZ = Quiz(
    'interfaces_and_actions',
    Choice(
        'A robot is to drive to the kitchen, which takes two minutes. You want to see how far it '
        'has come, and to be able to cancel the drive. What fits best?',
        right('an action', 'It takes long, reports how far it has come, and can be canceled.'),
        wrong('a service', 'It has one answer, at the end, and nobody can cancel a request.'),
        wrong('a topic', 'A publisher never learns whether a place was heard, or reached.'),
        wrong('a parameter', 'A parameter is a setting, and driving somewhere is work.'),
    ),
    Number(
        'A file of an action has three parts. How many lines of three hyphens stand between them?',
        2,
        'Goal, line, result, line, feedback.',
        'Look at the output of ros2 interface show test_msgs/action/Fibonacci.',
        wrong={1: 'One line is in a service, which has two parts.', 3: 'There are three parts.'},
    ),
    Choice(
        'A client cancels a goal, and the cancel_callback of the server accepts that. Who stops '
        'the work?',
        right(
            'execute(), when it looks at is_cancel_requested',
            'Accepting stops nothing by itself. The loop has to look, and end the goal.',
        ),
        wrong('ROS, at once', 'ROS cannot stop Python code half way, and does not try to.'),
        wrong('the client', 'The client asks. What is done is done by the server.'),
    ),
    Choice(
        'A server with one thread calls time.sleep() in execute(). Why can no goal of it '
        'be canceled?',
        right(
            'While it sleeps, no other callback runs, so nobody takes the request',
            'await a Future, or use an executor with several threads.',
        ),
        wrong('A goal that was accepted can never be canceled', 'It can, if the server lets it.'),
        wrong('The request to cancel is lost', 'It waits in the queue until a callback can run.'),
    ),
    Several(
        'Who can see the feedback of an action?',
        right('the client that has sent the goal', 'It has a feedback_callback for it.'),
        right(
            'any node that subscribes to the hidden topic of the feedback',
            'Feedback is an ordinary topic, whose name has a part that begins with _.',
        ),
        wrong('nobody before the result is there', 'Feedback is what comes before the result.'),
    ),
    Choice(
        'execute() returns a result, and has called neither succeed() nor canceled(). How '
        'does the goal end?',
        right('aborted', 'A goal that nobody ends counts as failed.'),
        wrong('succeeded', 'The server has to say so: goal_handle.succeed().'),
        wrong('it goes on for ever', 'When the callback has returned, the goal is over.'),
    ),
    Choice(
        'A client has called send_goal_async(). What does its future hold when the server has '
        'answered?',
        right(
            'a goal handle',
            'Its attribute accepted says yes or no. The result comes by a second future.',
        ),
        wrong('the result', 'That comes later: get_result_async() of the goal handle.'),
        wrong('the first feedback', 'Feedback goes to the feedback_callback.'),
    ),
    Word(
        'Which command builds all packages of a workspace? Its second word is build.',
        'colcon',
        'colcon build, in the folder of the workspace.',
        'It begins with a c.',
        wrong={'cmake': 'colcon calls cmake, for each package.', 'catkin': 'That was ROS 1.'},
    ),
)
