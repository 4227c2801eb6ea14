"""Where links are, held against MuJoCo, which reads URDF by itself."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from labkit.descriptions.forward_kinematics import link_transforms
from labkit.descriptions.urdf import read
from labkit.sim.parts import urdf

# An arm with turned origins, axes that are none of x, y and z, and a part that slides.
ARM = """
<robot name="arm">
  <link name="base"/>
  <joint name="a" type="revolute"><parent link="base"/><child link="one"/>
    <origin xyz="0.1 -0.2 0.3" rpy="0.4 -1.1 2.5"/><axis xyz="0.6 0 0.8"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <link name="one">BODY</link>
  <joint name="b" type="prismatic"><parent link="one"/><child link="two"/>
    <origin xyz="0 0.5 0" rpy="-0.7 0.2 0.1"/><axis xyz="0 -0.6 0.8"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <link name="two">BODY</link>
  <joint name="c" type="continuous"><parent link="two"/><child link="three"/>
    <origin xyz="-0.3 0 0.2" rpy="3 1.5 -2"/><axis xyz="0 1 0"/></joint>
  <link name="three">BODY</link>
</robot>
""".replace(
    'BODY',
    '<inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>',
)


@pytest.mark.parametrize('text', [ARM, urdf()], ids=['arm', 'burger'])
def test_links_are_where_another_program_has_them(text: str) -> None:
    options = '<mujoco><compiler fusestatic="false" discardvisual="true"/></mujoco></robot>'
    model = mujoco.MjModel.from_xml_string(text.replace('</robot>', options))
    data = mujoco.MjData(model)
    robot, random = read(text), np.random.default_rng(5)
    for _ in range(20):
        positions = {j.name: float(random.uniform(-2, 2)) for j in robot.free_joints}
        for name, position in positions.items():
            data.joint(name).qpos[0] = position
        mujoco.mj_kinematics(model, data)
        for name, found in link_transforms(robot, positions).items():
            if name == robot.root:
                continue  # that is MuJoCo's world
            body = data.body(name)
            assert found.translation == pytest.approx(tuple(body.xpos), abs=1e-9), name
            x, y, z, w = found.rotation
            same = abs(float(np.dot((w, x, y, z), body.xquat)))
            assert same == pytest.approx(1.0, abs=1e-9), name
