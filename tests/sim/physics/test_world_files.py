"""Worlds from files in SDF and MJCF: what is read, and what is refused with its reason."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from labkit.errors import LabError
from labkit.sim.physics.physics_robot import PhysicsSimulator
from labkit.sim.physics.things import Crate
from labkit.sim.physics.world_files import read_world
from labkit.sim.world import Post

SDF = """<?xml version="1.0"?>
<sdf version="1.9">
  <world name="yard">
    <include><uri>model://sun</uri></include>
    <include><uri>model://pole</uri><pose>0 2 0 0 0 0</pose></include>
    <model name="floor"><static>true</static><link name="l"><collision name="c">
      <geometry><plane><normal>0 0 1</normal></plane></geometry></collision></link></model>
    <model name="wall">
      <static>true</static><pose>1 0 0 0 0 1.5707963267948966</pose>
      <link name="l"><pose>0 0 0.25 0 0 0</pose>
        <collision name="c"><geometry><box><size>2 0.2 0.5</size></box></geometry></collision>
      </link>
    </model>
    <model name="crate">
      <pose>-0.5 0.5 0.1 0 0 0.3</pose>
      <link name="l"><inertial><mass>0.7</mass></inertial>
        <collision name="c"><geometry><box><size>0.2 0.2 0.2</size></box></geometry>
          <surface><friction><ode><mu>0.25</mu></ode></friction></surface></collision></link>
    </model>
  </world>
</sdf>
"""
POLE = """<sdf version="1.9"><model name="pole"><static>true</static><link name="l">
<collision name="c"><geometry><cylinder><radius>0.1</radius><length>1</length></cylinder>
</geometry></collision></link></model></sdf>
"""
MJCF = """<mujoco>
  <worldbody>
    <geom type="plane" size="5 5 .1"/>
    <body pos="1 0 .25" euler="0 0 90"><geom type="box" size="1 .1 .25"/></body>
    <geom type="cylinder" size=".1 .5" pos="0 2 .5"/>
    <body pos="-.5 .5 .1" quat="0.98877107793 0 0 0.14943813247"><freejoint/>
      <geom type="box" size=".1 .1 .1" mass=".7" friction=".25 .005 .0001"/></body>
  </worldbody>
</mujoco>
"""


def written(folder: Path, text: str, name: str = 'world.sdf') -> Path:
    path = folder / name
    path.parent.mkdir(exist_ok=True)
    path.write_text(text)
    return path


@pytest.mark.parametrize('text', [SDF, MJCF], ids=['sdf', 'mjcf'])
def test_both_describe_the_same_world(tmp_path: Path, text: str) -> None:
    written(tmp_path, POLE, 'pole/model.sdf')
    world = read_world(written(tmp_path, text))
    assert world.plan.posts == (Post(0.0, 2.0, 0.1),)
    (crate,) = world.crates
    assert crate == pytest.approx(Crate(-0.5, 0.5, 0.3, 0.2, 0.7, 0.25))
    robot = PhysicsSimulator(world)
    ranges = robot.scan()
    # The wall's near side; the pole; the crate, whose corner is towards the robot.
    assert ranges[0] == pytest.approx(0.9 + 0.032, abs=0.01)
    assert ranges[89] == pytest.approx(1.9, abs=0.02)
    assert min(ranges[125:145]) == pytest.approx(math.hypot(0.468, 0.5) - 0.12, abs=0.03)


@pytest.mark.parametrize(
    ('text', 'old', 'new', 'said'),
    [
        (SDF, '<sdf', '<sdv', 'this is no XML'),
        (SDF, '<box><size>2', '<mesh><size>2', 'mismatched tag'),
        (SDF, 'model://pole', 'model://../pole', "and this has '../pole'"),
        (SDF, 'model://pole', 'model://mast', 'can not be read'),
        (SDF, '0 0 1.5707963267948966', '0 0.5 0', 'this is tilted'),
        (SDF, '<size>2 0.2 0.5', '<size>2 0.2', "<size> has 3 numbers, and this has '2 0.2'"),
        (SDF, '0.2 0.2 0.2', '0.2 0.2 0.4', 'only boxes with equal edges can'),
        (SDF, '<static>true</static><pose>', '<pose>', 'only boxes with equal edges can'),
        (MJCF, 'type="cylinder" size=".1 .5"', 'type="sphere" size=".1"', 'this is a sphere'),
        (MJCF, '<freejoint/>', '<joint/>', 'others are not known'),
        (MJCF, 'euler="0 0 90"', 'xyaxes="0 1 0 1 0 0"', 'turns are euler or quat'),
        (MJCF, 'pos="1 0 .25"', 'pos="1 0"', 'has 3 numbers'),
    ],
)
def test_what_is_not_known_is_said(
    tmp_path: Path, text: str, old: str, new: str, said: str
) -> None:
    written(tmp_path, POLE, 'pole/model.sdf')
    assert old in text
    with pytest.raises(LabError) as raised:
        read_world(written(tmp_path, text.replace(old, new, 1)))
    assert said in str(raised.value)


def test_models_do_not_include_each_other_for_ever(tmp_path: Path) -> None:
    again = '<sdf><include><uri>model://pole</uri></include></sdf>'
    written(tmp_path, again, 'pole/model.sdf')
    with pytest.raises(LabError, match='too deep'):
        read_world(written(tmp_path, again))


def test_another_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(LabError, match='begins with <robot>'):
        read_world(written(tmp_path, '<robot name="r"/>'))
