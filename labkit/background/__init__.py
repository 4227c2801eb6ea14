"""ROS in this process: the background thread, its nodes, their output, waiting for them."""
