"""Vectors and unit quaternions as tuples of floats: (x, y, z) and (x, y, z, w).

The formulas, and the order of what they add, are those of tf2's LinearMath, which is Bullet's
(ros2/geometry2, tf2/include/tf2/LinearMath: Quaternion.h, Matrix3x3.h), so that results are the
same to the last digits, the sign of a quaternion included. Plain floats: for so few numbers numpy
takes ten times as long.
"""

from __future__ import annotations

import math

__all__ = [
    'Matrix',
    'Quaternion',
    'Vector',
    'from_rpy',
    'interpolated',
    'inverse',
    'matrix',
    'normalized',
    'product',
    'rotated',
    'slerp',
    'to_rpy',
]

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
Matrix = tuple[Vector, Vector, Vector]


def from_rpy(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return the turn about the fixed x axis, then y, then z; angles in rad."""
    sin_x, cos_x = math.sin(roll / 2), math.cos(roll / 2)
    sin_y, cos_y = math.sin(pitch / 2), math.cos(pitch / 2)
    sin_z, cos_z = math.sin(yaw / 2), math.cos(yaw / 2)
    return (
        sin_x * cos_y * cos_z - cos_x * sin_y * sin_z,
        cos_x * sin_y * cos_z + sin_x * cos_y * sin_z,
        cos_x * cos_y * sin_z - sin_x * sin_y * cos_z,
        cos_x * cos_y * cos_z + sin_x * sin_y * sin_z,
    )


def to_rpy(m: Matrix) -> Vector:
    """Return the angles about the fixed x axis, then y, then z, rad, of a rotation matrix.

    Where x and z turn about the same axis, the angle about z is 0.
    """
    if abs(m[2][0]) >= 1.0:
        return math.atan2(m[2][1], m[2][2]), math.copysign(math.pi / 2, -m[2][0]), 0.0
    pitch = -math.asin(m[2][0])
    cos = math.cos(pitch)
    return (
        math.atan2(m[2][1] / cos, m[2][2] / cos),
        pitch,
        math.atan2(m[1][0] / cos, m[0][0] / cos),
    )


def product(a: Quaternion, b: Quaternion) -> Quaternion:
    """Return the rotation that rotates by `b`, then by `a`."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by + ay * bw + az * bx - ax * bz,
        aw * bz + az * bw + ax * by - ay * bx,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def inverse(q: Quaternion) -> Quaternion:
    """Return the rotation back."""
    return -q[0], -q[1], -q[2], q[3]


def rotated(q: Quaternion, v: Vector) -> Vector:
    """Return a vector rotated by a quaternion: q v q⁻¹."""
    x, y, z, w = q
    vx, vy, vz = v
    a = w * vx + y * vz - z * vy
    b = w * vy + z * vx - x * vz
    c = w * vz + x * vy - y * vx
    d = -x * vx - y * vy - z * vz
    return (
        -d * x + a * w - b * z + c * y,
        -d * y + b * w - c * x + a * z,
        -d * z + c * w - a * y + b * x,
    )


def slerp(a: Quaternion, b: Quaternion, ratio: float) -> Quaternion:
    """Return the rotation between two at a constant angular speed, the shorter way round."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    dot = ax * bx + ay * by + az * bz + aw * bw
    length = math.sqrt(
        (ax * ax + ay * ay + az * az + aw * aw) * (bx * bx + by * by + bz * bz + bw * bw)
    )
    sign = -1.0 if dot < 0 else 1.0
    theta = math.acos(min(sign * dot / length, 1.0))
    if theta == 0.0:
        return a
    inverse_sine = 1.0 / math.sin(theta)
    of_a = math.sin((1.0 - ratio) * theta)
    of_b = sign * math.sin(ratio * theta)
    return (
        (ax * of_a + bx * of_b) * inverse_sine,
        (ay * of_a + by * of_b) * inverse_sine,
        (az * of_a + bz * of_b) * inverse_sine,
        (aw * of_a + bw * of_b) * inverse_sine,
    )


def interpolated(a: Vector, b: Vector, ratio: float) -> Vector:
    """Return the point between two."""
    rest = 1.0 - ratio
    return rest * a[0] + ratio * b[0], rest * a[1] + ratio * b[1], rest * a[2] + ratio * b[2]


def matrix(q: Quaternion) -> Matrix:
    """Return the rotation matrix of a quaternion of any length; NaN if the length is 0."""
    x, y, z, w = q
    square = x * x + y * y + z * z + w * w
    s = 2.0 / square if square else math.nan
    xs, ys, zs = x * s, y * s, z * s
    wx, wy, wz = w * xs, w * ys, w * zs
    xx, xy, xz = x * xs, x * ys, x * zs
    yy, yz, zz = y * ys, y * zs, z * zs
    return (
        (1.0 - (yy + zz), xy - wz, xz + wy),
        (xy + wz, 1.0 - (xx + zz), yz - wx),
        (xz - wy, yz + wx, 1.0 - (xx + yy)),
    )


def normalized(m: Matrix) -> Quaternion:
    """Return the unit quaternion of a rotation matrix: of the two, the one that tf2 returns."""
    trace = m[0][0] + m[1][1] + m[2][2]
    if trace > 0.0:
        s = math.sqrt(trace + 1.0)
        w = s * 0.5
        s = 0.5 / s
        return (m[2][1] - m[1][2]) * s, (m[0][2] - m[2][0]) * s, (m[1][0] - m[0][1]) * s, w
    # The greatest of the three; of equal ones the first.
    i = max(range(3), key=lambda each: m[each][each])
    j, k = (i + 1) % 3, (i + 2) % 3
    s = math.sqrt(m[i][i] - m[j][j] - m[k][k] + 1.0)
    parts = [0.0, 0.0, 0.0, 0.0]
    parts[i] = s * 0.5
    s = 0.5 / s
    parts[3] = (m[k][j] - m[j][k]) * s
    parts[j] = (m[j][i] + m[i][j]) * s
    parts[k] = (m[k][i] + m[i][k]) * s
    return parts[0], parts[1], parts[2], parts[3]
