"""Monitor and plot in the browser: they show, follow, pause, let go, and leave the page alive."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.accessibility import violations
from tests.browser.page import Notebook, open_notebook

pytestmark = pytest.mark.slow('a page in the browser')

CELLS = {
    'setup': """
import labkit as lab
from labkit.background.runtime import runtime
from rclpy.node import Node
from std_msgs.msg import Int16, String

class Talker(Node):
    def __init__(self, period):
        super().__init__('talker')
        self.count = 0
        self.numbers = self.create_publisher(Int16, 'odds', 10)
        self.texts = self.create_publisher(String, 'texts', 10)
        self.create_timer(period, self.tick)

    def tick(self):
        self.count += 1
        self.numbers.publish(Int16(data=self.count % 100))

def ears(topic='/odds'):
    return len([s for s in runtime.helper.subscriptions if s.topic_name == topic])
""",
    'talker': 'talker = lab.spin(Talker(0.02))',
    'fast': 'import time\nbegan = time.monotonic()\ntalker = lab.spin(Talker(0.001))',
    'said': 'print(talker.count, time.monotonic() - began)',
    'robot': 'robot = lab.spin(lab.Turtlebot())',
    'monitor': "lab.monitor('/odds')",
    'odom': "lab.monitor('/odom')",
    'texts': "lab.monitor('/texts')",
    'say': "talker.texts.publish(String(data='<img src=x onerror=alert(1)>'))",
    'poses': "lab.monitor('/poses')",
    'one-or-two': """
from geometry_msgs.msg import Pose, PoseArray
poses = talker.create_publisher(PoseArray, 'poses', 10)
def tell():
    tell.count = 3 - tell.count
    poses.publish(PoseArray(poses=[Pose()] * tell.count))
tell.count = 1
talker.create_timer(0.3, tell)
""",
    'plot': "lab.plot('/odds.data', '/odom.pose.pose.position.x', seconds=5)",
    'one': "lab.plot('/odds.data')",
    'minute': "lab.plot('/odds.data', seconds=60)",
    'two-numbers': """
import time
lab.wait_until(talker.numbers.get_subscription_count)
talker.numbers.publish(Int16(data=-1))
time.sleep(2.5)  # what is closer together than that, a step of the cursor may pass by
talker.numbers.publish(Int16(data=-2))
""",
    'slow': 'talker = lab.spin(Talker(3600.0))',
    'remove': "lab.remove('talker')",
    'ears': 'print("listening:", ears())',
    'no-ears': """
import asyncio
while ears():
    await asyncio.sleep(0.02)
