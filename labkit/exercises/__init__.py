'''Exercises that are checked on the live ROS graph, hints, solutions, quizzes, progress.

How to write the exercises of a lesson
======================================

The exercises of `notebooks/04_odds.ipynb` are in `labkit.lessons.odds`, a module or a package with
one an exercise, that defines `LESSON`. That is all: lessons are found by name. Types of messages
are given by name (`'std_msgs/msg/Int16'`), so it needs no ROS to be imported. A small one,
complete::

    """The exercises of lesson 04."""

    from labkit.exercises import (
        Choice, Exercise, Lesson, Probe, Quiz, Solution, Style, Wrong, changed, expect, right,
        wrong,
    )
    from labkit.lessons._script import in_process

    INT16 = 'std_msgs/msg/Int16'


    def judge_ones(probe: Probe) -> str:
        source = expect.publisher(probe, '/ones')
        ones = expect.messages(probe, source, count=3, hz=10.0)
        expect.equal(ones, 'data', 1, todo='Set msg.data = 1 before you publish.')
        return f'{source.node} publishes 1 at {expect.describe_rate(ones)}.'


    NODE = """
    from rclpy.node import Node
    from std_msgs.msg import Int16


    class Ones(Node):
        def __init__(self):
            super().__init__('ones')
            self.publisher = self.create_publisher(Int16, 'ones', 10)
            self.create_timer(0.1, self.on_timer)

        def on_timer(self):
            self.publisher.publish(Int16(data=1))


    lab.spin(Ones())
    """

    LESSON = Lesson(
        'odds',
        '04_odds.ipynb',
        exercises=[
            Exercise(
                name='ones',
                task='Publish the Int16 1 on /ones, ten times a second.',
                publishes={'/ones': INT16},
                judge=judge_ones,
                hints=['What calls a function again and again?', 'create_timer(0.1, ...)'],
                answer=Solution(NODE, 'A timer leaves the node free.'),
                styles=[Style('own process', in_process(NODE), process=True)],
                wrong=[
                    Wrong('Hz for s', changed(NODE, ('0.1', '10')), 'its period is 10 s'),
                ],
            ),
        ],
        quizzes=[
            Quiz(
                'types',
                Choice(
                    'What can a message of type Int16 hold?',
                    right('a number from -32768 to 32767', '16 bits give 65536 numbers.'),
                    wrong('any int of Python', 'An int of Python has no limits, an Int16 has.'),
                ),
            ),
        ],
    )

In the notebook are, with these cell ids (an underscore of the name becomes a dash):

- `ones-starter`: the cell to edit, with `...` where the learner writes. It must run as it is;
- `ones-check`: `lesson.ones.check()`, its output stored as NOT ATTEMPTED;
- a cell with `# lesson.ones.hint()` and `# lesson.ones.solution()`;
- one with `lesson.quiz('types')`.

The judge
---------
It gets a `Probe` (the graph, and messages as they come) and uses the matchers of `expect`, each of
which returns what it found or raises the outcome. Rules of thumb:

- The exercise says what it asks for: `publishes` and `subscribes` (topics, with their types) and
  `nodes` (full names). The matchers take the types from there. Ask in any order.
- Whether something missing is a FAIL or NOT ATTEMPTED is read off the graph, see `Scope`: an
  attempt is a node of the learner's that does what this exercise asks for and no earlier one
  does, or what may mean that, under another name. Nodes without any publisher or subscription
  are no attempt, unless only a node is asked for.
- `Lesson(topics=...)` names the topics that the lesson's own cells use besides. On every topic
  that the lesson does not know, a publisher of the right type counts as a wrong name. `given`
  names nodes (`'/talker'`) that these cells leave running: they are never the learner's.
- A second publisher on a topic in `publishes` is a FAIL, whenever it comes, unless the topic is
  in `shared`, too.
- `expect.publisher` looks for names that are nearly right, and for the type. `expect.messages`
  waits for messages and judges their rate by their own stamps; when none come it says why: not
  spun, no timer, timer calls in vain, a callback that does not return.
- `expect.steps`, `first`, `each`, `equal`, `increasing` look at values. `first` knows the first
  value even when the check comes late, because messages are numbered.
- `expect.replies` sends test messages to a subscription and looks for the answers; `explain` gives
  the misconception behind an answer of this exercise. `expect.logs` looks for a log line.
- `expect.node` looks for the node's name, `expect.spun` whether anybody runs its callbacks,
  `expect.qos` at the profile, `expect.ends_with_node`
  ends the node (then `once=True`). For what is done once, before the check (`ros2 topic pub
  --once`), `records=['/odds']` records from the setup cell on: `probe.recorded['/odds']`.
  A recorder is a subscription, so it is counted by `ros2 topic info` and by publishers that wait.
- What another process makes comes into the graph piece by piece. Matchers wait for what they look
  for; before counting (`len(probe.publishers('/names'))`), use `probe.wait_to_appear(condition)`.
- Anything else: `expect.that(condition, expected=..., seen=..., why=..., todo=...)`, or
  `raise Fail(expected, seen, why=..., todo=...)`.
- What the learner's code raises, in a cell or in a callback, becomes ERROR by itself, with the
  misconception behind it; such wrong answers have `outcome=Outcome.ERROR`.
- A judge must not read the learner's code or variables, and waits only with `probe.wait` and the
  matchers: they share one time limit, so that a check ends within 5 s.

The proof
---------
`tests/lessons/` runs every exercise in its notebook, in a real kernel: untouched, each wrong
answer with its sentence, each style, the solution, and the check pressed again. The solution of
one exercise keeps running while the next one is proved, as it does when a learner goes on. Have
at least three wrong answers and two other styles (`process=True`: a script in a process of its
own). `pytest tests/lessons -k odds-ones` proves one exercise.

Ruff looks at all of these answers as it does at other code, and a learner sees the solution as it
is formatted. Where what it finds is the mistake itself, as a name that is not defined, the wrong
answer says so: `refused='The name is not defined.'`.
'''

from __future__ import annotations

from labkit.exercises import expect
from labkit.exercises.exercise import Exercise, Solution, Style, Wrong, changed
from labkit.exercises.lesson import Lesson
from labkit.exercises.probe import Probe
from labkit.exercises.questions import Choice, Number, Several, Word, right, wrong
from labkit.exercises.quiz import Quiz
from labkit.exercises.verdict import Fail, NotAttempted, Outcome
from labkit.exercises.watch import Watch

__all__ = [
    'Choice',
    'Exercise',
    'Fail',
    'Lesson',
    'NotAttempted',
    'Number',
    'Outcome',
    'Probe',
    'Quiz',
    'Several',
    'Solution',
    'Style',
    'Watch',
    'Word',
    'Wrong',
    'changed',
    'expect',
    'right',
    'wrong',
]
