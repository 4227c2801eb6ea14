"""The robot that the lesson reads: two wheels, and a head that turns."""

from __future__ import annotations

__all__ = ['SCOUT']

SCOUT = """\
<robot name="scout">
  <link name="base_link">
    <visual>
      <origin xyz="0 0 0.03"/>
      <geometry><box size="0.20 0.12 0.06"/></geometry>
      <material name="orange"><color rgba="0.9 0.5 0.1 1"/></material>
    </visual>
  </link>

  <link name="left_wheel">
    <visual>
      <origin rpy="1.5708 0 0"/>
      <geometry><cylinder radius="0.04" length="0.02"/></geometry>
    </visual>
  </link>
  <joint name="left_wheel_joint" type="continuous">
    <parent link="base_link"/>
    <child link="left_wheel"/>
    <origin xyz="0 0.07 0"/>
    <axis xyz="0 1 0"/>
  </joint>

  <link name="right_wheel">
    <visual>
      <origin rpy="1.5708 0 0"/>
      <geometry><cylinder radius="0.04" length="0.02"/></geometry>
    </visual>
  </link>
  <joint name="right_wheel_joint" type="continuous">
    <parent link="base_link"/>
    <child link="right_wheel"/>
    <origin xyz="0 -0.07 0"/>
    <axis xyz="0 1 0"/>
  </joint>

  <link name="mast">
    <visual>
      <origin xyz="0 0 0.03"/>
      <geometry><cylinder radius="0.01" length="0.06"/></geometry>
    </visual>
  </link>
  <joint name="mast_joint" type="fixed">
    <parent link="base_link"/>
    <child link="mast"/>
    <origin xyz="0.05 0 0.06"/>
  </joint>

  <link name="head">
    <visual>
      <origin xyz="0 0 0.02"/>
      <geometry><box size="0.06 0.08 0.04"/></geometry>
    </visual>
  </link>
  <joint name="neck" type="revolute">
    <parent link="mast"/>
    <child link="head"/>
    <origin xyz="0 0 0.06"/>
    <axis xyz="0 0 1"/>
    <limit lower="-1.5" upper="1.5" effort="1" velocity="2"/>
  </joint>
</robot>
"""