print('nobody listens')
""",
    'sum': 'print(sum(range(1000)))',
    'stop': 'lab.stop()',
}
# Frames of the screen in so many seconds, and the updates of a view up to then.
FRAMES = """([view, seconds]) => new Promise((resolve) => {
  const begin = performance.now();
  let frames = 0, longest = 0, last = begin;
  const next = (now) => {
    frames += 1;
    longest = Math.max(longest, now - last);
    last = now;
    if (now - begin < 1000 * seconds) requestAnimationFrame(next);
    else resolve({ frames, longest, updates: Number(view.dataset.updates) });
  };
  requestAnimationFrame(next);
})"""
# What the table says while the cursor goes from the right to the left.
WALK = """async slider => {
  const view = slider.closest('.labkit-plot'), canvas = view.querySelector('canvas');
  const frames = () => Number(canvas.dataset.frames);
  const seen = [];
  for (let part = 1; part > -0.01; part -= 0.02) {
    slider.value = part;
    slider.dispatchEvent(new Event('input'));
    const before = frames();
    while (frames() < before + 2) await new Promise(requestAnimationFrame);
    const text = view.querySelector('tbody td').textContent;
    if (text !== seen.at(-1)) seen.push(text);
  }
  return seen;
}"""
# How well what is written can be told from what is behind it, by WCAG 2.
CONTRAST = """element => {
  const numbers = (colour) => colour.match(/[\\d.]+/g).map(Number);
  const light = ([r, g, b]) => [r, g, b].map((c) => c / 255)
    .map((c) => (c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4))
    .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
  const paint = (node) => {
    const colour = numbers(getComputedStyle(node).backgroundColor);
    return colour[3] === 0 && node.parentElement ? paint(node.parentElement) : colour;
  };
  const [a, b] = [light(numbers(getComputedStyle(element).color)), light(paint(element))];
  return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
}"""


class Stage:
    """A notebook with the cells above."""

    def __init__(self, notebook: Notebook) -> None:
        self.notebook, self.page = notebook, notebook.page
        self.run('setup')

    def run(self, *cell_ids: str) -> str:
        text = ''
        for cell_id in cell_ids:
            text = self.notebook.run_cell(cell_id)
            assert self.notebook.error_of(cell_id) == '', cell_id
        return text

    def view(self, cell_id: str) -> Locator:
        found = self.notebook.output(cell_id).locator('.labkit-live')
        found.wait_for()
        return found

    def wait(self, condition: str, place: Locator) -> None:
        self.page.wait_for_function(condition, arg=place.element_handle())


@pytest.fixture
def stage(open_cells: Callable[..., Notebook]) -> Stage:
    return Stage(open_cells(**CELLS))


def test_monitor_counts_and_says_why_nothing_comes(stage):
    stage.run('monitor')
    monitor = stage.view('monitor')
    note = monitor.get_by_role('status')
    expect(note).to_contain_text('Nobody publishes on /odds.')
    stage.run('talker')
    stage.view('monitor')
    expect(note).to_be_hidden()
    stage.wait("v => parseInt(v.querySelectorAll('dd')[1].textContent) > 50", monitor)
    stage.wait("v => parseFloat(v.querySelector('dd').textContent) > 5", monitor)
    expect(monitor.locator('dd').first).to_contain_text('Hz')
    expect(monitor.locator('.labkit-monitor-type')).to_have_text('std_msgs/msg/Int16')
    # The course of the rate, with its numbers as text.
    expect(monitor.locator('polyline')).to_have_attribute('points', re.compile(r'58,.* 59,'))
    course = monitor.locator('dl > div', has_text='Rate in the last minute').locator('dd')
    expect(course).to_have_text(re.compile(r'^[\d.]+( to [\d.]+)? Hz$'))
    expect(monitor.locator('td')).to_have_text(['/talker', 'reliable', 'volatile'])
    stage.run('remove')
    stage.view('monitor')
    expect(note).to_contain_text('Nobody publishes on /odds.')
    stage.run('stop')
    stage.view('monitor')
    expect(note).to_contain_text('ROS was stopped. Run this cell')


def test_tree_is_worked_by_keyboard_and_follows(stage):
    stage.run('robot', 'odom')
    monitor = stage.view('odom')
    expect(monitor.get_by_text('covariance').first).to_be_visible()
    head = monitor.locator('summary', has_text='geometry_msgs/PoseWithCovariance')
    head.focus()
    count = len(stage.notebook.cells())
    stage.page.keyboard.press('Enter')
    expect(monitor.get_by_text('geometry_msgs/Point')).to_be_hidden()
    # What is closed stays closed while messages come.
    updates = int(monitor.get_attribute('data-updates'))
    stage.wait(f'v => Number(v.dataset.updates) > {updates + 5}', monitor)
    expect(monitor.get_by_text('geometry_msgs/Point')).to_be_hidden()
    expect(head).to_be_focused()
    stage.page.keyboard.press(' ')
    expect(monitor.get_by_text('geometry_msgs/Point')).to_be_visible()
    # In JupyterLab's command mode these insert, cut and delete cells.
    for key in ('a', 'b', 'x', 'd', 'd'):
        stage.page.keyboard.press(key)
    assert len(stage.notebook.cells()) == count
    expect(head).to_be_focused()


def test_tree_of_another_shape_stays_folded_and_keeps_the_focus(stage):
    stage.run('talker', 'one-or-two', 'poses')
    monitor = stage.view('poses')
    head = monitor.locator('summary', has_text='[0]')
    head.focus()
    stage.page.keyboard.press('Enter')
    expect(monitor.locator('summary', has_text='position').first).to_be_hidden()
    for count in (2, 1, 2):
        expect(monitor.locator('summary', has_text='position')).to_have_count(count)
    expect(monitor.locator('summary', has_text='position').first).to_be_hidden()
    expect(head).to_be_focused()


def test_text_of_others_is_only_text(stage):
    stage.run('talker', 'texts')
    value = stage.view('texts').locator('.labkit-monitor-value')
    stage.wait("v => v.querySelector('td')", stage.view('texts'))
    stage.run('say')
    stage.view('texts')
    expect(value).to_have_text("'<img src=x onerror=alert(1)>'")


def test_plot_moves_and_can_be_paused_by_keyboard(stage):
    stage.run('talker', 'robot', 'plot')
    plot = stage.view('plot')
    canvas, last = plot.get_by_role('img'), plot.locator('tbody td').first
    words = re.compile(r'/odds\.data, /odom\.pose\.pose\.position\.x in m\.')
    expect(canvas).to_have_attribute('aria-label', words)
    expect(plot.locator('tbody th')).to_have_text(
        [' /odds.data', ' /odom.pose.pose.position.x'], use_inner_text=True
    )
    stage.wait("v => parseFloat(v.querySelectorAll('td')[2].textContent) > 20", plot)
    picture = 'c => c.toDataURL()'
    seen = canvas.evaluate(picture)
    stage.page.wait_for_function(
        'seen => document.querySelector(".labkit-plot canvas").toDataURL() !== seen', arg=seen
    )
    button = plot.get_by_role('button', name='Pause')
    button.focus()
    stage.page.keyboard.press('Enter')
    button = plot.get_by_role('button', name='Resume')
    expect(button).to_be_focused()

    def frames() -> int:
        return int(canvas.get_attribute('data-frames'))

    def wait_frames(count: int) -> None:
        stage.wait(f'c => Number(c.dataset.frames) > {frames() + count}', canvas)

    wait_frames(12)
    seen, number = canvas.evaluate(picture), last.inner_text()
    wait_frames(20)
    assert canvas.evaluate(picture) == seen and last.inner_text() == number
    stage.page.keyboard.press(' ')
    expect(plot.get_by_role('button', name='Pause')).to_be_focused()
    wait_frames(12)
    assert canvas.evaluate(picture) != seen


def test_cursor_tells_the_values_at_its_time(stage):
    stage.run('slow', 'minute')
    plot = stage.view('minute')
    last = plot.locator('thead th').nth(1)
    expect(plot.locator('tbody th')).to_have_text(' /odds.data', use_inner_text=True)
    stage.run('two-numbers')
    plot = stage.view('minute')
    expect(plot.locator('tbody td').first).to_have_text('-2')
    # The pointer is enough; it need not be paused.
    plot.get_by_role('img').hover()
    expect(last).to_have_text(re.compile(r'^At \d+\.\d\d s$'))
    stage.page.mouse.move(0, 0)
    expect(last).to_have_text('Last')
    slider = plot.get_by_role('slider', name='Time of the cursor')
    expect(slider).to_be_hidden()
    plot.get_by_role('button', name='Pause').click()
    assert slider.evaluate(WALK) == ['-2', '-1', '–']
    slider.focus()
    stage.page.keyboard.press('End')
    words = re.compile(r'^At \d+\.\d\d s: /odds\.data -2$')
    expect(slider).to_have_attribute('aria-valuetext', words)
    assert violations(stage.notebook, 'minute') == []
    plot.get_by_role('button', name='Resume').click()
    expect(slider).to_be_hidden()
    expect(last).to_have_text('Last')


def test_span_of_a_plot_is_zoomed_into_and_saved(stage, tmp_path):
    stage.run('slow', 'minute')
    plot = stage.view('minute')
    expect(plot.locator('tbody th')).to_have_text(' /odds.data', use_inner_text=True)
    stage.run('two-numbers')
    plot = stage.view('minute')
    expect(plot.locator('tbody td').first).to_have_text('-2')
    slider, out = plot.get_by_role('slider'), plot.get_by_role('button', name='Zoom out')

    def time_at(key: str) -> float:
        slider.focus()
        # Where it is at the end already, its key changes nothing.
        for each in ('ArrowRight', 'ArrowLeft', key):
            stage.page.keyboard.press(each)
        part = 0 if key == 'Home' else 1
        stage.wait(f's => Number(s.value) === {part}', slider)
        frames = int(canvas.get_attribute('data-frames'))
        stage.wait(f'c => Number(c.dataset.frames) > {frames + 2}', canvas)
        head = plot.locator('thead th').nth(1).inner_text()
        return float(head.removeprefix('At ').removesuffix(' s'))

    def seconds_shown() -> float:
        return time_at('End') - time_at('Home')

    canvas = plot.get_by_role('img')
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    middle = box['y'] + box['height'] / 2
    stage.page.mouse.move(box['x'] + box['width'] * 0.4, middle)
    stage.page.mouse.down()
    stage.page.mouse.move(box['x'] + box['width'] * 0.7, middle, steps=5)
    stage.page.mouse.up()
    # The picture stands still then.
    expect(plot.get_by_role('button', name='Resume')).to_be_visible()
    part = seconds_shown()
    assert 15 < part < 25
    plot.get_by_role('button', name='Zoom in').click()
    assert seconds_shown() == pytest.approx(part / 2, abs=0.02)
    while out.is_enabled():
        out.click()
    assert seconds_shown() == pytest.approx(60, abs=0.02)
    with stage.page.expect_download() as download:
        plot.get_by_role('button', name='Save as CSV').click()
    saved = tmp_path / download.value.suggested_filename
    download.value.save_as(saved)
    head, *rows = saved.read_text().splitlines()
    assert (saved.name, head) == ('plot.csv', '"time [s]","/odds.data"')
    assert [row.partition(',')[2] for row in rows] == ['-1', '-2']


def test_cleared_output_leaves_no_subscription(stage):
    stage.run('talker', 'monitor', 'one')
    stage.view('monitor')
    stage.wait('v => Number(v.dataset.updates) > 3', stage.view('one'))
    stage.wait('v => Number(v.dataset.updates) > 3', stage.view('monitor'))
    assert stage.run('ears') == 'listening: 2'
    # Again: the new ones take the places of the old ones.
    stage.run('monitor', 'one')
    stage.wait('v => Number(v.dataset.updates) > 3', stage.view('one'))
    stage.wait('v => Number(v.dataset.updates) > 3', stage.view('monitor'))
    assert stage.run('ears') == 'listening: 2'
    stage.notebook.execute('notebook:clear-all-cell-outputs')
    assert stage.run('no-ears') == 'nobody listens'


def test_closed_tab_leaves_no_subscription(stage, jupyter, browser):
    stage.run('talker', 'monitor', 'one')
    stage.wait('v => Number(v.dataset.updates) > 3', stage.view('monitor'))
    name = stage.page.evaluate('window.jupyterapp.shell.currentWidget.context.path')
    # It goes without a word: the kernel finds out.
    stage.page.close(run_before_unload=False)
    other = open_notebook(jupyter, browser, name.removesuffix('.ipynb'))
    assert other.run_cell('no-ears') == 'nobody listens'
    # The fixture goes on with this tab.
    stage.notebook.page = other.page


def test_both_can_be_read_in_both_themes(stage):
    stage.run('talker', 'robot', 'odom', 'plot')
    for theme in ('JupyterLab Light', 'JupyterLab Dark'):
        stage.notebook.execute('apputils:change-theme', theme=theme)
        try:
            stage.page.wait_for_function(
                'dark => document.body.dataset.jpThemeLight === String(!dark)',
                arg=theme.endswith('Dark'),
            )
            for cell_id, parts in (
                ('odom', '.labkit-monitor span, dt, dd, th, td, summary'),
                ('plot', 'th, td, button'),
            ):
                places = stage.view(cell_id).locator(parts)
                ratios = [place.evaluate(CONTRAST) for place in places.all()[:40]]
                assert len(ratios) > 5 and min(ratios) >= 4.5, (theme, cell_id, ratios)
            lines = stage.view('plot').locator('svg path')
            colour = 'line => getComputedStyle(line).stroke'
            assert len({line.evaluate(colour) for line in lines.all()}) == 2
            assert len({line.get_attribute('stroke-dasharray') for line in lines.all()}) == 2
        finally:
            stage.notebook.execute('apputils:change-theme', theme='JupyterLab Light')


@pytest.mark.parametrize('cell_id', ['monitor', 'one'])
def test_page_lives_at_a_thousand_messages_a_second(stage, cell_id):
    stage.run('fast', cell_id)
    view = stage.view(cell_id)
    stage.wait('v => Number(v.dataset.updates) > 10', view)
    seen = stage.page.evaluate(FRAMES, [view.element_handle(), 4])
    messages, seconds = map(float, stage.run('said').split())
    print(cell_id, seen, messages, seconds)
    # A busy machine has fewer of everything, and a page may get late what was sent in time. So
    # all is counted from the beginning on: 20 updates a second at most, and some more when the
    # page asks for all.
    assert seen['updates'] <= 20 * seconds + 5, seen
    assert seen['frames'] > 0 and messages > seen['updates'], seen
    assert stage.run('sum') == '499500'
