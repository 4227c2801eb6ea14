"""What a page says of views whose kernel is gone, and of those that are loaded again."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import ConsoleMessage, Locator, Page, TimeoutError, expect

from tests.browser.page import VIEWPORT, Notebook

pytestmark = pytest.mark.slow('a page in the browser')

CELLS = {
    'setup': """
import labkit as lab
from labkit.views import live_page
from rclpy.node import Node
from std_msgs.msg import Int16

live_page.STORE_SEC = 1.0

class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.count = 0
        self.numbers = self.create_publisher(Int16, 'odds', 10)
        self.create_timer(0.02, self.tick)

    def tick(self):
        self.count += 1
        self.numbers.publish(Int16(data=7000 + self.count % 100))

talker = lab.spin(Talker())
robot = lab.spin(lab.Turtlebot())
with lab.record('drive', ['/odom'], overwrite=True) as recording:
    recording.wait_for(5)
""",
    'monitor': "lab.monitor('/odds')",
    'plot': "lab.plot('/odds.data', seconds=2)",
    'arena': 'lab.arena()',
    'teleop': 'lab.teleop()',
    'graph': 'lab.graph()',
    'bag': "lab.bag('drive')",
    'quiz': "lab.lesson('talker_listener').quiz()",
    'two': "lab.spin(Talker())\ndisplay(lab.monitor('/odds'))\nlab.monitor('/odom')",
    'remove': "lab.remove('talker')",
}
VIEWS = ('monitor', 'plot', 'arena', 'teleop', 'graph', 'bag', 'quiz')
# What in each of them can have the focus.
FOCUSED = {
    'monitor': 'summary',
    'plot': 'button',
    'arena': 'canvas',
    'teleop': '.labkit-teleop',
    'graph': '[data-part][tabindex="0"]',
    'bag': 'button',
    'quiz': 'input[type="radio"]',
}
HAS_FOCUS = 'view => view.contains(document.activeElement)'
# What each of them leaves in the notebook.
LEFT = {
    'monitor': 'data: 70',
    'plot': 'alt=/odds.data: first 70',
    'arena': 'alt=Robot at x = 0.00 m',
    'teleop': 'turn left',
    'graph': 'alt=/talker',
    'bag': 'drive: ',
    'quiz': 'What is create_publisher',
}
# How many pixels have the colour of the first line.
DRAWN = """canvas => {
  const { width, height } = canvas;
  const pixels = canvas.getContext('2d').getImageData(0, 0, width, height).data;
  let count = 0;
  for (let i = 0; i < pixels.length; i += 4) {
    count += pixels[i] === 0 && pixels[i + 1] === 114 && pixels[i + 2] === 178;
  }
  return count;
}"""
# How large the letters of a view are, by what they are in; those of a canvas grow with its height.
LETTERS = """view => Object.fromEntries([view, ...view.querySelectorAll('*')].flatMap((part) => {
  const says = [...part.childNodes].some((each) => each.nodeType === 3 && each.data.trim());
  const name = `${part.tagName} ${part.getAttribute('class') ?? ''}`;
  if (part.matches('canvas') && part.closest('.labkit-plot')) return [[name, part.clientHeight]];
  if (!says || !part.getClientRects().length || part.tagName === 'STYLE') return [];
  const { fontSize } = getComputedStyle(part);
  return [[name, part.tagName === 'text' ? part.getBoundingClientRect().height
    : Number.parseFloat(fontSize)]];
}))"""
# Whether they have grown with the setting; those of a drawing as far as there is room for it.
GROWN = f"""([view, before]) => {{
  const drawing = view.querySelector('svg[viewBox]');
  const full = drawing && drawing.clientWidth > 0.95 * drawing.parentElement.clientWidth;
  const sizes = Object.entries(({LETTERS})(view)).filter(([name]) => name in before);
  return sizes.length > 0 && sizes.every(([name, size]) =>
    size > (full && name.startsWith('text') ? 1 : 1.15) * before[name] - 0.1);
}}"""
# JupyterLab's setting of the size of letters, increased by four steps.
LARGER = """larger => Object.entries({ content: 14, code: 13, ui: 13 }).forEach(([kind, size]) => {
  const name = kind === 'code' ? '--jp-code-font-size' : `--jp-${kind}-font-size1`;
  if (larger) document.documentElement.style.setProperty(name, `${size + 4}px`);
  else document.documentElement.style.removeProperty(name);
})"""
# What sticks out of a view, or is cut off there: its width, and that of what is in it.
STICKS_OUT = """view => {
  const { right } = view.getBoundingClientRect();
  return [...view.querySelectorAll('*')].filter((part) => !part.closest('svg, option')
    && part.getBoundingClientRect().right > right + 1 && getComputedStyle(part).clipPath === 'none'
  ).map((part) => `${part.tagName} ${part.className}`);
}"""
# What is wrong with stored forms on paper: a dark ground, faint words, something cut off.
WRONG_ON_PAPER = """place => [...place.querySelectorAll('.labkit-stored')].flatMap((box) => {
  const light = (colour) => {
    const [r, g, b, a = 1] = colour.match(/[\\d.]+/g).map(Number);
    return a === 0 ? 255 : (r + g + b) / 3;
  };
  const wrong = [];
  [box, ...box.querySelectorAll('p, pre')].forEach((part) => {
    const { backgroundColor: ground, color: ink, display } = getComputedStyle(part);
    if (display === 'none') wrong.push(['hidden', part.textContent]);
    if (light(ground) < 250) wrong.push(['dark', ground]);
    if (part !== box && light(ink) > 120) wrong.push(['faint', ink]);
    if (part.scrollWidth > part.clientWidth || part.scrollHeight > part.clientHeight + 1) {
      wrong.push(['cut', part.textContent]);
    }
  });
  box.querySelectorAll('img').forEach((img) => {
    if (!img.naturalWidth || img.width > box.clientWidth) wrong.push(['no picture', img.alt]);
  });
  return wrong;
})"""
TODO = 'un the setup cell at the top, then this one.'
GONE = f'The kernel is silent. If it was restarted or stopped, r{TODO}'
# Views whose code takes a page three seconds to load.
SLOW = """
from labkit.views import widget

