"""`ros2 pkg create`: the files and the words of the real one, and complaints in words."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from labkit.packages.skeleton import LICENSES, Skeleton, check_name, own_name
from labkit.ros2.completion import complete_line
from labkit.ros2.shell import run_line

ME = '--maintainer-name me --maintainer-email me@example.org'
SAID = """\
going to create a new package
package name: lab
destination directory: {here}
package format: 3
version: 0.0.0
description: TODO: Package description
maintainer: ['me <me@example.org>']
licenses: ['Apache-2.0']
build type: ament_python
dependencies: ['rclpy', 'std_msgs']
node_name: talker
creating folder ./lab
creating ./lab/package.xml
creating source folder
creating folder ./lab/lab
creating ./lab/setup.py
creating ./lab/setup.cfg
creating folder ./lab/resource
creating ./lab/resource/lab
creating ./lab/lab/__init__.py
creating folder ./lab/test
creating ./lab/test/test_copyright.py
creating ./lab/test/test_flake8.py
creating ./lab/test/test_pep257.py
creating ./lab/lab/talker.py
"""
PACKAGE_XML = """\
<?xml version="1.0"?>
<?xml-model href="http://download.ros.org/schema/package_format3.xsd" \
schematypens="http://www.w3.org/2001/XMLSchema"?>
<package format="3">
  <name>lab</name>
  <version>0.0.0</version>
  <description>TODO: Package description</description>
  <maintainer email="me@example.org">me</maintainer>
  <license>Apache-2.0</license>

  <depend>rclpy</depend>
  <depend>std_msgs</depend>

  <test_depend>ament_copyright</test_depend>
  <test_depend>ament_flake8</test_depend>
  <test_depend>ament_pep257</test_depend>
  <test_depend>python3-pytest</test_depend>

  <export>
    <build_type>ament_python</build_type>
  </export>
</package>
"""
SETUP_PY = """\
from setuptools import find_packages, setup

package_name = 'lab'

