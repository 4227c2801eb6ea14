"""A laser scan as a cloud of points."""

from labkit.packages.stand_in import load_installed, modules

if not load_installed(__name__):
    modules(__name__, 'laser_geometry')