page_files = widget.page_files
widget.page_files = lambda name: (
    'await new Promise((done) => setTimeout(done, 3000));\\n' + page_files(name)[0],
    page_files(name)[1],
)
"""


class Complaints:
    """What pages write on their consoles as errors."""

    def __init__(self) -> None:
        self.said: list[str] = []

    def hear(self, page: Page) -> None:
        def on_line(line: ConsoleMessage) -> None:
            if line.type == 'error':
                self.said.append(line.text)

        page.on('pageerror', lambda error: self.said.append(str(error)))
        page.on('console', on_line)


@pytest.fixture
def run_views(open_cells: Callable[..., Notebook]) -> Callable[[], Notebook]:
    """Give a function that opens a notebook and runs all of the views in it."""

    def run() -> Notebook:
        notebook = open_cells(**CELLS)
        notebook.run_cell('setup')
        for cell_id in VIEWS:
            notebook.run_cell(cell_id)
            assert notebook.error_of(cell_id) == '', cell_id
            expect_live(notebook, cell_id)
        return notebook

    return run


def expect_live(notebook: Notebook, cell_id: str) -> None:
    try:
        expect(notebook.output(cell_id).locator('.labkit-view')).to_be_visible()
    except AssertionError:
        # What JupyterLab says in the view's place is hidden behind what is stored.
        places = notebook.output(cell_id).locator('.jp-OutputArea-output')
        pytest.fail(f'{cell_id} does not live: {places.all_text_contents()}')
    expect(notebook.output(cell_id).locator('.labkit-stored')).to_be_hidden()


def expect_stored(notebook: Notebook, cell_id: str, text: str) -> None:
    output = notebook.output(cell_id)
    picture = output.locator('.labkit-stored img')
    if text.startswith('alt='):
        expect(picture).to_have_attribute('alt', re.compile(re.escape(text[4:])))
    else:
        expect(output.locator('.labkit-stored')).to_contain_text(text)
    expect(output.locator('.labkit-stored > p')).to_contain_text(TODO)
    expect(output.locator('.labkit-stored')).to_be_visible()
    expect(output.get_by_text('Error displaying widget')).to_be_hidden()


def wait_for_stored(notebook: Notebook, text: str) -> None:
    """Wait until the notebook, as it would be saved, has a text in some output."""
    notebook.page.wait_for_function(
        """text => JSON.stringify(window.jupyterapp.shell.currentWidget.content.widgets
          .map(cell => cell.model.toJSON().outputs)).includes(text)""",
        arg=text,
        # Not at each frame: it keeps the page busy.
        polling=200,
    )


def test_next_day_there_is_what_was_stored(run_views, jupyter):
    notebook = run_views()
    wait_for_stored(notebook, LEFT['monitor'])
    wait_for_stored(notebook, '/odds.data: first 70')
    for _ in range(2):
        notebook.execute('docmanager:save')
        name = notebook.page.evaluate('window.jupyterapp.shell.currentWidget.context.path')
        notebook.leave()
        jupyter.end_kernels()
        # Nor is it lost when the notebook is saved without the kernel that made it.
        notebook.open_beside(name.removesuffix('.ipynb'))
        for cell_id in VIEWS:
            expect_stored(notebook, cell_id, LEFT[cell_id])
    for cell_id in ('setup', *VIEWS):
        notebook.run_cell(cell_id)
    for cell_id in VIEWS:
        expect_live(notebook, cell_id)


def test_after_a_restart_all_views_say_so(run_views):
    notebook = run_views()
    complaints = Complaints()
    complaints.hear(notebook.page)
    notebook.restart_kernel()
    for cell_id in VIEWS:
        note = notebook.output(cell_id).locator('.labkit-live-note')
        expect(note).to_contain_text(GONE)
        assert 'Nothing new' not in notebook.output_text(cell_id)
    teleop = notebook.output('teleop').locator('.labkit-teleop')
    teleop.focus()
    notebook.page.keyboard.press('w')
    expect(teleop).not_to_contain_text('keys drive')
    expect(teleop).not_to_contain_text('Click here')
    assert complaints.said == []


def test_after_the_end_of_the_kernel_all_views_say_so(run_views, jupyter):
    notebook = run_views()
    jupyter.end_kernels()
    for cell_id in set(VIEWS) - {'bag', 'quiz'}:
        note = notebook.output(cell_id).locator('.labkit-live-note')
        expect(note, cell_id).to_contain_text(GONE)
    # What these show is true without a kernel, until it is asked. JupyterLab may keep a question
    # for a kernel that could come back: then it is the missing answer that tells.
    bag, quiz = notebook.output('bag'), notebook.output('quiz')
    bag.get_by_role('button', name='/odom').click()
    expect(bag.locator('.labkit-live-note')).to_contain_text(TODO)
    quiz.get_by_role('radio').first.check()
    quiz.get_by_role('button', name='Check this answer').click()
    expect(quiz).to_contain_text(GONE)


def test_loaded_again_they_go_on_and_a_plot_has_its_lines(run_views):
    notebook = run_views()
    notebook.reload()
    for cell_id in VIEWS:
        expect_live(notebook, cell_id)
    for cell_id in ('monitor', 'plot', 'arena'):
        view = notebook.output(cell_id).locator('.labkit-view').element_handle()
        notebook.page.wait_for_function('v => Number(v.dataset.updates) > 5', arg=view)
    plot = notebook.output('plot')
    expect(plot.locator('td').first).to_contain_text('70')
    # The topic ends. What came last is there, however long that is ago, and loaded again too.
    notebook.run_cell('remove')
    expect(plot.get_by_role('status')).to_contain_text('Nobody publishes on /odds.')
    canvas = plot.locator('.labkit-plot canvas').first
    later = int(canvas.get_attribute('data-frames') or 0) + 80
    notebook.page.wait_for_function(
        'canvas => Number(canvas.dataset.frames) > ' + str(later), arg=canvas.element_handle()
    )
    expect(plot.locator('td').first).to_contain_text('70')
    expect_drawn(plot)
    notebook.reload()
    expect_live(notebook, 'plot')
    plot = notebook.output('plot')
    expect(plot.get_by_role('status')).to_contain_text('Nobody publishes on /odds.')
    expect(plot.locator('td').first).to_contain_text('70')
    expect_drawn(plot)


def test_view_in_a_slow_page_hears_its_kernel(open_cells):
    notebook = open_cells(setup=CELLS['setup'] + SLOW, monitor=CELLS['monitor'])
    notebook.run_cell('setup')
    notebook.run_cell('monitor')
    expect_live(notebook, 'monitor')
    view = notebook.output('monitor').locator('.labkit-view')
    notebook.page.wait_for_function(
        'v => Number(v.dataset.updates) > 5', arg=view.element_handle()
    )


def expect_drawn(plot: Locator) -> None:
    # A table has its numbers before the next frame is drawn.
    canvas = plot.locator('.labkit-plot canvas').first
    drawn = f'canvas => ({DRAWN})(canvas) > 100'
    canvas.page.wait_for_function(drawn, arg=canvas.element_handle())


def expect_right_on_paper(place: Locator) -> None:
    # A form that is stored anew meanwhile takes the place of the one before.
    right = f'place => ({WRONG_ON_PAPER})(place).length === 0'
    try:
        place.page.wait_for_function(right, arg=place.element_handle())
    except TimeoutError:
        assert place.evaluate(WRONG_ON_PAPER) == []


def test_on_paper_there_is_the_stored_form(run_views, jupyter, browser):
    notebook = run_views()
    wait_for_stored(notebook, LEFT['monitor'])
    notebook.page.emulate_media(media='print')
    try:
        for theme in ('JupyterLab Dark', 'JupyterLab Light'):
            notebook.execute('apputils:change-theme', theme=theme)
            for cell_id in VIEWS:
                output = notebook.output(cell_id)
                expect(output.locator('.labkit-view')).to_be_hidden()
                expect(output.locator('.labkit-stored')).to_be_visible()
                expect_right_on_paper(output)
    finally:
        notebook.page.emulate_media(media='screen')
        notebook.execute('apputils:change-theme', theme='JupyterLab Light')
    # What JupyterLab makes of the file for File > Print.
    notebook.execute('docmanager:save')
    name = notebook.page.evaluate('window.jupyterapp.shell.currentWidget.context.path')
    page = browser.new_page()
    page.route(lambda address: '127.0.0.1' not in address, lambda route: route.abort())
    page.goto(jupyter.address(f'nbconvert/html/{name}'))
    page.emulate_media(media='print')
    expect(page.locator('.labkit-stored')).to_have_count(len(VIEWS))
    expect_right_on_paper(page.locator('body'))
    assert page.pdf().startswith(b'%PDF')
    page.close()


def test_letters_follow_the_setting_and_nothing_sticks_out(run_views):
    notebook = run_views()
    views = {
        cell_id: notebook.output(cell_id).locator('.labkit-view').element_handle()
        for cell_id in VIEWS
    }
    before = {cell_id: view.evaluate(LETTERS) for cell_id, view in views.items()}
    notebook.page.evaluate(LARGER, True)
    try:
        for cell_id, view in views.items():
            # The graph is laid out anew, by Python, for the letters that it has now.
            notebook.page.wait_for_function(GROWN, arg=[view, before[cell_id]])
        for width in (1400, 800):
            notebook.page.set_viewport_size({'width': width, 'height': 900})
            for cell_id in VIEWS:
                notebook.scroll_to_top(cell_id)
                assert views[cell_id].evaluate(STICKS_OUT) == [], (cell_id, width)
    finally:
        notebook.page.evaluate(LARGER, False)
        notebook.page.set_viewport_size(VIEWPORT)


def test_two_views_of_one_cell(open_cells):
    notebook = open_cells(**CELLS)
    notebook.run_cell('setup')
    notebook.run_cell('two')
    views = notebook.output('two').locator('.labkit-view')
    expect(views).to_have_count(2)
    for stored in notebook.output('two').locator('.labkit-stored').all():
        expect(stored).to_be_hidden()
    wait_for_stored(notebook, '/odom [nav_msgs/msg/Odometry]')


def test_escape_leaves_a_view_and_shift_enter_runs_its_cell(run_views):
    notebook = run_views()
    page, count = notebook.page, len(notebook.cells())
    button = notebook.output('plot').get_by_role('button', name='Pause')
    button.focus()
    page.keyboard.press('a')
    assert len(notebook.cells()) == count
    page.keyboard.press('Escape')
    expect(button).not_to_be_focused()
    # Now it is JupyterLab's key again: a cell above.
    page.keyboard.press('a')
    page.wait_for_function(
        'count => window.jupyterapp.shell.currentWidget.content.widgets.length === count',
        arg=count + 1,
    )
    for cell_id, focused in FOCUSED.items():
        place = notebook.output(cell_id).locator(focused).first
        old = notebook.output(cell_id).locator('.labkit-view').element_handle()
        place.focus()
        assert old.evaluate(HAS_FOCUS), cell_id
        page.keyboard.press('Escape')
        page.wait_for_function(f'view => !({HAS_FOCUS})(view)', arg=old)
        place.focus()
        page.keyboard.press('Shift+Enter')
        page.wait_for_function('view => !view.isConnected', arg=old)
        expect_live(notebook, cell_id)
