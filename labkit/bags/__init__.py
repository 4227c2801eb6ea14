"""Bags: recorded messages, in files that rosbag2 and its tools can read.

They are read (`reader`), recorded (`recorder`) and played back (`player`). The libraries `mcap`
and `sqlite3` read and write records in files; types that are not installed, and bags that are
compressed as a whole, are left to `rosbags`. Nothing here prints.
"""
