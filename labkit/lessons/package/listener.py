"""Exercise: a package made by hand, with a node that hears."""

from __future__ import annotations

from labkit.exercises import Exercise, Fail, Mistake, Solution
from labkit.exercises.clauses import Asked, Evidence, Logs
from labkit.lessons.package.content import Built, InAWorkspace, Work, dependencies
from labkit.lessons.package.running import Running

__all__ = ['exercise']

PACKAGE, TOPIC, STRING = 'ears_lab', '/chatter', 'std_msgs/msg/String'

NO_DEPENDENCIES = Mistake(
    'listener/no-dependencies',
    'It builds here, because this machine has them. On another machine nobody would know what to '
    'install.',
    '<depend>{missing}</depend>, or --dependencies when the package is made.',
    change=[(' \\\n    --dependencies rclpy std_msgs', '')],
)


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
    'the node logs each text that comes on `/chatter` (`std_msgs/msg/String`), once',
)


def _logs(work: Work) -> None:
    evidence = Evidence(work.probe)
    hears = work.end('/listener', TOPIC, STRING, 'subscription')
    evidence.ends['subscription', TOPIC, ''] = hears
    evidence.gather([LOGS])
    LOGS.judge(evidence)


exercise = Exercise(
    name='listener',
    task='Make the package ears_lab with a listener, build it, and run it in a terminal.',
    clauses=(
        Built(PACKAGE),
        Asked('its package.xml names `rclpy` and `std_msgs` as dependencies', _needs),
        Running('listener', 'listener', PACKAGE),
        Asked(LOGS.text, _logs),
    ),
    stage=InAWorkspace(PACKAGE),
    subscribes={TOPIC: STRING},
    hints=[
        'ros2 pkg create with --node-name listener makes the module and its entry in setup.py.',
        '--dependencies rclpy std_msgs goes into package.xml. Give --build-type ament_python, '
        'and be in ros2_ws/src.',
        'Then put your own listener into ears_lab/ears_lab/listener.py, with main(). In ros2_ws: '
        'colcon build --packages-select ears_lab, source install/setup.bash, and ros2 run.',
    ],
    answer=Solution(
        __file__,
        'listener.sh',
        'The command makes the files, with an entry for listener. The module is replaced by one '
        'with a node, and main() spins it until Ctrl-C. This cell does it all at once: cat writes '
        'a file, and & stands for a second terminal.',
    ),
)
