"""The simulated camera: what it sees where, and what it publishes, to whom."""

from __future__ import annotations

import math

import numpy as np
import pytest
from sensor_msgs.msg import CameraInfo, Image, LaserScan

from labkit.sim.camera import PI_CAMERA, POST_RING, ROBOT_RING, picture
from labkit.sim.kinematics import Pose
from labkit.sim.world import Post, Wall, World, open_field, playground, room
from tests.stage import Stage, twist

WIDTH, HEIGHT = PI_CAMERA.width, PI_CAMERA.height
FOCAL = PI_CAMERA.focal_length


def columns_like(pixels: np.ndarray, colour: np.ndarray) -> list[int]:
    """Return the columns in which something has this colour, however bright."""
    shares = pixels / np.maximum(pixels.sum(axis=2, keepdims=True), 1)
    found = np.abs(shares - colour / colour.sum()).max(axis=2) < 0.02
    return np.nonzero(found.sum(axis=0) > 3)[0].tolist()


def test_field_of_view_is_that_of_the_pi_camera() -> None:
    assert math.degrees(2 * math.atan(WIDTH / 2 / FOCAL)) == pytest.approx(62.2)
    # Pixels are square, so the other one follows: the maker says 48.8 degrees.
    assert math.degrees(2 * math.atan(HEIGHT / 2 / FOCAL)) == pytest.approx(48.8, abs=0.2)


@pytest.mark.parametrize('distance', [0.5, 1.0, 2.0])
def test_wall_ahead_is_where_a_pinhole_has_it(distance: float) -> None:
    far = PI_CAMERA.x + distance
    pixels = picture(World([Wall(far, -9.0, far, 9.0)]), Pose())
    column = pixels[:, WIDTH // 2 + 9].astype(int)
    # Red of the wall is far above its blue; floor and ceiling are grey.
    (rows,) = np.nonzero(column[:, 0] - column[:, 2] > 40)
    bottom = HEIGHT / 2 + FOCAL * PI_CAMERA.z / distance
    top = HEIGHT / 2 - FOCAL * (0.5 - PI_CAMERA.z) / distance
    assert rows[-1] + 1 == pytest.approx(bottom, abs=1)
    assert rows[0] == pytest.approx(max(top, 0), abs=1)


@pytest.mark.parametrize('turn', [-2.0, 0.0, 1.0, 3.0])
def test_post_is_seen_in_its_direction_and_as_wide_as_it_is(turn: float) -> None:
    # 1.5 m ahead of the lens and 0.3 m to the left, wherever the robot looks.
    ahead, left = PI_CAMERA.x + 1.5, 0.3
    cos, sin = math.cos(turn), math.sin(turn)
    post = Post(1 + cos * ahead - sin * left, 2 + sin * ahead + cos * left, 0.1)
    pixels = picture(World(posts=[post]), Pose(1.0, 2.0, turn))
    columns = columns_like(pixels, POST_RING)
    middle = math.atan2(left, 1.5)
    half = math.asin(0.1 / math.hypot(left, 1.5))
    for edge, angle in ((columns[0], middle + half), (columns[-1] + 1, middle - half)):
        assert edge == pytest.approx(WIDTH / 2 - FOCAL * math.tan(angle), abs=2)


def test_what_is_near_hides_what_is_far() -> None:
    world = World([Wall(1.0, -9.0, 1.0, 9.0)], [Post(2.0, 0.0, 0.2)])
    assert columns_like(picture(world, Pose()), POST_RING) == []
    assert columns_like(picture(World(posts=world.posts), Pose()), POST_RING)
    # A robot is lower than a post: over it one sees what stands behind.
    crowd = World(posts=[Post(2.0, 0.0, 0.2)])
    crowd.robots['other'] = Post(1.0, 0.0, 0.105)
    pixels = picture(crowd, Pose())
    middle = pixels[:, WIDTH // 2 : WIDTH // 2 + 1]
    assert columns_like(middle, ROBOT_RING) and columns_like(middle, POST_RING)
    assert columns_like(middle[HEIGHT // 2 - 5 :], POST_RING) == []


def test_robots_see_each_other_and_not_themselves() -> None:
    world = room()
    world.robots['me'] = Post(0.0, 0.0, 0.105)
    alone = picture(world, Pose(), but='me')
    assert columns_like(alone, ROBOT_RING) == []
    world.robots['other'] = Post(1.0, 0.0, 0.105)
    assert columns_like(picture(world, Pose(), but='me'), ROBOT_RING)


def test_it_sees_from_everywhere_also_where_nothing_is() -> None:
    assert picture(open_field(), Pose()).shape == (HEIGHT, WIDTH, 3)
    for place in ((2.39, 0.0, 0.0), (2.39, 2.39, 0.7), (-2.3, 0.0, math.pi)):
        pixels = picture(playground(), Pose(*place))
        assert pixels.dtype == np.uint8 and len(np.unique(pixels.reshape(-1, 3), axis=0)) > 10
    # The same place, the same picture.
    assert (picture(playground(), Pose()) == picture(playground(), Pose())).all()


def test_it_is_published_to_whoever_subscribes(stage: Stage, monkeypatch) -> None:
    made = []
    monkeypatch.setattr(
        'labkit.sim.burger_messages.picture', lambda *a, **k: made.append(k) or picture(*a, **k)
    )
    robot = stage.robot(namespace='robot1', x=0.5)
    driver = stage.driver('robot1')
    stage.until(lambda: len(driver.odometry) > 10)
    assert made == []
    images: list[Image] = []
    infos: list[CameraInfo] = []
    ear = driver.create_subscription(Image, 'camera/image_raw', images.append, 10)
    driver.create_subscription(CameraInfo, 'camera/camera_info', infos.append, 10)
    stage.until(lambda: len(images) >= 2 and infos)
    image, info = images[0], infos[0]
    assert image.header.frame_id == 'robot1/camera_rgb_optical_frame' == info.header.frame_id
    assert image.header.stamp.sec > 0
    assert (image.width, image.height, image.encoding) == (320, 240, 'rgb8')
    assert (image.step, image.is_bigendian, len(image.data)) == (960, 0, 320 * 240 * 3)
    expected = picture(robot.simulator.world, robot.pose, but='robot1/turtlebot')
    assert (np.frombuffer(image.data, np.uint8).reshape(240, 320, 3) == expected).all()
    assert made[0] == {'but': 'robot1/turtlebot'}
    assert (info.width, info.height, info.distortion_model) == (320, 240, 'plumb_bob')
    assert info.k[0] == info.k[4] == pytest.approx(FOCAL) and (info.k[2], info.k[5]) == (160, 120)
    # Nobody listens any more, so none is made.
    driver.destroy_subscription(ear)
    stage.until(lambda: robot._image.get_subscription_count() == 0)
    count, rounds = len(made), len(driver.odometry)
    stage.until(lambda: len(driver.odometry) > rounds + 10)
    assert len(made) == count


def test_ten_pictures_in_a_second_of_its_time(stage: Stage) -> None:
    stage.robot(lockstep=0.1)
    driver = stage.driver()
    images: list[Image] = []
    scans: list[LaserScan] = driver.scans
    driver.create_subscription(Image, 'camera/image_raw', images.append, 100)
    stage.until(lambda: driver.count_publishers('camera/image_raw') == 1)
    for count in range(1, 21):
        seen = len(driver.odometry)
        driver.commands.publish(twist(0.1))
        stage.until(lambda seen=seen: len(driver.odometry) > seen)
        stage.until(lambda count=count: len(images) >= count)
    assert len(images) == 20 and len(scans) <= 12
