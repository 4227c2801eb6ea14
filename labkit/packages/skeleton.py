"""The files of an `ament_python` package, as made by `ros2 pkg create` of Jazzy.

Form and wording are those of the templates of ros2cli 0.32, which tools and tutorials expect.
Unlike there, text is escaped: a description may contain `&`.
"""

from __future__ import annotations

import getpass
import keyword
import re
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

from labkit.errors import LabError, quoted

__all__ = [
    'DESCRIPTION',
    'LICENSE',
    'LICENSES',
    'VERSION',
    'Part',
    'Skeleton',
    'check_name',
    'license_text',
    'own_email',
    'own_name',
]

DESCRIPTION = 'TODO: Package description'
LICENSE = 'TODO: License declaration'
VERSION = '0.0.0'
TEST_DEPENDENCIES = ('ament_copyright', 'ament_flake8', 'ament_pep257', 'python3-pytest')
# Identifiers known to ros2cli, in its order. Only the text of the first, ROS's own, is here.
LICENSES = (
    *('Apache-2.0', 'BSL-1.0', 'BSD-2.0', 'BSD-2-Clause', 'BSD-3-Clause', 'GPL-3.0-only'),
    *('LGPL-3.0-only', 'MIT', 'MIT-0'),
)

_PACKAGE_XML = """\
<?xml version="1.0"?>
<?xml-model href="http://download.ros.org/schema/package_format{format}.xsd" \
schematypens="http://www.w3.org/2001/XMLSchema"?>
<package format="{format}">
  <name>{name}</name>
  <version>{version}</version>
  <description>{description}</description>
  <maintainer email={email}>{maintainer}</maintainer>
  <license>{license}</license>

{depends}  <export>
    <build_type>ament_python</build_type>
  </export>
</package>
"""
_SETUP_PY = """\
from setuptools import find_packages, setup

package_name = {name}

setup(
    name=package_name,
    version='{version}',
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages',
            ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
{launch}    ],
    install_requires=['setuptools'],
    zip_safe=True,
    maintainer={maintainer},
    maintainer_email={email},
    description={description},
    license={license},
    tests_require=['pytest'],
    entry_points={{
        'console_scripts': [
{scripts}        ],
    }},
)
"""
_SETUP_CFG = """\
[develop]
script_dir=$base/lib/{name}
[install]
install_scripts=$base/lib/{name}
"""
_MAIN_PY = """\
def main():
    print('Hi from {name}.')


if __name__ == '__main__':
    main()
"""
_LAUNCH_XML = """\
<launch>
{nodes}</launch>
"""
# The style tests carry the notice of their authors, wherever they are generated.
_NOTICE = """\
# Copyright {year} Open Source Robotics Foundation, Inc.
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""
_TEST_COPYRIGHT = """\
from ament_copyright.main import main
import pytest


# Remove the `skip` decorator once the source file(s) have a copyright header
@pytest.mark.skip(reason='No copyright header has been placed in the generated source file.')
@pytest.mark.copyright
@pytest.mark.linter
def test_copyright():
    rc = main(argv=['.', 'test'])
    assert rc == 0, 'Found errors'
"""
_TEST_FLAKE8 = """\
from ament_flake8.main import main_with_errors
import pytest


@pytest.mark.flake8
@pytest.mark.linter
def test_flake8():
    rc, errors = main_with_errors(argv=[])
    assert rc == 0, \\
        'Found %d code style errors / warnings:\\n' % len(errors) + \\
        '\\n'.join(errors)
"""
_TEST_PEP257 = """\
from ament_pep257.main import main
import pytest


@pytest.mark.linter
@pytest.mark.pep257
def test_pep257():
    rc = main(argv=['.', 'test'])
    assert rc == 0, 'Found code style errors / warnings'
