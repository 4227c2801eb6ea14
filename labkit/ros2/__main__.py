"""`python3 -m labkit.ros2`, the same as `ros2`."""

import sys

from labkit.ros2 import main

sys.exit(main())
