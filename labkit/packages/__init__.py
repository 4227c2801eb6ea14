"""Packages that colcon builds: their files, and nodes of a notebook in them."""
