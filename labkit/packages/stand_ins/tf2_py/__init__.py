"""The buffer of tf2 that does not wait, and its exceptions."""

from labkit.packages.stand_in import load_installed, modules

if not load_installed(__name__):
    modules(__name__, 'exceptions', 'buffer_core')
