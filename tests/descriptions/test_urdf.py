"""Descriptions in URDF: what they say, and what is wrong with them."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from labkit.descriptions.links_and_joints import (
    Box,
    Cylinder,
    Dynamics,
    Inertial,
    Limits,
    Material,
    Mesh,
    Mimic,
    Origin,
    Sphere,
)
from labkit.descriptions.urdf import DescriptionError, examine, read
from labkit.descriptions.urdf_checks import principal_moments

ARM = """
<robot name="arm">
  <link name="base">
    <visual name="seen">
      <origin xyz="0 0 0.05"/>
      <geometry><box size="0.2 0.3 0.1"/></geometry>
      <material name="blue"/>
    </visual>
    <visual><geometry><sphere radius="0.04"/></geometry>
      <material name="own"><color rgba="1 0 0 0.5"/></material></visual>
    <collision name="touched"><geometry><cylinder radius=".1" length="1e-1"/></geometry>
      </collision>
    <inertial>
      <origin xyz="0 0 0.05" rpy="0 0 0"/>
      <mass value="1.2"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.012" iyz="0" izz="0.02"/>
    </inertial>
  </link>
  <joint name="turn" type="revolute">
    <parent link="base"/>
    <child link="upper"/>
    <origin xyz="0 0 0.1" rpy="0 0 1.57"/>
    <axis xyz="0 0 1"/>
    <limit lower="-1.5" upper="1.5" effort="2" velocity="3"/>
    <dynamics damping="0.1"/>
  </joint>
  <link name="upper">
    <visual><geometry><mesh filename="file:///MESH" scale="0.001 0.001 0.001"/></geometry>
      <material name="own"/></visual>
  </link>
  <joint name="slide" type="prismatic">
    <parent link="upper"/> <child link="hand"/>
    <limit lower="0" upper="0.1" effort="2" velocity="3"/>
    <mimic joint="turn" multiplier="2" offset="0.01"/>
  </joint>
  <link name="hand"/>
  <material name="blue"><color rgba="0 0 0.8 1"/></material>
  <gazebo reference="base"/>
  <ros2_control name="x" type="system"/>
