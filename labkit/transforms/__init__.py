"""Where things are: tf2's buffer of coordinate frames, its listener and its broadcasters.

No wheel has tf2. `import tf2_ros`, `tf2_py` and `tf2_geometry_msgs` find what is here, unless
they are installed; the modules have the names of the real ones.
"""
