"""Packages of ROS that no wheel has: what `labkit/packages/stand_ins` has under their names.

That folder is the last one of `sys.path` and of `PYTHONPATH`, so that each process of the
environment finds them there, and whatever is installed comes first.
"""

from __future__ import annotations

import sys
from importlib import import_module
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
from pathlib import Path

__all__ = ['load_installed', 'modules']


def load_installed(package: str) -> bool:
    """Load the installed package of this name instead of the one that is being imported.

    A folder that was added to `sys.path` later comes behind this one.

    Returns:
        Whether there is one.
    """
    here = str(Path(str(sys.modules[package].__file__)).parents[1])
    installed = PathFinder.find_spec(package, [path for path in sys.path if path != here])
    if installed is None or installed.loader is None:
        return False
    sys.modules[package] = module_from_spec(installed)
    installed.loader.exec_module(sys.modules[package])
    return True


def modules(package: str, *names: str) -> None:
    """Give a package the modules of `labkit.transforms` of these names, and what they export."""
    for name in names:
        module = import_module(f'labkit.transforms.{name}')
        sys.modules[f'{package}.{name}'] = module
        setattr(sys.modules[package], name, module)
        for word in module.__all__:
            setattr(sys.modules[package], word, getattr(module, word))
