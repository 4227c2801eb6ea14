import labkit as lab
from labkit.lessons.robot_description.scout import SCOUT
from labkit.programs.robot_state_publisher import RobotStatePublisher

CAMERA = """
  <link name="camera_link"/>
  <joint name="camera_joint" type="fixed">
    <parent link="head"/>
    <child link="camera_link"/>
    <origin xyz="0.04 0 0.03" rpy="0 0.349 0"/>
  </joint>
</robot>
"""


scout = lab.spin(RobotStatePublisher(SCOUT.replace('</robot>', CAMERA)))
