'''Exercises that are checked on the live ROS graph, hints, solutions, quizzes, progress.

How to write the exercises of a lesson
======================================

The exercises of `notebooks/04_odds.ipynb` are in `labkit.lessons.odds`, a module or a package with
one an exercise, that defines `LESSON`. That is all: lessons are found by name. Types of messages
are given by name (`'std_msgs/msg/Int16'`), so it needs no ROS to be imported. A small one,
complete::

    """The exercises of lesson 04."""

    from labkit.exercises import (
        Choice, Exercise, Lesson, Quiz, Solution, Style, Wrong, changed, right, wrong,
    )
    from labkit.exercises.clauses import Publishes, Says
    from labkit.lessons._script import in_process

    INT16 = 'std_msgs/msg/Int16'

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
        title='Odd numbers',
        teaches='numbers on topics, types and their limits, queues; finding a silent fault',
        exercises=[
            Exercise(
                name='ones',
                task='Publish the Int16 1 on /ones, ten times a second.',
                publishes={'/ones': INT16},
                clauses=[Publishes('/ones', 10.0, INT16), Says('/ones', 1)],
                hints=['What calls a function again and again?', 'create_timer(0.1, ...)'],
                answer=Solution(NODE, 'A timer leaves the node free.'),
                styles=[Style('own process', in_process(NODE), process=True)],
                wrong=[
                    Wrong('Hz for s', changed(NODE, ('0.1', '10')), '100 times too slow'),
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

- `ones-task`: the task. Each of its bullets is the `text` of a clause, word for word; a test
  compares them. The prose around them explains, and asks for nothing more;
- `ones-starter`: the cell to edit, with `...` where the learner writes. It must run as it is,
  after a restart of the kernel, too: so it imports what it uses;
- `ones-check`: `lesson.ones.check()`, its output stored as NOT ATTEMPTED;
- a cell with `# lesson.ones.hint()` and `# lesson.ones.solution()`;
- one with `lesson.quiz('types')`.

The clauses
-----------
A task is a list of clauses, see `clauses`: what is published where and how often, without an end
(`Publishes`), what every message says (`Says`, `Messages`), what is answered to what, once and
nothing otherwise (`Answers`), what is logged (`Logs`), what a node is called (`Named`), which
service it offers and what it answers there (`Serves`, `Responds`), which parameters it has,
whether it follows them, and what it refuses (`HasParameter`, `Follows`, `Refuses`), what becomes
of the goals that are sent to its action (`Serves`, `Pursues`). A clause has
its words, looks for what must be in the graph, says which tests are sent, and judges what was
seen. A lesson says only what is special: its misconceptions. A clause of its own is a subclass of
`Clause` in the lesson's package.

What was seen is half a minute of the lives of the learner's nodes, in virtual time (`life`): each
message with the exact time at which it was published. A node that keeps a time of its own, such as
a thread with `time.sleep()`, shows that by being silent then, and is judged in real time. Tests
are drawn anew each time from all that the task allows (`draws`). Nodes of earlier exercises stand
still meanwhile. Rules of thumb:

- The exercise says what it asks for: `publishes` and `subscribes` (topics, with their types),
  `serves` (services and actions, with theirs) and `nodes` (full names). The matchers take
  the types from there. Ask in any order.
- Whether something missing is a FAIL or NOT ATTEMPTED is read off the graph, see `Scope`: an
  attempt is a node of the learner's that does what this exercise asks for and no earlier one
  does, or what may mean that, under another name. Where there is none, `traces` names what else
  is new: a node that nobody asked for, a class that was never used, a program that has ended.
- `Lesson(topics=...)` names the topics that the lesson's own cells use besides. On every topic
  that the lesson does not know, a publisher of the right type counts as a wrong name. `given`
  names nodes that these cells leave running, with the ids of the cells: they are never the
  learner's, and a node of that name that another cell has made is.
- A second publisher on a topic in `publishes` is a FAIL, whenever it comes, unless the topic is
  in `shared`, too. A publisher with best effort is one on a topic in `reliable`.
- For what is done once, before the check (`ros2 topic pub --once`), `records=['/odds']` records
  from the setup cell on: `probe.recorded['/odds']`. A recorder is a subscription, so it is counted
  by `ros2 topic info` and by publishers that wait.
- What has no clause is looked at with a probe and the matchers of `expect`: `judge=` in the place
  of `clauses=`. They return what they found or raise the outcome: `expect.publisher`, `messages`,
  `node`, `spun`, `ends_with_node` (then `once=True`), `expect.that(condition, expected=...,
  seen=..., why=..., todo=...)`, or `raise Fail(expected, seen, why=..., todo=...)`.
- What another process makes comes into the graph piece by piece. Matchers wait for what they look
  for; before counting (`len(probe.publishers('/names'))`), use `probe.wait_to_appear(condition)`.
- What the learner's code raises, in a cell or in a callback, becomes ERROR by itself, with the
  misconception behind it; such wrong answers have `outcome=Outcome.ERROR`.
- Nothing reads the learner's code or variables. Waits are for events and counts.

The proof
---------
`tests/lessons/` runs every exercise in its notebook, in a real kernel: untouched, each wrong
answer with its sentence, each style, the solution, and the check pressed again. The solution of
one exercise keeps running while the next one is proved, as it does when a learner goes on. Have
at least eight wrong answers and four other styles (`process=True`: a script in a process of its
own); each clause must refuse a wrong one. `pytest tests/lessons -k odds-ones` proves one exercise,
and `python tests/mutants -k odds-ones` asks the check about its solution with one change each.

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
