"""Packages that colcon builds: their files, and nodes exported from a notebook."""
