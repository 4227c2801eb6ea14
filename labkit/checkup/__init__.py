"""The doctor's checks, one function per line of its table.

A check returns what it saw if that is fine, and otherwise raises a LabError that says what to do.
All of them run in any Python from 3.8 on, even without ROS.
"""
