"""What a task asks for, clause by clause: the words of the task and the check are two faces of it.

A clause is data. Its `text` stands in the notebook; `find` looks for what has to be in the graph,
`tests` says what is sent to the nodes, and `judge` looks at half a minute of their lives.
"""

from __future__ import annotations

from labkit.exercises.clauses.acting import Goal, Pursues, Pursuit
from labkit.exercises.clauses.answering import WITHIN, Answers
from labkit.exercises.clauses.asked import Asked, Words
from labkit.exercises.clauses.asking import AsksForEach
from labkit.exercises.clauses.base import Evidence, Graph, GraphClause, Stream, Test
from labkit.exercises.clauses.logs import Logs
from labkit.exercises.clauses.messages import HasText, Messages, Says
from labkit.exercises.clauses.nodes import Named, NobodyElse, Runs, Subscribes
from labkit.exercises.clauses.parameters import Follows, HasParameter, Refuses
from labkit.exercises.clauses.publishing import OFF, Publishes, in_words, often
from labkit.exercises.clauses.qos import Latched, Matches
from labkit.exercises.clauses.serving import Call, Responds, Serves

__all__ = [
    'OFF',
    'WITHIN',
    'Answers',
    'Asked',
    'AsksForEach',
    'Call',
    'Evidence',
    'Follows',
    'Goal',
    'Graph',
    'GraphClause',
    'HasParameter',
    'HasText',
    'Latched',
    'Logs',
    'Matches',
    'Messages',
    'Named',
    'NobodyElse',
    'Publishes',
    'Pursues',
    'Pursuit',
    'Refuses',
    'Responds',
    'Runs',
    'Says',
    'Serves',
    'Stream',
    'Subscribes',
    'Test',
    'Words',
    'in_words',
    'often',
]
