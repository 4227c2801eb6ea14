"""A notebook with a robot, its map and its keys, for tests of them."""

from __future__ import annotations

from playwright.sync_api import Locator, expect

from tests.browser.page import Notebook

CELLS = {
    'setup': 'import labkit as lab\nrobot = lab.spin(lab.Turtlebot())',
    'arena': 'view = lab.arena(goals=[(1.0, 0.5)])\nview',
    'teleop': 'pilot = lab.teleop()\npilot',
    'place': 'robot.place()',
    'before-a-wall': 'robot.place(x=2.2)',
    'both': 'robot.place()\ndisplay(lab.arena(), lab.teleop())',
    'to-a-corner': 'robot.place(x=2.0, y=-2.0)',
    'other-arena': 'lab.arena()',
    'other-teleop': 'lab.teleop()',
    'camera': "display(lab.image('/camera/image_raw'), lab.teleop())",
    'close-camera': 'lab.remove(robot)',
    'busy': """
print('busy')
try:
    lab.wait_until(lambda: robot.pose.x > 0.1, timeout_sec=50)
    print('drove')
except lab.LabTimeout:
    print('stood')
""",
    'standing': """
lab.wait_until(lambda: robot.twist == (0, 0), timeout_sec=50)
print('standing', pilot.published)
""",
    'no-ears': """
import asyncio
from labkit.background.runtime import runtime

def ears():
    return {s.topic_name for s in runtime.helper.subscriptions}

while {'/odom', '/scan'} & ears():
    await asyncio.sleep(0.02)
print('nobody listens')
""",
    'close': 'view.close()\npilot.close()',
    'robots': """
for number, y in ((1, 1.0), (2, -1.0)):
    space = f'robot{number}'
    lab.spin(lab.Turtlebot(namespace=space, world=robot.simulator.world, y=y))
display(lab.arena(), lab.teleop(namespace='robot2'))
""",
    'stop': 'lab.stop()',
}
STANDS = 'linear.x = 0.00 m/s  angular.z = 0.00 rad/s'


class Stage:
    """A notebook in which a robot, its arena and its teleop run."""

    def __init__(self, notebook: Notebook) -> None:
        self.notebook, self.page = notebook, notebook.page
        for cell_id in ('setup', 'arena', 'teleop'):
            notebook.run_cell(cell_id)
        self.look()

    def look(self) -> None:
        """Find the views in the page."""
        self.canvas: Locator = self.page.locator('.labkit-arena canvas')
        self.teleop: Locator = self.page.locator('.labkit-teleop')
        self.published: Locator = self.page.locator('.labkit-teleop-published')
        expect(self.canvas).to_have_attribute('data-pose', '0.000 0.000 0.000 0.000 0.000')

    def focus(self) -> None:
        self.teleop.click(position={'x': 4, 'y': 4})

    def hold(self, key: str, shown: str) -> None:
        self.focus()
        self.page.keyboard.down(key)
        expect(self.published).to_contain_text(shown)

    def expect_stop(self) -> None:
        expect(self.published).to_contain_text(STANDS)
        self.page.wait_for_function(
            "canvas => canvas.dataset.pose.endsWith('0.000 0.000')",
            arg=self.canvas.element_handle(),
        )

    def pose(self) -> list[float]:
        return [float(number) for number in (self.canvas.get_attribute('data-pose')).split()]