"""


@dataclass(frozen=True)
class Part:
    """A file or a folder of a package.

    Attributes:
        path: Its path relative to the package.
        text: Content of a file, None for a folder.
    """

    path: str
    text: str | None = None

    def write(self, folder: Path) -> None:
        """Create it in the folder of the package.

        Raises:
            OSError: It can't be created.
        """
        if self.text is None:
            (folder / self.path).mkdir(parents=True, exist_ok=True)
        else:
            (folder / self.path).write_text(self.text, encoding='utf-8')


@dataclass(frozen=True, kw_only=True)
class Skeleton:
    """The metadata and the files of an `ament_python` package.

    Attributes:
        name: Its name, see `check_name`.
        email: Their address.
        description: A sentence on its purpose.
        license: An SPDX identifier, or any other text.
        dependencies: Names of required packages.
        test_dependencies: Packages required by its tests.
        launch_files: Names of files in the folder `launch`, which are installed.
        scripts: Executable -> its function: `'talker.talker:main'`.
        format: Format version of package.xml, 2 or 3.
    """

    name: str
    maintainer: str
    email: str
    description: str = DESCRIPTION
    license: str = LICENSE
    dependencies: Sequence[str] = ()
    test_dependencies: Sequence[str] = TEST_DEPENDENCIES
    scripts: Sequence[tuple[str, str]] = ()
    launch_files: Sequence[str] = ()
    format: int = 3

    def parts(self) -> list[Part]:
        """Return its files and folders, in order of creation."""
        return [
            Part(''),
            Part('package.xml', self.package_xml()),
            Part(self.name),
            Part('setup.py', self.setup_py()),
            Part('setup.cfg', _SETUP_CFG.format(name=self.name)),
            Part('resource'),
            Part(f'resource/{self.name}', ''),
            Part(f'{self.name}/__init__.py', ''),
            Part('test'),
        ]

    def style_tests(self) -> list[Part]:
        """Return the style tests of a new package: copyright, style and docstrings."""
        return [
            Part('test/test_copyright.py', _NOTICE.format(year=2015) + _TEST_COPYRIGHT),
            Part('test/test_flake8.py', _NOTICE.format(year=2017) + _TEST_FLAKE8),
            Part('test/test_pep257.py', _NOTICE.format(year=2015) + _TEST_PEP257),
        ]

    def launch(self) -> list[Part]:
        """Return its launch files, in which all of its executables are."""
        nodes = ''.join(
            f'  <node pkg="{self.name}" exec="{name}" output="screen"/>\n'
            for name, _ in self.scripts
        )
        text = _LAUNCH_XML.format(nodes=nodes)
        files = [Part(f'launch/{name}', text) for name in self.launch_files]
        return [Part('launch'), *files] if files else []

    def node(self, name: str) -> Part:
        """Return a module with a `main()` that says hello."""
        return Part(f'{self.name}/{name}.py', _MAIN_PY.format(name=self.name))

    def package_xml(self) -> str:
        """Return the text of package.xml."""
        groups = {
            'depend': self.dependencies,
            'exec_depend': ['ros2launch'] if self.launch_files else [],
            'test_depend': self.test_dependencies,
        }
        depends = ''
        for tag, names in groups.items():
            lines = [f'  <{tag}>{escape(name)}</{tag}>\n' for name in names]
            depends += ''.join(lines) + '\n' * bool(lines)
        return _PACKAGE_XML.format(
            format=self.format,
            name=self.name,
            version=VERSION,
            description=escape(self.description),
            email=quoteattr(self.email),
            maintainer=escape(self.maintainer),
            license=escape(self.license),
            depends=depends,
        )

    def setup_py(self) -> str:
        """Return the text of setup.py."""
        # As in the template, a single entry has no trailing comma; several need them.
        launch = ', '.join(_quoted(f'launch/{name}') for name in self.launch_files)
        scripts = ',\n'.join(f"            '{name} = {where}'" for name, where in self.scripts)
        return _SETUP_PY.format(
            name=_quoted(self.name),
            version=VERSION,
            maintainer=_quoted(self.maintainer),
            email=_quoted(self.email),
            description=_quoted(self.description),
            license=_quoted(self.license),
            launch=f"        ('share/' + package_name + '/launch', [{launch}]),\n" * bool(launch),
            scripts=scripts + ('\n' if scripts else ''),
        )


def check_name(name: str, what: str = 'package') -> None:
    """Raise a LabError unless a package or a node can have a name.

    Args:
        name: The name. It becomes the name of a Python module.
        what: The kind of thing, for the error.
    """
    if re.fullmatch(r'[A-Za-z][A-Za-z0-9_]*', name) is None or keyword.iskeyword(name):
        better = re.sub(r'[^a-z0-9_]+', '_', name.lower()).strip('_0123456789')
        todo = 'Begin with a letter, and use only small letters, digits and underscores'
        good = better and not keyword.iskeyword(better) and better != name
        raise LabError(
            f'{quoted(name)} can not be the name of a {what}: Python imports it under that name.',
            todo=f'{todo}: {better}' if good else f'{todo}.',
        )
    if what == 'package' and name == 'test':
        raise LabError(
            "Aborted since 'ament_python' packages can't be named 'test'. Please choose a "
            'different package name.'
        )


def license_text(name: str) -> str | None:
    """Return the text of a license, None for all but Apache-2.0."""
    if name != LICENSES[0]:
        return None
    return Path(__file__).with_name(f'{name}.txt').read_text(encoding='utf-8')


def own_name() -> str:
    """Return the name of this computer's user."""
    try:
        return getpass.getuser()
    except (KeyError, OSError):  # a user unknown to the system
        return 'user'


def own_email(name: str) -> str:
    """Return git's email address of the user, or a placeholder.

    Args:
        name: The name of the maintainer.
    """
    git = shutil.which('git')
    if git is not None:
        said = subprocess.run(
            [git, 'config', 'user.email'], stdout=subprocess.PIPE, text=True, check=False
        )
        if said.stdout.strip():
            return said.stdout.strip()
    return f'{name}@todo.todo'


def _quoted(text: str) -> str:
    """Return text as a Python literal in single quotes."""
    inner = repr('"' + text)  # with a double quote inside, repr() takes single ones
    return f"'{inner[2:]}"
