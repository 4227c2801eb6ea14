"""The live graph in the browser: messages pass, keys tell more, and nothing is cut off."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.accessibility import violations
from tests.browser.page import Notebook

pytestmark = pytest.mark.slow('a page in the browser')

CELLS = {
    'setup': """
import labkit as lab
from labkit.asking import traffic
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Int16, String
from std_srvs.srv import Trigger

class Talker(Node):
    def __init__(self, period):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.create_timer(period, lambda: self.publisher.publish(String(data='hello')))

class Listener(Node):
    def __init__(self, name='listener', qos=10):
        super().__init__(name)
        self.create_subscription(String, 'chatter', lambda msg: None, qos)
""",
    'nodes': 'talker, listener = lab.spin(Talker(0.2)), lab.spin(Listener())',
    'fleet': """
class Robot(Talker):
    def __init__(self, name):
        Node.__init__(self, name, namespace='robot1')
        self.publisher = self.create_publisher(String, '/chatter', 10)
        self.create_timer(0.2, lambda: self.publisher.publish(String(data='hello')))

one, two = lab.spin(Robot('one')), lab.spin(Robot('two'))
""",
    'graph': 'lab.graph()',
    'more': 'lab.spin(Listener("another_listener_with_a_long_name"))',
    'service': 'talker.create_service(Trigger, "fire", lambda request, response: response)',
    'apart': """
sonar = lab.spin(Node('sonar'))
sonar.create_publisher(Int16, 'range', qos_profile_sensor_data)
listener.create_subscription(Int16, 'range', print, 10)
""",
    'many': '[lab.spin(Node(f"node_{number}")) for number in range(12)]',
    'crowd': """
crowd = [lab.spin(Node(f'worker_{number}')) for number in range(30)]
for number, node in enumerate(crowd):
    node.create_publisher(String, f'result_{number // 3}', 10)
    node.create_subscription(String, f'task_{number // 10}', print, 10)
