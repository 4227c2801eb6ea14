"""The buffer, the listener and the broadcasters of tf2."""

from labkit.packages.stand_in import load_installed, modules

if not load_installed(__name__):
    modules(__name__, 'exceptions', 'buffer_core', 'buffer_interface', 'buffer')
    modules(__name__, 'transform_listener', 'transform_broadcaster')
    modules(__name__, 'static_transform_broadcaster')
