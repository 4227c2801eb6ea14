"""The quizzes on a machine of one's own: a warm-up from earlier lessons, and the lesson's own."""

from __future__ import annotations

from labkit.exercises import Choice, Number, Quiz, Several, Word, right, wrong

__all__ = ['QUIZ', 'WARM_UP']

WARM_UP = Quiz(
    'warm_up',
    Choice(
        'A terminal says `Package robot_basics_lab not found`, and the package is built. What is '
        'missing?',
        right('source install/setup.bash', 'It sets the variables of this one terminal.'),
        wrong('a second colcon build', 'What is built lies in install already.'),
        wrong('sudo', 'Nobody needs rights of the system to run a package of their own.'),
    ),
    Word(
        'Which file of a package says what other packages it needs?',
        'package.xml',
        why='Tools read it, and people, too.',
        otherwise='Lesson 11 makes it with `ros2 pkg create`. It is XML.',
        wrong={
            'setup.py': 'setup.py says which programs can be started.',
            'setup.cfg': 'setup.cfg says where the programs are put.',
        },
    ),
    Choice(
        'Two computers, both with `ROS_DOMAIN_ID=7`, stand in one network. Who finds whom?',
        right(
            'Each finds the other',
            'They have one domain, and ROS by itself looks as far as the local network.',
        ),
        wrong('Nobody: 7 is for one computer', 'A domain may span as many as you like.'),
        wrong('Only who was started first', 'Nobody is first. Each announces itself.'),
    ),
    cell_id='warm-up',
)

QUIZ = Quiz(
    'your_own_machine',
    Choice(
        'Your computer has Ubuntu 22.04. You type `sudo apt install ros-jazzy-desktop`. What '
        'happens?',
        right(
            'apt does not find the package',
            'Packages of Jazzy for apt are made for Ubuntu 24.04. Those for 22.04 are of Humble.',
        ),
        wrong('Jazzy is installed', 'Its packages are made for another version of Ubuntu.'),
        wrong(
            'Ubuntu becomes 24.04',
            'apt install adds packages. It does not put another Ubuntu in their place.',
        ),
    ),
    Choice(
        'In a new terminal `ros2` is not found, in the old one it is. What helps for good?',
        right(
            'a line in the file .bashrc',
            'Each new terminal reads it, and so sources setup.bash.',
        ),
        wrong('to install ROS once more', 'It is installed: the old terminal finds it.'),
        wrong('to source setup.bash once', 'That helps this terminal, and not the next one.'),
    ),
    Choice(
        'The code imports `sensor_msgs`, and package.xml does not name it. What does '
        '`rosdep install` do?',
        right(
            'nothing about it',
            'It reads package.xml and not the code. The import fails when the program runs.',
        ),
        wrong('It installs it', 'It does not read the code.'),
        wrong('It names it in package.xml', 'rosdep never writes to your files.'),
    ),
    Several(
        'What belongs in git?',
        right('src', 'It is what you wrote, and nobody can make it anew.'),
        right('.gitignore', 'So the others leave out the same folders.'),
        wrong('build', 'colcon makes it anew.'),
        wrong('install', 'colcon makes it anew, with the paths of each machine.'),
    ),
    Number(
        'Domain 7 begins at port 9150, since it is 7400 + 250 * 7. Where does domain 3 begin?',
        8150,
        why='It is 7400 + 250 * 3.',
        otherwise='Take the same sum with 3 for the 7.',
        wrong={750: 'That is 250 * 3. The first domain, 0, begins at 7400.'},
    ),
)
