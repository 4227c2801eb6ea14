"""How Sphinx makes the documentation site; see `labkit.course.site`."""

from __future__ import annotations

project = html_title = 'Learn ROS 2'
extensions = ['myst_nb']
root_doc = 'index'
include_patterns = ['*.md', 'docs/*.md', 'docs/pictures/*.md', 'notebooks/*']

# The outputs are those that are stored: `labkit record` made them, and the tests compare them.
nb_execution_mode = 'off'
nb_merge_streams = True
myst_heading_anchors = 3
myst_enable_extensions = ['html_image']
# Cells with magics are no plain Python, and launch files are none.
suppress_warnings = ['misc.highlighting_failure']

html_theme = 'furo'
html_show_copyright = False
html_copy_source = False
