"""What the doctor looks at, one function a line of its table.

A check takes nothing, returns what it saw if that is well, and raises a LabError with what to do
if it isn't. All of it runs in any Python from 3.8 on, and none of it needs ROS to be there.
"""
