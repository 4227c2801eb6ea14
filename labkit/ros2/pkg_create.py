"""`ros2 pkg create`: create a Python package."""

from __future__ import annotations

import os
import re
import sys
from argparse import Namespace
from dataclasses import replace
from pathlib import Path

from labkit.errors import LabError, quoted
from labkit.packages.skeleton import (
    DESCRIPTION,
    LICENSE,
    LICENSES,
    VERSION,
    Part,
    Skeleton,
    check_name,
    license_text,
    own_email,
    own_name,
)
from labkit.ros2.parser import Parser, Verb

__all__ = ['CREATE']

BUILD_TYPES = ('cmake', 'ament_cmake', 'ament_python')


def create(args: Namespace) -> str | None:
    """Create the files of a package, and print their names."""
    if args.license == '?':
        print('Supported licenses:', LICENSES[0], sep='\n')
        return None
    if args.build_type != 'ament_python':
        raise LabError(
            f'ros2 pkg create makes packages of the build type ament_python here, not '
            f'{quoted(args.build_type)}.',
            todo='For nodes in Python: --build-type ament_python',
        )
    for name, what in (
        (args.package_name, 'package'),
        (args.node_name, 'node'),
        (args.library_name, 'library'),
    ):
        if name is not None:
            check_name(name, what)
    if args.launch_file and not re.fullmatch(r'[\w-]+\.launch\.xml', args.launch_file):
        raise LabError(
            f'{quoted(args.launch_file)} can not be the name of the launch file.',
            todo='Letters, digits and _, and then .launch.xml: --launch-file robots.launch.xml',
        )
    node_name = _node_name(args)
    package = _described(args, node_name)
    folder = os.path.join(args.destination_directory, package.name)
    if os.path.lexists(folder):
        return (
            f'\nAborted!\nThe directory already exists: {folder}\nEither remove the directory or '
            'choose a different destination directory or package name'
        )
    _announce(package, args, node_name)
    try:
        _make(package, folder, node_name, args.library_name)
    except OSError as error:
        raise LabError(
            f'{error.filename} can not be made: {error.strerror}.',
            todo='Choose another folder: --destination-directory FOLDER',
        ) from error
    _add_license(args.license, folder)
    return None


def _node_name(args: Namespace) -> str | None:
    """Return the name of the node; append `_node` if the library has the same name."""
    if args.node_name is None or args.node_name != args.library_name:
        name: str | None = args.node_name
        return name
    name = f'{args.node_name}_node'
    print('[WARNING] node name can not be equal to the library name', file=sys.stderr)
    print(f'[WARNING] renaming node to {name}', file=sys.stderr)
    return name


def _described(args: Namespace, node_name: str | None) -> Skeleton:
    maintainer = args.maintainer_name or own_name()
    package = Skeleton(
        name=args.package_name,
        maintainer=maintainer,
        email=args.maintainer_email or own_email(maintainer),
        description=args.description,
        license=args.license,
        dependencies=args.dependencies,
        format=int(args.package_format),
        launch_files=[args.launch_file] if args.launch_file else [],
    )
    scripts = [] if node_name is None else [(node_name, f'{package.name}.{node_name}:main')]
    return replace(package, scripts=scripts)


def _announce(package: Skeleton, args: Namespace, node_name: str | None) -> None:
    print('going to create a new package')
    print('package name:', package.name)
    print('destination directory:', os.path.abspath(args.destination_directory))
    print('package format:', package.format)
    print('version:', VERSION)
    print('description:', package.description)
    print('maintainer:', [f'{package.maintainer} <{package.email}>'])
    print('licenses:', [package.license])
    print('build type:', args.build_type)
    print('dependencies:', list(package.dependencies))
    if node_name:
        print('node_name:', node_name)
    if args.library_name:
        print('library_name:', args.library_name)
    if args.launch_file:
        print('launch file:', args.launch_file)


def _make(package: Skeleton, folder: str, node: str | None, library: str | None) -> None:
    parts = [*package.parts(), *package.style_tests()]
    if node:
        parts.append(package.node(node))
    if library:
        inside = f'{package.name}/{library}'
        parts += [Part(inside), Part(f'{inside}/__init__.py', '')]
    parts += package.launch()
    for part in parts:
        if part.path == package.name:
            print('creating source folder')
        what = 'creating folder' if part.text is None else 'creating'
        print(what, os.path.join(folder, part.path) if part.path else folder)
        part.write(Path(folder))


def _add_license(name: str, folder: str) -> None:
    text = license_text(name)
    if text is not None:
        Part('LICENSE', text).write(Path(folder))
        return
    if name in LICENSES:
        print(
            f"\n[WARNING]: No text of the license '{name}' comes with this ros2.  This has been "
            'set in the package.xml, but no LICENSE file has been created.'
        )
        return
    print(
        f"\n[WARNING]: Unknown license '{name}'.  This has been set in the package.xml, but no "
        'LICENSE file has been created.\nIt is recommended to use one of the ament license '
        'identifiers:',
        *LICENSES,
        sep='\n',
    )


def _arguments(parser: Parser) -> None:
    parser.add('package_name', help='The package name')
    parser.add(
        *('--package-format', '--package_format'),
        choices=['2', '3'],
        default='3',
        help='The package.xml format.',
    )
    parser.add(
        '--description', default=DESCRIPTION, help='The description given in the package.xml'
    )
    parser.add(
        '--license',
        default=LICENSE,
        help='The license attached to this package; this can be an arbitrary string, but a '
        "LICENSE file will only be generated if it is one of the supported licenses (pass '?' to "
        'get a list)',
        complete=lambda _: LICENSES,
    )
    parser.add(
        '--destination-directory',
        default=os.curdir,
        help='Directory where to create the package directory',
    )
    parser.add(
        '--build-type',
        default='ament_cmake',
        choices=BUILD_TYPES,
        help='The build type to process the package with',
    )
    parser.add('--dependencies', nargs='+', default=[], help='list of dependencies')
    parser.add('--maintainer-email', help='email address of the maintainer of this package')
    parser.add('--maintainer-name', help='name of the maintainer of this package')
    parser.add('--node-name', help='name of the empty executable')
    parser.add('--library-name', help='name of the empty library')
    parser.add(
        '--launch-file', help='name of a launch file, NAME.launch.xml, that starts the node'
    )


CREATE = Verb(
    'create',
    'Create a new ROS 2 package',
    create,
    _arguments,
    note='Here it makes packages of the build type ament_python. A name that Python could not '
    'import is refused. --launch-file is not an option of the real one.',
)
