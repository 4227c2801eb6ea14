import labkit as lab
from labkit.programs.robot_state_publisher import RobotStatePublisher

CART = """
<robot name="cart">
  <link name="base_link">
    <visual>
      <origin xyz="0.04 0 0.02"/>
      <geometry><box size="0.24 0.16 0.06"/></geometry>
    </visual>
  </link>
  <link name="left_wheel">
    <visual>
      <origin rpy="1.5708 0 0"/>
      <geometry><cylinder radius="0.05" length="0.02"/></geometry>
    </visual>
  </link>
  <joint name="left_wheel_joint" type="continuous">
    <parent link="base_link"/>
    <child link="left_wheel"/>
    <origin xyz="0 0.09 0"/>
    <axis xyz="0 1 0"/>
  </joint>
  <link name="right_wheel">
    <visual>
      <origin rpy="1.5708 0 0"/>
      <geometry><cylinder radius="0.05" length="0.02"/></geometry>
    </visual>
  </link>
  <joint name="right_wheel_joint" type="continuous">
    <parent link="base_link"/>
    <child link="right_wheel"/>
    <origin xyz="0 -0.09 0"/>
    <axis xyz="0 1 0"/>
  </joint>
  <link name="caster">
    <visual>
      <geometry><sphere radius="0.02"/></geometry>
    </visual>
  </link>
  <joint name="caster_joint" type="fixed">
    <parent link="base_link"/>
    <child link="caster"/>
    <origin xyz="0.14 0 -0.03"/>
  </joint>
</robot>
"""


cart = lab.spin(RobotStatePublisher(CART))
