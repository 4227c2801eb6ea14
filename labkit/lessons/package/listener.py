"""Exercise: a package made by hand, with a node that hears."""

from __future__ import annotations

from labkit.exercises import Exercise, Fail, words_of
from labkit.exercises.clauses import Asked, Evidence, Logs
from labkit.lessons.package.content import Built, InAWorkspace, Work, dependencies
from labkit.lessons.package.running import Running

__all__ = ['exercise']

WORDS = words_of(__file__)

PACKAGE, TOPIC, STRING = 'ears_lab', '/chatter', 'std_msgs/msg/String'

NO_DEPENDENCIES = WORDS.mistake('listener/no-dependencies')


def _needs(work: Work) -> None:
    named = dependencies(work)
    missing = [name for name in ('rclpy', 'std_msgs') if name not in named]
    if missing:
        raise Fail(
            'rclpy and std_msgs in package.xml',
            f'without {" and ".join(missing)}',
            NO_DEPENDENCIES.of(missing=missing[0]),
        )


LOGS = Logs(
    TOPIC,
    STRING,
    WORDS.clause('logs'),
)


def _logs(work: Work) -> None:
    evidence = Evidence(work.probe)
    hears = work.end('/listener', TOPIC, STRING, 'subscription')
    evidence.ends['subscription', TOPIC, ''] = hears
    evidence.gather([LOGS])
    LOGS.judge(evidence)


exercise = Exercise(
    words=WORDS,
    clauses=(
        Built(PACKAGE),
        Asked(WORDS.clause('needs'), _needs),
        Running('listener', 'listener', PACKAGE),
        Asked(WORDS.clause('logs-2'), _logs),
    ),
    stage=InAWorkspace(PACKAGE),
    subscribes={TOPIC: STRING},
)
