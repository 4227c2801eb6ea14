"""Launch files: what they describe, in XML, YAML and Python, and the process that runs it.

The model is that of the package `launch`: a description is a list of actions, which are visited in
order with a context of launch configurations and environment variables. `markup` builds actions
from XML and YAML; Python files make them themselves, with the classes that `python_files` lends
them. `service` visits them all, and starts processes only when nothing was wrong.

Nothing here needs rclpy, so that ten nodes do not wait for an eleventh program.
"""
