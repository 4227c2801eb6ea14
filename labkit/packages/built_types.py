"""Interface packages of the tutorials that no wheel has: each type is built when it is asked for.

`labkit/rosgraph/library` has their text. The first process that needs a type builds it, by the
real colcon, into the environment, or else into the learner's own folder; all later ones load it.
A package of that name that is installed always wins: these lie at the end of `sys.path`.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import importlib
import math
import os
import re
import shutil
import sys
import sysconfig
import tempfile
import threading
from importlib.machinery import ModuleSpec
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import FrameType, ModuleType
from typing import Any

from labkit import settings
from labkit.errors import LabError
from labkit.files import locked
from labkit.packages.stand_in import load_installed
from labkit.packages.workspace import colcon, load_libraries
from labkit.rosgraph import interfaces
from labkit.setup.compiler import check_compiler

__all__ = ['is_loaded', 'is_ready', 'stand_in']

_CMAKE = Path(__file__).with_suffix('.cmake')
# The packages whose version decides what is generated; it stands in their package.xml.
_GENERATORS = ('rosidl_generator_py', 'rosidl_typesupport_c', 'rosidl_typesupport_fastrtps_c')
_PACKAGE_XML = """<?xml version="1.0"?>
<package format="3">
  <name>{}</name>
  <version>0.0.0</version>
  <description>Types written from their documented fields</description>
  <maintainer email="nobody@example.com">labkit</maintainer>
  <license>Apache-2.0</license>
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
# Services and actions contain messages of these.
_ALWAYS = {'msg': set[str](), 'srv': {'service_msgs'}, 'action': {'service_msgs', 'action_msgs'}}
_OTHER = re.compile(r'^(\w+)/\w+[\[\s]', re.MULTILINE)
_OWN = re.compile(r'^([A-Z]\w+)[\[\s]', re.MULTILINE)
# A second thread that asks for a type waits for the first.
_lock = threading.RLock()


class _NotBuilt(LabError, ImportError):
    """A type that can not be built. `except ImportError` catches it."""


def stand_in(package: str) -> None:
    """Make a package that is being imported one whose types are built, unless it is installed."""
    if load_installed(package):
        return
    # The functions of all types, which the generated code looks for here.
    name = _functions(package)
    sys.modules[name] = ModuleType(name)
    for kind in interfaces.KINDS:
        words = [each.rpartition('/')[2] for each in interfaces.names_in(package, kind)]
        module = sys.modules[f'{package}.{kind}'] = _Types(f'{package}.{kind}', words)
        setattr(sys.modules[package], kind, module)


def is_loaded(name: str) -> bool:
    """Return whether this process has the class of a type, such as `tf2_msgs/msg/TFMessage`."""
    package, kind, word = name.split('/')
    return word in vars(sys.modules.get(f'{package}.{kind}', object))


def is_ready(name: str) -> bool:
    """Return whether a type can be imported at once: it is installed, or was built before."""
    package = name.partition('/')[0]
    if package in interfaces.packages():
        return True
    return any((place / _key(name, _texts(name))).is_dir() for place in _places())


class _Types(ModuleType):
    """A module such as `example_interfaces.srv`."""

    def __init__(self, name: str, words: list[str]) -> None:
        super().__init__(name)
        self.__all__ = words
        self.__path__: list[str] = []
        self.__spec__ = ModuleSpec(name, None, is_package=True)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.__all__]

    def __getattr__(self, word: str) -> Any:
        if word not in self.__all__:
            raise AttributeError(f'module {self.__name__!r} has no attribute {word!r}')
        with _lock:
            if word not in vars(self):
                setattr(self, word, self._load(word, self._of_all(word, sys._getframe(1))))
        return vars(self)[word]

    def _of_all(self, word: str, caller: FrameType) -> str:
        """Return how far `import *` is if that asks for a type, as it does for each; else ''."""
        # Python's import system asks so, before the statement takes the names.
        if caller.f_code.co_name != '_handle_fromlist' or not caller.f_locals.get('recursive'):
            return ''
        number = self.__all__.index(word) + 1
        return (
            f' ({number} of {len(self.__all__)}: import * asks for all of them. Name those that '
            f'you use instead: from {self.__name__} import {word})'
        )

    def _load(self, word: str, of_all: str) -> Any:
        from rosidl_pycommon import (  # type: ignore[import-untyped]
            convert_camel_case_to_lower_case_underscore as to_module,
        )

        # It may have come with another type that contains it.
        package, kind = self.__name__.split('.')
        module = f'_{to_module(word)}'
        if not any(Path(path, f'{module}.py').is_file() for path in self.__path__):
            _add(package, _built(f'{package}/{kind}/{word}', of_all))
        return getattr(importlib.import_module(f'{package}.{kind}.{module}'), word)


