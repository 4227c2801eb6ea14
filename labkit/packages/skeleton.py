"""The files of an `ament_python` package, as `ros2 pkg create` of Jazzy makes them.

Form and wording are those of the templates of ros2cli 0.32, because tools and tutorials expect
them. Unlike there, text is escaped for the file that it goes into: a description may hold `&`.
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

from labkit.errors import LabError

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
# Identifiers of the licenses whose text is here, in the order in which ros2cli names them.
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
    ],
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
# The tests of style carry the notice of those who wrote them, wherever they are generated.
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
        path: Where it lies, from the folder of the package on.
        text: What the file holds, None for a folder.
    """

    path: str
    text: str | None = None

    def write(self, folder: Path) -> None:
        """Make it in the folder of the package.

        Raises:
            OSError: It can't be made.
        """
        if self.text is None:
            (folder / self.path).mkdir(parents=True, exist_ok=True)
        else:
            (folder / self.path).write_text(self.text, encoding='utf-8')


@dataclass(frozen=True, kw_only=True)
class Skeleton:
    """What an `ament_python` package says about itself, and its files.

    Attributes:
        name: Its name, see `check_name`.
        maintainer: Name of who looks after it.
        email: Where they can be reached.
        description: A sentence on what it does.
        license: An SPDX identifier, or any other text.
        dependencies: Names of packages that it needs.
        test_dependencies: What its tests need.
        scripts: Name of each executable -> the function that it runs: `'talker.talker:main'`.
        format: Version of the form of package.xml, 2 or 3.
    """

    name: str
    maintainer: str
    email: str
    description: str = DESCRIPTION
    license: str = LICENSE
    dependencies: Sequence[str] = ()
    test_dependencies: Sequence[str] = TEST_DEPENDENCIES
    scripts: Sequence[tuple[str, str]] = ()
    format: int = 3

    def parts(self) -> list[Part]:
        """Return its files and folders, in the order in which they are made."""
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
        """Return the tests that come with a new package: of copyright, style and docstrings."""
        return [
            Part('test/test_copyright.py', _NOTICE.format(year=2015) + _TEST_COPYRIGHT),
            Part('test/test_flake8.py', _NOTICE.format(year=2017) + _TEST_FLAKE8),
            Part('test/test_pep257.py', _NOTICE.format(year=2015) + _TEST_PEP257),
        ]

    def node(self, name: str) -> Part:
        """Return a module with a `main()` that says hello."""
        return Part(f'{self.name}/{name}.py', _MAIN_PY.format(name=self.name))

    def package_xml(self) -> str:
        """Return the text of package.xml."""
        groups = {'depend': self.dependencies, 'test_depend': self.test_dependencies}
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
        # As in the template, a single entry has no comma behind it; several need them.
        scripts = ',\n'.join(f"            '{name} = {where}'" for name, where in self.scripts)
        return _SETUP_PY.format(
            name=_quoted(self.name),
            version=VERSION,
            maintainer=_quoted(self.maintainer),
            email=_quoted(self.email),
            description=_quoted(self.description),
            license=_quoted(self.license),
            scripts=scripts + ('\n' if scripts else ''),
        )


def check_name(name: str, what: str = 'package') -> None:
    """Raise a LabError unless a package or a node can be called so.

    Args:
        name: The name. It becomes the name of a module, so it has to be one in Python.
        what: What it is the name of, for the error.
    """
    if re.fullmatch(r'[A-Za-z][A-Za-z0-9_]*', name) is None or keyword.iskeyword(name):
        better = re.sub(r'[^a-z0-9_]+', '_', name.lower()).strip('_0123456789')
        todo = 'Begin with a letter, and use only small letters, digits and underscores'
        good = better and not keyword.iskeyword(better) and better != name
        raise LabError(
            f'{name!r} can not be the name of a {what}: Python imports it under that name.',
            todo=f'{todo}: {better}' if good else f'{todo}.',
        )
    if what == 'package' and name == 'test':
        raise LabError(
            "Aborted since 'ament_python' packages can't be named 'test'. Please choose a "
            'different package name.'
        )


def license_text(name: str) -> str | None:
    """Return the text of a license, None if there is none of that name."""
    if name not in LICENSES:
        return None
    path = Path(__file__).parent / 'licenses' / f'{name}.txt'
    return path.read_text(encoding='utf-8')


def own_name() -> str:
    """Return the name of the user of this computer."""
    try:
        return getpass.getuser()
    except (KeyError, OSError):  # nobody that the system knows
        return 'user'


def own_email(name: str) -> str:
    """Return the address that git has for its user, or a placeholder.

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
    """Return text as a piece of Python, in single quotes."""
    inner = repr('"' + text)  # with a double quote inside, repr() takes single ones
    return f"'{inner[2:]}"
