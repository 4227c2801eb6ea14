"""Bags: what was published, in files that rosbag2 and its tools can read.

Read (`reader`), recorded (`recorder`), played back (`player`), and written in another form
(`convert`). MCAP files are written and indexed here (`mcap_records`), because no library does it
so that a bag can be read after its program was killed; what has to do with types and compression
is left to `rosbags`. Nothing here prints.
"""