def _add(package: str, built: Path) -> None:
    """Let the modules of a package find what was built."""
    load_libraries(sorted((built / 'lib').glob('lib*.so')))
    folder = built / 'python' / package
    name = _functions(package)
    known = sys.modules[name]
    (path,) = folder.glob(f'{name.rpartition(".")[2]}*.so')
    spec = spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    functions = module_from_spec(spec)
    spec.loader.exec_module(functions)
    found = {key: value for key, value in vars(functions).items() if not key.startswith('__')}
    vars(known).update(found)
    # Such a module has put itself there.
    sys.modules[name] = known
    for kind in interfaces.KINDS:
        if (folder / kind).is_dir():
            sys.modules[f'{package}.{kind}'].__path__.append(str(folder / kind))
    importlib.invalidate_caches()


def _functions(package: str) -> str:
    return f'{package}.{package}_s__rosidl_typesupport_c'


# -- building -----------------------------------------------------------------------------------


def _built(name: str, of_all: str = '') -> Path:
    """Return the folder with what was built of a type; build it if there is none.

    Args:
        name: The type.
        of_all: What is said beside its name while it is built.

    Raises:
        LabError: It can not be built.
    """
    texts = _texts(name)
    key = _key(name, texts)
    for place in _places():
        if (place / key).is_dir():
            return place / key
    try:
        check_compiler()
        place = _writable_place()
        _say(name, of_all)
        # Another process may be building it.
        with locked(place / 'lock', math.inf):
            if not (place / key).is_dir():
                for left in place.glob('.building-*'):
                    shutil.rmtree(left, ignore_errors=True)
                with tempfile.TemporaryDirectory(prefix='.building-', dir=place) as work:
                    _build(Path(work), name, texts, of_all).rename(place / key)
    except (LabError, OSError) as error:
        todo = error.todo if isinstance(error, LabError) else ''
        why = error.message if isinstance(error, LabError) else str(error)
        raise _NotBuilt(
            f'{name} comes with no wheel, and has to be built here. {why}', todo=todo
        ) from error
    return place / key


def _texts(name: str) -> dict[str, str]:
    """Return the texts of a type, and of those of its package within it, by their files."""
    package, kind, word = name.split('/')
    text = interfaces.path_of(name).read_text(encoding='utf-8')
    texts = {f'{kind}/{word}.{kind}': text}
    for inner in _OWN.findall(text):
        texts.update(_texts(f'{package}/msg/{inner}'))
    return texts


def _key(name: str, texts: dict[str, str]) -> str:
    """Return the name of the folder with what was built of a type."""
    return f'{name.replace("/", ".")}-{_digest(texts)}'


def _digest(texts: dict[str, str]) -> str:
    """Return what tells apart what was built of other texts, or for another Python."""
    share = Path(sys.prefix, 'share')
    files = [_CMAKE, *(share / package / 'package.xml' for package in _GENERATORS)]
    facts = [sysconfig.get_config_var('SOABI'), *(path.read_text('utf-8') for path in files)]
    return hashlib.sha256(repr([sorted(texts.items()), facts]).encode()).hexdigest()[:16]


def _places() -> list[Path]:
    """Return the folders that keep what was built: the environment's, and the learner's own."""
    return [Path(sys.prefix, 'share', 'labkit', 'types'), settings.state_dir() / 'types']


def _writable_place() -> Path:
    for place in _places():
        with contextlib.suppress(OSError):
            place.mkdir(parents=True, exist_ok=True)
            if os.access(place, os.W_OK):
                return place
    raise LabError(
        f'It would be kept in {" or ".join(map(str, _places()))}, and neither can be written.',
        todo='Set LABKIT_HOME to a folder that can be written.',
    )


def _build(work: Path, name: str, texts: dict[str, str], of_all: str) -> Path:
    """Build a type in a folder for that; return the folder with the result."""
    package = name.partition('/')[0]
    source = work / 'src' / package
    files = {'package.xml': _PACKAGE_XML.format(package), **texts}
    for file, text in {**files, 'CMakeLists.txt': _CMAKE.read_text()}.items():
        path = source / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding='utf-8')
    needed = {other for text in texts.values() for other in _OTHER.findall(text)}
    needed |= {other for file in texts for other in _ALWAYS[file.partition('/')[0]]}
    colcon(
        work,
        [package],
        label=f'Building {name}, once{of_all}',
        definitions={
            'PACKAGE': package,
            'UNIT': name.replace('/', '_'),
            'FILES': ';'.join(texts),
            'DEPENDENCIES': ';'.join(sorted(needed)),
        },
    )
    return work / 'install' / package


@functools.cache
def _say(name: str, of_all: str) -> None:
    """Tell a terminal why nothing happens; a notebook has a progress bar."""
    if settings.audience() in (settings.TERMINAL, settings.SCRIPT):
        print(f'labkit builds {name}, once for this environment{of_all}.', file=sys.stderr)
