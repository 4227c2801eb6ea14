"""The types of tf2_msgs, each built when it is first asked for."""

from labkit.packages.built_types import stand_in

stand_in(__name__)
