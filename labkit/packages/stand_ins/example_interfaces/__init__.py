"""The types of example_interfaces, each built when it is first asked for."""

from labkit.packages.built_types import stand_in

stand_in(__name__)