""",
    'still': 'lab.graph(live=False)',
    'ways': 'print(len(traffic._open))',
    'remove': 'lab.remove("listener")',
    'stop': 'lab.stop()',
}
# The parts of words and boxes that do not fit, as they are drawn with the fonts of this machine.
CUT_OFF = """svg => {
  const cut = [];
  const all = svg.getBoundingClientRect();
  svg.querySelectorAll('text').forEach((text) => {
    const { left, right, top, bottom } = text.getBoundingClientRect();
    const body = text.parentElement.querySelector('.body')?.getBoundingClientRect() ?? all;
    if (left < body.left || right > body.right || top < body.top || bottom > body.bottom) {
      cut.push(text.textContent);
    }
  });
  return cut;
}"""
IN_SIGHT = """part => {
  const [a, b] = [part, part.closest('div')].map((each) => each.getBoundingClientRect());
  return a.left >= b.left && a.right <= b.right && a.top >= b.top && a.bottom <= b.bottom;
}"""
# Whether the drawing is the one for the width of this page, which takes the place of the first one
# whenever the kernel has made it: it has outlived some updates.
IS_SETTLED = """view => {
  const [svg, updates] = [view.querySelector('svg'), Number(view.dataset.updates)];
  const [before, since] = window.labkitDrawn ?? [];
  if (svg !== before) window.labkitDrawn = [svg, updates];
  return svg && svg === before && updates > since + 3;
}"""
SCROLLS = """view => {
  const wide = (element) => element.scrollWidth > element.clientWidth + 1;
  return [view, ...view.querySelectorAll('div, p')].filter((each) => wide(each)
    && !each.classList.contains('labkit-graph-told')).map((each) => each.className);
}"""


@pytest.fixture
def notebook(open_cells: Callable[..., Notebook]) -> Notebook:
    notebook = open_cells(**CELLS)
    notebook.run_cell('setup')
    return notebook


def live(notebook: Notebook) -> Locator:
    return notebook.output('graph').locator('.labkit-graph')


def part(view: Locator, name: str) -> Locator:
    return view.locator(f'[data-part][aria-label^="{name}"]')


def passed(place: Locator) -> int:
    return int(place.get_attribute('data-passed') or 0)


def test_a_namespace_is_folded_and_a_node_tells_its_parameters(notebook: Notebook) -> None:
    notebook.run_cell('nodes')
    notebook.run_cell('fleet')
    notebook.run_cell('graph')
    view = live(notebook)
    expect(part(view, 'Node /robot1/one')).to_have_count(1)
    switch = view.get_by_role('checkbox', name='Fold /robot1')
    switch.focus()
    notebook.page.keyboard.press(' ')
    expect(part(view, 'Namespace /robot1')).to_have_count(1)
    expect(part(view, 'Node /robot1/one')).to_have_count(0)
    # What its nodes publish still passes.
    expect(part(view, '/robot1/* publishes on /chatter')).to_have_attribute(
        'data-passed', re.compile(r'^[3-9]$|^\d\d')
    )
    assert not violations(notebook, 'graph')
    # By keys: to the first part, and on to a node.
    view.locator('[data-part][tabindex="0"]').focus()
    for _ in range(20):
        if (view.locator(':focus').get_attribute('aria-label') or '').startswith('Node /talker'):
            break
        notebook.page.keyboard.press('ArrowRight')
    notebook.page.keyboard.press('Enter')
    expect(view.locator('.labkit-graph-details')).to_contain_text('use_sim_time = False')


def test_messages_pass_and_nodes_come_and_go(notebook: Notebook):
    notebook.run_cell('nodes')
    notebook.run_cell('graph')
    view = live(notebook)
    for name in ('/talker publishes on /chatter', '/listener subscribes to /chatter'):
        arrow = part(view, name)
        expect(arrow).to_have_attribute('data-passed', re.compile(r'^[3-9]$|^\d\d'))
        expect(arrow).to_have_attribute('aria-label', re.compile(r'reliable, volatile\. \d'))
    expect(view.locator('.dot').first).to_be_attached()
    notebook.run_cell('remove')
    expect(part(live(notebook), 'Node /listener')).to_have_count(0)
    # It says so, and shows what it was.
    button = live(notebook).get_by_role('button', name='Show it as it was')
    button.click()
    expect(part(live(notebook), 'Node /listener')).to_have_count(1)
    live(notebook).get_by_role('button', name='Show it as it is').click()
    expect(part(live(notebook), 'Node /listener')).to_have_count(0)
    # Dots end: where nothing passes, nothing moves.
    notebook.run_cell('stop')
    expect(live(notebook)).to_contain_text('ROS was stopped')
    expect(live(notebook).locator('.dot')).to_have_count(0)


def test_keys_and_the_pointer_tell_more(notebook: Notebook):
    notebook.run_cell('nodes')
    notebook.run_cell('service')
    notebook.run_cell('graph')
    view = live(notebook)
    details = view.locator('.labkit-graph-details')
    expect(details).to_contain_text('Point at a part')
    part(view, 'Topic /chatter').hover()
    expect(details).to_contain_text('Type: std_msgs/msg/String · Published by: /talker')
    notebook.page.mouse.move(0, 0)
    expect(details).to_contain_text('Point at a part')
    # One stop of Tab; arrow keys go on from there.
    stops = view.locator('[data-part][tabindex="0"]')
    expect(stops).to_have_count(1)
    stops.focus()
    names = []
    for _ in range(view.locator('[data-part]').count()):
        names.append(details.locator('strong').inner_text())
        notebook.page.keyboard.press('ArrowRight')
    assert sorted(names) == [
        '/listener subscribes to /chatter',
        '/talker publishes on /chatter',
        'Node /listener',
        'Node /talker',
        'Topic /chatter',
    ]
    # Whoever has come to a part stays there when the picture is another one.
    notebook.page.keyboard.press('Home')
    first = details.locator('strong').inner_text()
    view.get_by_label('Services').check()
    expect(part(view, 'Service /fire')).to_have_count(1)
    part(view, first).focus()
    view.get_by_label('Services').evaluate('box => box.click()')
    expect(part(view, 'Service /fire')).to_have_count(0)
    expect(part(view, first)).to_be_focused()
    notebook.page.keyboard.press('Escape')
    assert not view.evaluate('view => view.contains(document.activeElement)')
    # What is told to those who listen.
    expect(view.locator('.labkit-graph-told')).to_contain_text(
        '/talker → /chatter [std_msgs/msg/String] → /listener'
    )


def test_a_switch_stays_where_it_was_put(notebook: Notebook):
    for cell in ('nodes', 'service', 'graph'):
        notebook.run_cell(cell)
    box = live(notebook).get_by_label('Services')
    expect(box).not_to_be_checked()
    # The kernel answers what it was told before, and then first knows of the switch.
    box.evaluate("""box => {
      const { get, set } = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'checked');
      window.was_set = [];
      Object.defineProperty(box, 'checked', {
        get() { return get.call(this); },
        set(on) { window.was_set.push(on); set.call(this, on); },
      });
      for (const value of ['hidden', 'visible']) {
        Object.defineProperty(document, 'visibilityState', { value, configurable: true });
        document.dispatchEvent(new Event('visibilitychange'));
      }
      delete document.visibilityState;
      box.click();
    }""")
    expect(part(live(notebook), 'Service /fire')).to_have_count(1)
    answers = notebook.page.evaluate('window.was_set')
    assert len(answers) >= 3 and all(answers)
    box.evaluate('box => box.click()')
    expect(part(live(notebook), 'Service /fire')).to_have_count(0)
    expect(box).not_to_be_checked()


def test_nothing_is_cut_off_and_nothing_scrolls(notebook: Notebook):
    for cell in ('nodes', 'more', 'service', 'apart', 'many', 'graph'):
        notebook.run_cell(cell)
    view = live(notebook)
    view.get_by_label('Services').check()
    expect(part(view, 'Service /fire')).to_have_count(1)
    for width in (1400, 800):
        notebook.page.set_viewport_size({'width': width, 'height': 900})
        notebook.page.wait_for_function(
            'view => view.querySelector("svg").clientWidth <= view.clientWidth',
            arg=live(notebook).element_handle(),
        )
        assert live(notebook).locator('svg').evaluate(CUT_OFF) == []
        assert live(notebook).evaluate(SCROLLS) == []
    assert live(notebook).locator('.cross').count() == 1
    expect(live(notebook)).to_contain_text('Best effort publisher and')


def test_a_large_one_is_a_screen_high_and_can_be_moved(notebook: Notebook):
    notebook.page.set_viewport_size({'width': 1280, 'height': 900})
    for cell in ('nodes', 'crowd', 'graph'):
        notebook.run_cell(cell)
    view = live(notebook)
    place = view.locator('.labkit-graph-drawing')
    # Asked of what stays: a drawing that has been replaced has no width.
    scale = """place => {
      const svg = place.querySelector('svg');
      return svg.clientWidth / svg.getAttribute('width');
    }"""
    hidden = 'place => place.scrollHeight - place.clientHeight'
    expect(part(view, 'Node /worker_29')).to_have_count(1)
    notebook.page.wait_for_function(IS_SETTLED, arg=view.element_handle())
    assert view.evaluate('view => view.clientHeight') < 900
    # What does not fit is beside it: letters are not smaller than one can read.
    assert place.evaluate(scale) > 0.69 and place.evaluate(hidden) > 100
    view.get_by_role('button', name='Fit').click()
    assert place.evaluate(hidden) <= 1
    whole = place.evaluate(scale)
    part(view, 'Node /worker_29').focus()
    for _ in range(6):
        notebook.page.keyboard.press('+')
    assert place.evaluate(scale) / whole == pytest.approx(1.25**6, rel=0.02)
    # By keys, what has the focus stays in sight.
    assert part(view, 'Node /worker_29').evaluate(IN_SIGHT)
    notebook.page.keyboard.press('-')
    # The wheel makes it larger where the pointer is, and not the page.
    place.hover()
    letters = notebook.page.evaluate('window.devicePixelRatio')
    before = place.evaluate(scale)
    notebook.page.keyboard.down('Control')
    notebook.page.mouse.wheel(0, -200)
    notebook.page.keyboard.up('Control')
    notebook.page.wait_for_function(
        f'place => ({scale})(place) > {1.3 * before}', arg=place.element_handle()
    )
    assert notebook.page.evaluate('window.devicePixelRatio') == letters
    # It is dragged, and stays as it is when nodes come.
    place.evaluate('place => place.scrollTo(0, 0)')
    x, y = place.evaluate('p => [p.getBoundingClientRect().x, p.getBoundingClientRect().y]')
    notebook.page.mouse.move(x + 200, y + 200)
    notebook.page.mouse.down()
    notebook.page.mouse.move(x + 120, y + 140, steps=4)
    notebook.page.mouse.up()
    left_top = 'place => [place.scrollLeft, place.scrollTop]'
    assert place.evaluate(left_top) == [80, 60]
    before = place.evaluate(scale)
    notebook.run_cell('more')
    expect(part(live(notebook), 'Node /another')).to_have_count(1)
    assert place.evaluate(scale) == pytest.approx(before, rel=0.02)
    assert place.evaluate(left_top) == [80, 60]
    assert violations(notebook, 'graph') == []


def test_it_counts_only_while_it_can_be_seen(notebook: Notebook):
    notebook.run_cell('nodes')
    notebook.run_cell('graph')
    expect(part(live(notebook), '/talker')).to_have_attribute('data-passed', re.compile(r'\d'))
    assert notebook.run_cell('ways') == '1'
    notebook.page.evaluate("""() => {
      Object.defineProperty(document, 'visibilityState', { value: 'hidden', configurable: true });
      document.dispatchEvent(new Event('visibilitychange'));
    }""")
    while notebook.run_cell('ways') != '0':
        pass
    notebook.page.evaluate("""() => {
      delete document.visibilityState;
      document.dispatchEvent(new Event('visibilitychange'));
    }""")
    while notebook.run_cell('ways') != '1':
        pass


def test_without_a_kernel_it_is_a_picture(notebook: Notebook):
    notebook.run_cell('nodes')
    notebook.run_cell('still')
    picture = notebook.output('still').locator('img')
    assert picture.evaluate('img => img.decode().then(() => img.naturalWidth)') > 400
    expect(picture).to_have_attribute('alt', re.compile('/talker'))
    # Its own ground is white, which would be glaring in a dark page.
    expect(picture).to_have_css('filter', 'none')
    notebook.execute('apputils:change-theme', theme='JupyterLab Dark')
    try:
        expect(picture).to_have_css('filter', re.compile('invert'))
    finally:
        notebook.execute('apputils:change-theme', theme='JupyterLab Light')
    # What a viewer gets that knows nothing of widgets is the same drawing.
    shown = notebook.cells()[notebook._index('still')]['outputs'][0]['data']
    assert sorted(shown) == ['image/svg+xml', 'text/html', 'text/plain']
