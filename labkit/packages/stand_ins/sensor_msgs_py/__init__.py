"""Point clouds as arrays, and back."""

from labkit.packages.stand_in import load_installed, modules

if not load_installed(__name__):
    modules(__name__, 'point_cloud2')
