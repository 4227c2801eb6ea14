"""`ros2 pkg`: list packages and their executables, and create a package."""

from __future__ import annotations

import sys
import xml.etree.ElementTree as ET
from argparse import Namespace
from pathlib import Path

from labkit import settings
from labkit.errors import LabError, quoted
from labkit.ros2.parser import Command, Parser, Verb, real_one
from labkit.ros2.pkg_create import CREATE
from labkit.rosgraph.packages import (
    executables,
    own_programs,
    package_names,
    prefix_of,
    with_executables,
)

__all__ = ['COMMAND']


def list_packages(args: Namespace) -> None:
    """Print the names of all packages."""
    print('\n'.join(package_names()))


def show_prefix(args: Namespace) -> None:
    """Print the folder where a package is installed."""
    prefix = _prefix(args)
    print(prefix / 'share' / args.package_name if args.share else prefix)


def show_xml(args: Namespace) -> None:
    """Print the manifest of a package."""
    path = _prefix(args) / 'share' / args.package_name / 'package.xml'
    try:
        tree = ET.parse(path)
    except (OSError, ET.ParseError) as error:
        raise LabError(f'Package xml manifest not found: {path}') from error
    if args.tag is None:
        print(ET.tostring(tree.getroot(), encoding='unicode'))
        return
    elements = tree.getroot().findall(args.tag)
    if not elements:
        tags = ', '.join(sorted({child.tag for child in tree.getroot()}))
        with real_one(says='XML tag not found'):
            raise LabError(f'XML tag not found: {quoted(args.tag)}', todo=f'It has: {tags}.')
    for element in elements:
        print(element.text)


def _prefix(args: Namespace) -> Path:
    with real_one(says='Package not found'):
        return prefix_of(args.package_name)


def list_executables(args: Namespace) -> None:
    """Print the executables that `ros2 run` can start."""
    packages = with_executables() if args.package_name is None else [args.package_name]
    stand_ins = {}
    for package in packages:
        for one in executables(package):
            if one.stand_in:
                stand_ins[package] = own_programs(package)
            print(' '.join(one.command) if args.full_path else f'{package} {one.path.name}')
    # In a notebook, stderr is shown as an error.
    place = sys.stdout if settings.in_kernel() else sys.stderr
    for package, programs in stand_ins.items():
        print(f'({package} is not installed; labkit has its {programs}.)', file=place)


def _package_argument(parser: Parser) -> None:
    parser.add('package_name', help='The package name', complete=lambda _: package_names())


def _prefix_arguments(parser: Parser) -> None:
    _package_argument(parser)
    parser.flag('--share', 'show share directory for the package')


def _xml_arguments(parser: Parser) -> None:
    _package_argument(parser)
    parser.add('-t', '--tag', help="The package's xml's tag to print")


def _executables_arguments(parser: Parser) -> None:
    parser.add(
        'package_name',
        nargs='?',
        help='The package name',
        complete=lambda _: with_executables(),
    )
    parser.flag('--full-path', 'Show full path of each executable')


COMMAND = Command(
    'pkg',
    'Various package related sub-commands',
    (
        CREATE,
        Verb(
            'executables',
            'Output a list of package specific executables',
            list_executables,
            _executables_arguments,
        ),
        Verb('list', 'Output a list of available packages', list_packages),
        Verb('prefix', 'Output the prefix path of a package', show_prefix, _prefix_arguments),
        Verb(
            'xml',
            'Output the XML of the package manifest or a specific tag',
            show_xml,
            _xml_arguments,
        ),
    ),
)
