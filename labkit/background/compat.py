"""Every private name of rclpy and ipykernel that labkit touches, and nothing else.

Each has a contract test in tests/background/test_compat.py: with a new rclpy or ipykernel, those
tests say in a minute whether it still fits.
"""

from __future__ import annotations

from rclpy._rclpy_pybind11 import RCLError

__all__ = ['RCLError']
