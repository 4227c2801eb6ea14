"""Exercise: a package made by hand, with a node that hears."""

from __future__ import annotations

from labkit.exercises import Exercise, Fail, words_of
from labkit.exercises.clauses import Asked, Evidence, Logs
from labkit.lessons.package.content import Built, InAWorkspace, Work, dependencies
from labkit.lessons.package.running import Running

__all__ = ['exercise']

WORDS = words_of(__file__)

PACKAGE, TOPIC, STRING = 'ears_lab', '/chatter', 'std_msgs/msg/String'
# Where its launch file is, in src and in what is installed.
LAUNCH = 'launch/ears.launch.xml'

NO_LAUNCH_FILE = WORDS.mistake('listener/no-launch-file')
NOT_INSTALLED = WORDS.mistake('listener/not-installed')
OTHER_FOLDER = WORDS.mistake('listener/other-folder')
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


def _installs(work: Work) -> None:
    installed = work.folder / 'install' / PACKAGE
    wanted = installed / 'share' / PACKAGE / LAUNCH
    if wanted.is_file():
        return
    if not (work.source / LAUNCH).is_file():
        raise Fail(f'{LAUNCH} in src/{PACKAGE}', 'no such file', NO_LAUNCH_FILE)
    found = next(installed.rglob(wanted.name), None)
    seen = 'it is not installed' if found is None else f'it is {found.relative_to(work.folder)}'
    raise Fail(
        f'it is installed as {wanted.relative_to(work.folder)}',
        seen,
        NOT_INSTALLED if found is None else OTHER_FOLDER,
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
        Asked(WORDS.of(file=LAUNCH, package=PACKAGE).clause('installs'), _installs),
        Running('listener', 'listener', PACKAGE),
        Asked(WORDS.clause('logs-2'), _logs),
    ),
    stage=InAWorkspace(PACKAGE),
    subscribes={TOPIC: STRING},
)