setup(
    name=package_name,
    version='0.0.0',
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages',
            ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
    ],
    install_requires=['setuptools'],
    zip_safe=True,
    maintainer='me',
    maintainer_email='me@example.org',
    description='TODO: Package description',
    license='Apache-2.0',
    tests_require=['pytest'],
    entry_points={
        'console_scripts': [
            'talker = lab.talker:main'
        ],
    },
)
"""
WITHOUT_TEXT = """
[WARNING]: No text of the license '{}' comes with this ros2.  This has been set in the \
package.xml, but no LICENSE file has been created.
"""
UNKNOWN = """
[WARNING]: Unknown license 'TODO: License declaration'.  This has been set in the package.xml, \
but no LICENSE file has been created.
It is recommended to use one of the ament license identifiers:
Apache-2.0
BSL-1.0
BSD-2.0
BSD-2-Clause
BSD-3-Clause
GPL-3.0-only
LGPL-3.0-only
MIT
MIT-0
"""


@pytest.fixture(autouse=True)
def workspace(tmp_path: Path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def said(capsys, line: str) -> tuple[int, str, str]:
    code = run_line(f'pkg create {line}')
    shown = capsys.readouterr()
    return code, shown.out, shown.err


def files(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob('*') if path.is_file()}


def test_a_package_with_a_node_is_that_of_the_real_one(capsys, workspace):
    line = f'--build-type ament_python lab --dependencies rclpy std_msgs --node-name talker {ME}'
    assert said(capsys, f'{line} --license Apache-2.0') == (0, SAID.format(here=workspace), '')
    lab = workspace / 'lab'
    assert files(lab) == {
        *('package.xml', 'setup.py', 'setup.cfg', 'resource/lab', 'LICENSE'),
        *('lab/__init__.py', 'lab/talker.py'),
        *('test/test_copyright.py', 'test/test_flake8.py', 'test/test_pep257.py'),
    }
    assert (lab / 'package.xml').read_text() == PACKAGE_XML
    assert (lab / 'setup.py').read_text() == SETUP_PY
    assert (lab / 'setup.cfg').read_text() == (
        '[develop]\nscript_dir=$base/lib/lab\n[install]\ninstall_scripts=$base/lib/lab\n'
    )
    assert (lab / 'lab/__init__.py').read_text() == (lab / 'resource/lab').read_text() == ''
    assert 'Apache License' in (lab / 'LICENSE').read_text()
    hello = subprocess.check_output([sys.executable, 'lab/lab/talker.py'], text=True)
    assert hello == 'Hi from lab.\n'
    for path in lab.rglob('*.py'):
        ast.parse(path.read_text())
    test = (lab / 'test/test_flake8.py').read_text()
    assert 'from ament_flake8.main import main_with_errors\nimport pytest\n' in test
    assert "rc = main(argv=['.', 'test'])" in (lab / 'test/test_pep257.py').read_text()
    assert '@pytest.mark.skip(' in (lab / 'test/test_copyright.py').read_text()


def test_without_options_the_placeholders_are_those_of_the_real_one(capsys, workspace):
    code, out, err = said(capsys, f'lab --build-type ament_python {ME}')
    assert (code, err) == (0, '') and out.endswith(UNKNOWN)
    assert 'dependencies: []\ncreating folder ./lab\n' in out
    assert not (workspace / 'lab/LICENSE').exists()
    xml = (workspace / 'lab/package.xml').read_text()
    assert '<license>TODO: License declaration</license>\n\n  <test_depend>' in xml
    setup = (workspace / 'lab/setup.py').read_text()
    assert "        'console_scripts': [\n        ],\n" in setup


def test_options_go_where_they_belong(capsys, workspace):
    line = 'lab --build-type ament_python --package-format 2 --library-name tools --license MIT'
    extra = "--destination-directory a/b --description 'it is & was <new>'"
    code, out, err = said(capsys, f'{line} {extra} {ME}')
    assert (code, err) == (0, '')
    assert f'destination directory: {workspace}/a/b\n' in out
    assert 'library_name: tools\n' in out
    made = 'creating folder a/b/lab/lab/tools\ncreating a/b/lab/lab/tools/__init__.py\n'
    assert out.partition(made)[1:] == (made, WITHOUT_TEXT.format('MIT'))
    assert not (workspace / 'a/b/lab/LICENSE').exists()
    assert ET.parse(workspace / 'a/b/lab/package.xml').findtext('description') == (
        'it is & was <new>'
    )
    assert '<package format="2">' in (workspace / 'a/b/lab/package.xml').read_text()


def test_a_launch_file_is_made_and_installed(capsys, workspace):
    line = f'lab --build-type ament_python --node-name talker --license MIT {ME}'
    code, out, err = said(capsys, f'{line} --launch-file lab.launch.xml')
    assert (code, err) == (0, '')
    assert 'creating folder ./lab/launch\ncreating ./lab/launch/lab.launch.xml\n' in out
    assert (workspace / 'lab/launch/lab.launch.xml').read_text() == (
        '<launch>\n  <node pkg="lab" exec="talker" output="screen"/>\n</launch>\n'
    )
    line = "        ('share/' + package_name + '/launch', ['launch/lab.launch.xml']),\n"
    assert line in (workspace / 'lab/setup.py').read_text()
    xml = ET.parse(workspace / 'lab/package.xml')
    assert xml.findtext('exec_depend') == 'ros2launch'
    _, _, err = said(capsys, f'other --build-type ament_python --launch-file ../a.launch.xml {ME}')
    assert "'../a.launch.xml' can not be the name of the launch file." in err


def test_a_node_of_the_name_of_the_library_is_renamed(capsys):
    line = f'lab --build-type ament_python --library-name x --node-name x {ME} --license MIT'
    code, out, err = said(capsys, line)
    assert code == 0 and 'creating ./lab/lab/x_node.py\n' in out
    assert err == (
        '[WARNING] node name can not be equal to the library name\n'
        '[WARNING] renaming node to x_node\n'
    )


def test_the_licenses_are_listed(capsys):
    assert said(capsys, "lab --license '?'") == (0, 'Supported licenses:\nApache-2.0\n', '')


@pytest.mark.parametrize('name', LICENSES)
def test_a_license_is_declared_and_comes_with_its_text_or_a_warning(capsys, workspace, name):
    code, out, _ = said(capsys, f'lab --build-type ament_python {ME} --license {name}')
    assert code == 0
    xml = ET.parse(workspace / 'lab/package.xml')
    assert xml.findtext('license') == name
    written = (workspace / 'lab/LICENSE').exists()
    assert written == (name == 'Apache-2.0') != out.endswith(WITHOUT_TEXT.format(name))


def test_text_with_quotation_marks_stays_python_and_xml():
    text = 'a \'b\' "c" \\ {d} <e>'
    package = Skeleton(name='lab', maintainer=text, email='a"b@c', description=text)
    call = ast.parse(package.setup_py()).body[-1]
    assert isinstance(call, ast.Expr) and isinstance(call.value, ast.Call)
    given = {
        word.arg: word.value.value
        for word in call.value.keywords
        if isinstance(word.value, ast.Constant)
    }
    assert (given['maintainer'], given['description']) == (text, text)
    root = ET.fromstring(package.package_xml())
    assert (root.findtext('maintainer'), root.findtext('description')) == (text, text)
    maintainer = root.find('maintainer')
    assert maintainer is not None and maintainer.get('email') == 'a"b@c'


def test_what_is_there_is_left_alone(capsys, workspace):
    (workspace / 'lab').mkdir()
    code, out, err = said(capsys, f'lab --build-type ament_python {ME}')
    assert (code, out) == (1, '')
    assert err == (
        '\nAborted!\nThe directory already exists: ./lab\nEither remove the directory or choose '
        'a different destination directory or package name\n'
    )
    assert files(workspace / 'lab') == set()


def test_a_folder_that_can_not_be_made(capsys, workspace):
    (workspace / 'file').write_text('')
    line = f'lab --build-type ament_python {ME} --destination-directory file'
    code, _, err = said(capsys, line)
    assert code == 1 and err.startswith('file/lab can not be made: Not a directory.\n')


@pytest.mark.parametrize(
    ('words', 'complaint', 'todo'),
    [
        ('robot-lab', "'robot-lab' can not be the name of a package", ': robot_lab'),
        ('2lab', "'2lab' can not be the name of a package", ': lab'),
        ('class', "'class' can not be the name of a package", 'digits and underscores.'),
        ('../lab', "'../lab' can not be the name of a package", ': lab'),
        ('lab --node-name my-node', "'my-node' can not be the name of a node", ': my_node'),
        ('test', "packages can't be named 'test'", ''),
    ],
)
def test_bad_names(capsys, workspace, words, complaint, todo):
    code, out, err = said(capsys, f'--build-type ament_python {words}')
    assert (code, out) == (1, '') and complaint in err and err.rstrip().endswith(todo)
    assert os.listdir(workspace) == []


def test_other_build_types_are_refused_in_a_sentence(capsys, workspace):
    assert said(capsys, 'lab') == (
        1,
        '',
        'ros2 pkg create makes packages of the build type ament_python here, not '
        "'ament_cmake'.\nFor nodes in Python: --build-type ament_python\n",
    )
    code, _, err = said(capsys, 'lab --build-type ament_pyton')
    assert code == 2 and "did you mean 'ament_python'?" in err
    assert os.listdir(workspace) == []


def test_capital_letters_are_allowed_as_there():
    check_name('RobotLab')


def test_a_user_without_a_name(monkeypatch):
    def nobody() -> str:
        raise KeyError('no name')

    monkeypatch.setattr('getpass.getuser', nobody)
    assert own_name() == 'user'


def test_completion_of_its_options():
    assert 'ament_python' in complete_line('pkg create --build-type ')[1]
    assert complete_line('pkg create --license MI')[1] == ['MIT', 'MIT-0']
