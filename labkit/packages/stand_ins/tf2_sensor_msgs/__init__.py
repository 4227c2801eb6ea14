"""Point clouds in another frame."""

from labkit.packages.stand_in import load_installed, modules

if not load_installed(__name__):
    modules(__name__, 'tf2_sensor_msgs')
