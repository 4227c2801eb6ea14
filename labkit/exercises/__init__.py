'''Exercises that are checked on the live ROS graph, hints, solutions, quizzes, progress.

How to write the exercises of a lesson
======================================

The exercises of `notebooks/04_odds.ipynb` are in the package `labkit.lessons.odds`, which defines
`LESSON`. That is all: lessons are found by name. Types of messages are given by name
(`'std_msgs/msg/Int16'`), so it needs no ROS to be imported. It lists the modules of its exercises,
and its quizzes::

    """The exercises and the quiz of `04_odds.ipynb`."""

    from labkit.exercises import Lesson
    from labkit.lessons.odds import ones
    from labkit.lessons.odds.quiz import QUIZ

    LESSON = Lesson(
        'odds',
        '04_odds.ipynb',
        title='Odd numbers',
        teaches='numbers on topics, types and their limits, queues; finding a silent fault',
        exercises=[ones],
        quizzes=[QUIZ],
    )

An exercise is a judge, `ones.py`, and its words, `ones.yaml`, see `words`::

    """Exercise: the number 1, without end."""

    from labkit.exercises import Exercise, words_of
    from labkit.exercises.clauses import Publishes, Says

    WORDS = words_of(__file__)

    exercise = Exercise(
        words=WORDS,
        clauses=[Publishes('/ones', 10.0, 'std_msgs/msg/Int16'), Says('/ones', 1)],
    )

So is a quiz, which needs Python for what the graph tells alone: `QUIZ = Quiz.of(WORDS, 'types')`.

The solution is the file `solutions/ones.py` beside that module, as a learner would write it in the
cell, formatted and linted as all code is. It imports `labkit as lab` as a file must, and is shown
without that line. One with magics is a file of IPython, `ones.ipy`.

In the notebook are, with these cell ids (an underscore of the name becomes a dash):

- `ones-task`: the task. Its bullets are the texts of the clauses: `labkit record` writes them. The
  prose around them explains, and asks for nothing more;
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
seen. A lesson says only what is special: its mistakes. A clause of its own is a subclass of
`GraphClause` in the lesson's package. A node that is to remember something, such as a sum or every
third message, is an `Answers` whose `answer` is a generator function, as are its models.

An exercise that does not take place in the graph has a `stage`: see `judging`. The one loop there
lets each clause judge what the stage shows. What such an exercise asks for, and no other one, is
an `Asked`: words of the task, and a function that raises `Fail` if what is shown is otherwise.

The mistakes
------------
A `Mistake` has an id, which begins with the name of its exercise, the words for a misconception, a
model of what a program with it sends, and the change of the solution that makes such a program:
the proof makes each of them. `Answers(mistakes=...)` names the first one whose model answers as
the node did; another judge raises it: `Fail(expected, seen, MISTAKE)`, or
`MISTAKE.of(name=value)` where its words have names in braces. Those that can be made in any
exercise are in `common_mistakes`. Their words stand in a YAML file beside the module, see `words`.
A cause is named only if it was seen.

What was seen is half a minute of the lives of the learner's nodes, in virtual time (`life`): each
message with the exact time at which it was published. Threads that sleep, and code that asks for
the time, live in that time, too (`learner_time`). Tests are drawn anew each time from all that the
task allows (`draws`). Nodes of earlier exercises stand still meanwhile. Rules of thumb:

- Topics, services, actions and nodes that the exercise is about, with their types, are read off
  its clauses (`Clause.roles`). `publishes=` and the like add what no clause says.
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
- Clauses look at things with the matchers of `expect`, which return what they found or raise the
  outcome: `expect.publisher`, `messages`, `node`, `spun`, `ends_with_node` (then `once=True`),
  `expect.that(condition, expected=..., seen=..., mistake=...)`.
- What another process makes comes into the graph piece by piece. Matchers wait for what they look
  for; before counting (`len(probe.publishers('/names'))`), use `probe.wait_to_appear(condition)`.
- What the learner's code raises, in a cell or in a callback, becomes ERROR by itself, with the
  misconception behind it; such wrong answers have `outcome=ERROR`.
- A verdict on what was attempted rests on the graph, never on the learner's code or variables.
  Only where nothing is in the graph, `traces` looks there for the reason. Waits are for events
  and counts.

The proof
---------
`tests/lessons/` runs every exercise in its notebook, in a real kernel: untouched, each wrong
answer with its sentence, each style, the solution, and the check pressed again. The solution of
one exercise keeps running while the next one is proved, as it does when a learner goes on. The
answers stand in `tests/lessons/cases/odds/ones.py`, as changes of the solution::

    from cases import right, wrong

    ANSWERS = [
        wrong('Hz for s', '100 times too slow', ('create_timer(0.1,', 'create_timer(10,')),
        right('functions'),
        wrong('not spun', 'nothing runs its callbacks'),
    ]

What is another program is a file beside the table, `ones/functions.py`. The answers that every
exercise has are generated from its solution: a node that is not spun, another topic, a wrong type,
a process of its own, and the others in `tests/lessons/cases/generic.py`. A row with such a name
and no changes tells what becomes of it here, if that is not the usual. With these, have at least
eight wrong answers and four other styles; each clause must refuse a wrong one. `pytest
tests/lessons -k odds-ones` proves one exercise, and `python tests/mutants -k odds-ones` asks the
check about its solution with one change each.

Ruff looks at all of these answers as it does at other code. Where what it finds is the mistake
itself, as a name that is not defined, the wrong answer says so: `refused='The name is not
defined.'`.
'''

from __future__ import annotations

from labkit.exercises import expect
from labkit.exercises.exercise import Exercise, Solution
from labkit.exercises.judging import Clause, Stage
from labkit.exercises.lesson import Lesson
from labkit.exercises.messages_heard import Watch
from labkit.exercises.mistakes import Mistake, anything
from labkit.exercises.probe import Probe
from labkit.exercises.quiz.guess import guesses_of
from labkit.exercises.quiz.questions import Choice, Number, Several, Word, right, wrong
from labkit.exercises.quiz.quiz import Quiz
from labkit.exercises.verdict import Fail, NotAttempted, Outcome
from labkit.exercises.words import words_of

__all__ = [
    'Choice',
    'Clause',
    'Exercise',
    'Fail',
    'Lesson',
    'Mistake',
    'NotAttempted',
    'Number',
    'Outcome',
    'Probe',
    'Quiz',
    'Several',
    'Solution',
    'Stage',
    'Watch',
    'Word',
    'anything',
    'expect',
    'guesses_of',
    'right',
    'words_of',
    'wrong',
]
