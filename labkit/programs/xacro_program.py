"""`ros2 run xacro xacro`: the program of the wheel `xacro`, which no index of ROS has."""

from __future__ import annotations

__all__ = ['main']


def main() -> None:
    """Print a file with its macros made."""
    import xacro

    xacro.main()


if __name__ == '__main__':
    main()