</robot>
"""


@pytest.fixture
def arm(tmp_path: Path) -> str:
    mesh = tmp_path / 'upper.stl'
    mesh.touch()
    return ARM.replace('/MESH', str(mesh))


def changed(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new, 1)


def said(text: str) -> list[str]:
    return [str(problem) for problem in examine(text).problems]


def test_all_is_read(arm, tmp_path):
    reading = examine(arm)
    assert reading.problems == ()
    found = read(arm)
    assert found == reading.description
    assert (found.name, found.root, [*found.links]) == ('arm', 'base', ['base', 'upper', 'hand'])
    base, upper, _ = found.links.values()
    box, ball = base.visuals
    assert (box.geometry, box.name, box.origin) == (
        Box((0.2, 0.3, 0.1)),
        'seen',
        Origin((0.0, 0.0, 0.05)),
    )
    assert box.material == Material('blue', (0.0, 0.0, 0.8, 1.0))
    assert (ball.geometry, ball.material) == (Sphere(0.04), Material('own', (1.0, 0.0, 0.0, 0.5)))
    (touched,) = base.collisions
    assert (touched.geometry, touched.name) == (Cylinder(0.1, 0.1), 'touched')
    assert base.inertial == Inertial(
        1.2, (0.01, 0.0, 0.0, 0.012, 0.0, 0.02), Origin((0.0, 0.0, 0.05))
    )
    (mesh,) = upper.visuals
    assert mesh.geometry == Mesh(f'file://{tmp_path}/upper.stl', (0.001, 0.001, 0.001))
    assert mesh.material == ball.material
    turn, slide = found.joints.values()
    assert (turn.type, turn.parent, turn.child, turn.axis) == (
        *('revolute', 'base', 'upper'),
        (0.0, 0.0, 1.0),
    )
    assert turn.limits == Limits(-1.5, 1.5, 2.0, 3.0)
    assert turn.dynamics == Dynamics(0.1, 0.0)
    assert (slide.axis, slide.mimic) == ((1.0, 0.0, 0.0), Mimic('turn', 2.0, 0.01))
    assert found.free_joints == (turn,) and found.ordered == (turn, slide)
    assert (base.line, turn.line) == (3, 19)


def test_the_order_of_the_file_is_free():
    found = read(
        '<robot name="r"><joint name="b" type="fixed"><parent link="x"/><child link="y"/></joint>'
        '<joint name="a" type="fixed"><parent link="w"/><child link="x"/></joint>'
        '<link name="y"/><link name="x"/><link name="w"/></robot>'
    )
    assert found.root == 'w' and [joint.name for joint in found.ordered] == ['a', 'b']


# The change of the arm, and what is said.
ERRORS = [
    ('<robot name="arm">', '<robot>', 'Line 2: <robot> has no name.'),
    (
        '<robot name="arm">',
        '<robot name="arm" version="2.0">',
        "Line 2: <robot> has version '2.0'",
    ),
    ('<link name="base">', '<link>', 'Line 3: <link> has no name'),
    ('<link name="hand"/>', '<link name="upper"/>', "Line 36: There are two links 'upper'."),
    ('name="slide" type', 'name="turn" type', "Line 31: There are two joints 'turn'."),
    ('<box size="0.2 0.3 0.1"/>', '', "A <visual> of link 'base' has no shape."),
    ('<sphere radius="0.04"/>', '<ball radius="0.04"/>', "link 'base' has the shape <ball>"),
    ('<sphere radius="0.04"/>', '<sphere/>', "<sphere> of link 'base' has no radius"),
    (
        'size="0.2 0.3 0.1"',
        'size="0.2, 0.3, 0.1"',
        "is '0.2, 0.3, 0.1', and 3 numbers with spaces",
    ),
    ('size="0.2 0.3 0.1"', 'size="0.2 0.3"', "size of <box> of link 'base' is '0.2 0.3'"),
    (
        'radius="0.04"',
        'radius="${r}"',
        "radius of <sphere> of link 'base' is '${r}', and a number",
    ),
    ('radius="0.04"', 'radius="inf"', "'inf', and a number is expected"),
    ('radius="0.04"', 'radius="1_0"', "'1_0', and a number is expected"),
    ('radius="0.04"', 'radius="1e999"', "'1e999', and a number is expected"),
    ('<mass value="1.2"/>', '', "The <inertial> of link 'base' has no mass."),
    ('izz="0.02"', '', "<inertia> of link 'base' has no izz"),
    ('type="revolute"', 'type="hinge"', "joint 'turn' has the type 'hinge', and the types are"),
    ('type="revolute"', 'type="revolut"', "joint 'turn' has the type 'revolut'"),
    ('<axis xyz="0 0 1"/>', '<axis xyz="0 0 0"/>', "The axis of joint 'turn' is '0 0 0'"),
    ('<parent link="base"/>', '', "joint 'turn' has no parent."),
    (
        '<limit lower="-1.5" upper="1.5" effort="2" velocity="3"/>',
        *('', "joint 'turn' is revolute and has no <limit>."),
    ),
    ('lower="-1.5" upper="1.5" effort="2"', '', "<limit> of joint 'turn' has no effort"),
    ('damping="0.1"', '', "<dynamics> of joint 'turn' has neither"),
    ('<mimic joint="turn"', '<mimic joint="tune"', "joint 'slide' mimics 'tune'"),
    ('<mimic joint="turn"', '<mimic joint="slide"', "joint 'slide' mimics itself."),
    (
        '<child link="hand"/>',
        '<child link="hind"/>',
        "The child of joint 'slide' is the link 'hind'",
    ),
    (
        '<child link="hand"/>',
        '<child link="upper"/>',
        "'upper' is the child of two joints, 'turn'",
    ),
    ('<link name="hand"/>', '<link name="hand"/><link name="toe"/>', '2 links have no parent'),
    ('<parent link="base"/>', '<parent link="hand"/>', 'in a loop: upper -> hand -> upper.'),
]


@pytest.mark.parametrize(('old', 'new', 'words'), ERRORS)
def test_what_ros_refuses_is_refused_in_a_sentence(arm, old, new, words):
    text = changed(arm, old, new)
    reading = examine(text)
    assert reading.description is None
    assert [words.lower() in str(p).lower() for p in reading.errors] == [True], reading.errors
    with pytest.raises(DescriptionError) as raised:
        read(text)
    assert raised.value.problems == reading.errors
    assert raised.value.message == str(reading.errors[0])


# The change of the arm, what is said, and a part of what to do.
DOUBTS = [
    ('<mass value="1.2"/>', '<mass value="0"/>', "link 'base' has the mass 0 kg", 'Weigh it'),
    ('izz="0.02"', 'izz="0.2"', 'the largest is at most the sum', 'ixx = 1.2/12'),
    ('ixy="0"', 'ixy="0.02"', 'about one of its axes it is -', 'ixx = 1.2/12'),
    ('ixx="0.01"', 'ixx="-0.01"', 'about one of its axes it is -0.01', 'A box of 1.2 kg'),
    ('rpy="0 0 1.57"', 'rpy="0 0 90"', 'that is 14.3 turns', 'write 1.5708.'),
    (
        'lower="-1.5" upper="1.5"',
        'lower="-90" upper="90"',
        'that is 14.3 turns',
        '"-1.5708" upper',
    ),
    ('lower="-1.5"', 'lower="2"', 'the limits 2 to 1.5', 'lower="1.5" upper="2"'),
    ('lower="-1.5"', 'lower="1.5"', 'can not move: lower and upper are both 1.5', 'fixed'),
    ('size="0.2 0.3 0.1"', 'size="0.2 0 0.1"', 'a box whose y is 0', ''),
    ('radius="0.04"', 'radius="4000"', 'is 4000 m large (radius of its sphere)', 'write 4.'),
    ('scale="0.001 0.001 0.001"', 'scale="0 1 1"', 'scaled to nothing', ''),
    ('file:///', 'file:///no', 'There is no file for the mesh', ''),
    ('file:///', 'package://no_such_package/', "'no_such_package', which is not there", ''),
    ('file:///', 'https://example.org/', 'is not a file of this computer', 'package://'),
    ('filename="file:///', 'filename="meshes/', 'is a path, and relative to what', 'package://'),
    ('<material name="blue"/>', '<material name="blu"/>', "material 'blu', and there", "'blue'?"),
    ('rgba="0 0 0.8 1"', 'rgba="0 0 255 1"', 'its numbers are from 0 to 1', 'by 255'),
    ('<axis xyz="0 0 1"/>', '<axis xyz="0 0 2"/>', 'has the length 2, and 1 is expected', ''),
    ('<origin xyz="0 0 0.05"/>', '<origin pry="0 0 1"/>', "'pry', which ROS does", 'rpy, in'),
    ('<collision name', '<colision/><collision name', 'has a <colision>', '<collision>?'),
    ('<gazebo reference="base"/>', '<xacro:property/>', '<xacro:property> is for xacro', 'xacro'),
]


@pytest.mark.parametrize(('old', 'new', 'words', 'todo'), DOUBTS)
def test_what_nobody_can_mean_is_said(arm, old, new, words, todo):
    reading = examine(changed(arm, old, new))
    assert reading.description is not None and not reading.errors
    (problem,) = reading.problems
    assert words.lower() in str(problem).lower() and todo in problem.todo, problem


def test_all_that_is_wrong_is_said_at_once(arm):
    text = changed(changed(arm, 'type="revolute"', 'type="hinge"'), 'radius="0.04"', 'radius="x"')
    with pytest.raises(DescriptionError) as raised:
        read(text)
    assert len(raised.value.problems) == 2
    assert str(raised.value).startswith("Line 9: Radius of <sphere> of link 'base' is 'x'")
    assert "- Line 19: Joint 'turn' has the type 'hinge'" in str(raised.value)


def test_one_that_follows_others_in_a_circle_is_told(arm):
    circle = ''.join(
        f'<link name="{a}"/><joint name="{a}" type="continuous"><parent link="hand"/>'
        f'<child link="{a}"/><mimic joint="{b}"/></joint>'
        for a, b in ('xy', 'yx', 'zx')
    )
    text = changed(arm, '<gazebo reference="base"/>', circle)
    assert [problem[9:] for problem in said(text)] == [
        "Joint 'x' mimics itself.",
        "Joint 'y' mimics itself.",
    ]


def test_what_is_no_description_is_said():
    assert said('<sdf version="1.9"/>')[0].startswith('Line 1: A description begins with <robot>')
    assert said('<robot name="r"/>') == ['Line 1: <robot> has no <link>, and needs one at least.']
    assert said('<robot name="r">\n<link')[0].startswith('Line 2: This is no XML: unclosed token')
    bomb = '<!DOCTYPE r [<!ENTITY a "aaa">]><robot name="&a;"><link name="b"/></robot>'
    assert said(bomb) == ["Line 1: This is no XML: it declares the entity 'a'."]


def test_a_mesh_of_a_package_stays_in_it(arm):
    text = changed(arm, 'file:///', 'package://rcl_interfaces/../../../')
    (problem,) = examine(text).problems
    assert 'is outside of its package' in str(problem)
    text = changed(arm, 'file:///', 'package://rcl_interfaces/package.xml?')
    assert 'it would be' in said(text)[0]


def test_meshes_are_found_beside_the_file(arm, tmp_path):
    text = arm.replace(f'file://{tmp_path}/', '')
    assert [p.is_error for p in examine(text).problems] == [False]
    assert examine(text, folder=tmp_path).problems == ()


@pytest.mark.parametrize('angle', [0.0, 0.3, 1.2])
def test_main_moments_do_not_depend_on_the_axes(angle):
    small, middle, large = 0.2, 0.5, 0.6
    cos, sin = math.cos(angle), math.sin(angle)
    turned = (
        *(small * cos**2 + large * sin**2, 0.0, (small - large) * sin * cos),
        *(middle, 0.0, small * sin**2 + large * cos**2),
    )
    assert principal_moments(turned) == pytest.approx((small, middle, large))
