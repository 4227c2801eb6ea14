"""A lesson in a browser, driven as a learner does: keys, menus and buttons.

JupyterLab keeps only those cells in the page that are near the visible part, so a cell is found
by its id in JupyterLab's own model, scrolled to, and then looked at in the page.
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from playwright.sync_api import Browser, BrowserContext, Locator, Page, expect, sync_playwright

from tests.browser.jupyter import JupyterLab

# Generous, because machines under test are busy: the limit is there to end a hang, not to judge.
TIMEOUT_SEC = 60.0
VIEWPORT = {'width': 1280, 'height': 900}
_PROGRAMS = ('chromium', 'chromium-browser', 'google-chrome')
_OPTIONS = [
    '--headless',
    '--no-sandbox',
    '--disable-gpu',
    '--disable-quic',
    '--no-first-run',
    '--disable-background-networking',
    '--disable-component-update',
    '--disable-sync',
]
# The notebook in front, and its cells.
_NOTEBOOK = 'window.jupyterapp.shell.currentWidget'
_CELLS = f'{_NOTEBOOK}.content.widgets'
# Whether the notebook of this path is in front, and its kernel idle.
READY = """path => {
  const panel = window.jupyterapp?.shell.currentWidget;
  return panel?.context?.isReady && panel.context.path.endsWith(path)
    && panel.sessionContext?.session?.kernel?.status === 'idle';
}"""
# Whether all widgets are drawn. JupyterLab looks for a widget's model for two seconds, and not
# once more after them (`get_model` of its widgets' manager): where a page was busy for so long
# while the models came, it says that there is none, and has to draw that output anew.
_WIDGETS_DRAWN = f"""() => {{
  const places = {_CELLS}.filter((cell) => cell.outputArea).map((cell) => cell.outputArea);
  const says = (area, words) => [...area.node.querySelectorAll('.jp-OutputArea-output')]
    .some((place) => place.textContent === words);
  const lost = places.filter((area) => says(area, 'Error displaying widget: model not found'));
  lost.forEach((area) => area.model.fromJSON(area.model.toJSON()));
  return !lost.length && !places.some((area) => says(area, 'Loading widget...'));
}}"""
# Where JupyterLab lets a line be typed for `input()`.
_ASKED = 'input.jp-Stdin-input'
# After an error that is meant JupyterLab takes the marks from all further cells, but the kernel
# goes on with them.
_ALL_RAN = f"""() => {{
  const cells = {_CELLS}.map(cell => cell.model.toJSON()).filter(cell => cell.source.trim());
  const code = cells.filter(cell => cell.cell_type === 'code');
  const failed = code.some(cell => cell.outputs.some(output => output.output_type === 'error')
    && !cell.metadata.tags?.includes('raises-exception'));
  return {_NOTEBOOK}.sessionContext.session.kernel.status === 'idle'
    && !{_CELLS}.some(cell => cell.prompt === '*')
    && (failed || code.every(cell => cell.execution_count));
}}"""


def chromium_path() -> str | None:
    """Return where Chromium is, None if it is not installed."""
    return next(filter(None, map(shutil.which, _PROGRAMS)), None)


@contextmanager
def open_browser(
    width: int = VIEWPORT['width'], height: int = VIEWPORT['height']
) -> Iterator[BrowserContext]:
    """Start Chromium with tabs of this size, in pixels."""
    with sync_playwright() as playwright:
        browser: Browser = playwright.chromium.launch(
            executable_path=chromium_path(), args=_OPTIONS
        )
        context = browser.new_context(viewport={'width': width, 'height': height})
        context.set_default_timeout(TIMEOUT_SEC * 1000)
        expect.set_options(timeout=TIMEOUT_SEC * 1000)
        try:
            yield context
        finally:
            browser.close()


class Notebook:
    """A notebook in a tab of the browser, with its kernel.

    Args:
        page: The browser's tab.
    """

    def __init__(self, page: Page) -> None:
        self.page = page
        self.was_reloaded = False

    def open(self, address: str) -> Notebook:
        """Load JupyterLab, which opens a notebook, and wait until its kernel is idle.

        JupyterLab first opens again what was open in an earlier page. Only an address that names
        the notebook tells which one is meant.
        """
        self.page.goto(address)
        named = re.search(r'/lab/tree/([^?]+)', address)
        self.page.wait_for_function(READY, arg=unquote(named[1]) if named else '')
        return self

    def open_beside(self, name: str) -> Notebook:
        """Open a notebook in the JupyterLab that is loaded, which is quicker than loading it."""
        self.execute('docmanager:open', path=f'{name}.ipynb')
        self.page.wait_for_function(READY, arg=f'{name}.ipynb')
        return self

    def leave(self) -> None:
        """Close the notebook without saving it; its kernel and JupyterLab go on."""
        self.page.evaluate(
            f'() => {{ {_NOTEBOOK}.context.model.dirty = false; {_NOTEBOOK}.close() }}'
        )
        self.page.wait_for_function(f'() => !{_NOTEBOOK}?.context')

    def reload(self) -> None:
        """Save the notebook and load the page again; the kernel goes on.

        JupyterLab opens the notebook once from its workspace and, at a time of its own, once more
        from the address. A tab that was loaded again is therefore not for another notebook.
        """
        self.was_reloaded = True
        self.execute('docmanager:save')
        path = self.page.evaluate(f'{_NOTEBOOK}.context.path')
        self.page.reload()
        self.page.wait_for_function(READY, arg=path)
        self.page.wait_for_function(_WIDGETS_DRAWN, polling=200)

    @property
    def has_dialog(self) -> bool:
        """Whether JupyterLab asks something."""
        return self.page.locator('.jp-Dialog').count() > 0

    # -- cells ----------------------------------------------------------------------------------

    def cells(self) -> list[dict[str, Any]]:
        """Return id, type, source, outputs and so on of each cell, as in a notebook file."""
        found: list[dict[str, Any]] = self.page.evaluate(
            f'() => {_CELLS}.map(cell => cell.model.toJSON())'
        )
        return found

    def cell(self, cell_id: str) -> Locator:
        """Scroll to a cell and return its place in the page."""
        index = self._index(cell_id)
        self.page.evaluate(f'index => {_NOTEBOOK}.content.scrollToItem(index)', index)
        place = self.page.locator(f'.jp-Notebook-cell[data-windowed-list-index="{index}"]')
        place.wait_for()
        return place

    def replace_cell(self, cell_id: str, code: str) -> None:
        """Put other code into a cell."""
        self.page.evaluate(
            f'([index, code]) => {_CELLS}[index].model.sharedModel.setSource(code)',
            [self._index(cell_id), code.strip()],
        )

    def start_cell(self, cell_id: str) -> None:
        """Press Ctrl+Enter in a cell, and wait only until it is marked as running."""
        place = self.cell(cell_id)
        # Without the number of its last run, any prompt is that of the new one.
        index = self._index(cell_id)
        self.page.evaluate(f'index => {{ {_CELLS}[index].model.executionCount = null }}', index)
        place.locator('.cm-content').click()
        self.page.keyboard.press('Control+Enter')
        self._wait_for_prompt(cell_id, "prompt !== ''")

    def wait_for_end(self, cell_id: str) -> str:
        """Wait until a started cell has ended; return what is shown under it."""
        self._wait_for_prompt(cell_id, "prompt !== '*'")
        return self.output_text(cell_id)

    def run_cell(self, cell_id: str) -> str:
        """Run a cell to its end and return what is shown under it."""
        self.start_cell(cell_id)
        return self.wait_for_end(cell_id)

    def is_running(self, cell_id: str) -> bool:
        """Tell whether a cell has been started and has not ended."""
        return bool(self.page.evaluate(f"i => {_CELLS}[i].prompt === '*'", self._index(cell_id)))

    def output(self, cell_id: str) -> Locator:
        """Return the place under a cell where its outputs are."""
        return self.cell(cell_id).locator('.jp-Cell-outputArea')

    def output_text(self, cell_id: str) -> str:
        """Return what can be read under a cell.

        JupyterLab draws text anew when a cell comes into view: while it has not, there is none.
        """
        place = self.output(cell_id)
        if self._has_text(cell_id):
            expect(place).to_have_text(re.compile(r'\S'), use_inner_text=True)
        return place.inner_text().strip()

    def error_of(self, cell_id: str) -> str:
        """Return name and message of the error with which a cell has ended, '' if it is well."""
        outputs = self.cells()[self._index(cell_id)]['outputs']
        errors = [output for output in outputs if output['output_type'] == 'error']
        return f'{errors[0]["ename"]}: {errors[0]["evalue"]}' if errors else ''

    def wait_output(self, cell_id: str, text: str) -> str:
        """Wait until `text` can be read under a cell; return all that can be read there."""
        expect(self.output(cell_id)).to_contain_text(text)
        return self.output_text(cell_id)

    # -- the whole notebook ---------------------------------------------------------------------

    def start_all(self) -> None:
        """Choose Run All Cells in the menu."""
        self.page.evaluate(f'() => {{ {_CELLS}.forEach(cell => cell.model.clearExecution?.()) }}')
        self.choose('Run', 'Run All Cells')

    def wait_for_all(self) -> None:
        """Wait until all cells have ended, or those after an error have been dropped.

        Where one asks for a line, with `input()`, Enter is pressed.
        """
        either = f'() => Boolean(document.querySelector({_ASKED!r})) || ({_ALL_RAN})()'
        asked = self.page.locator(_ASKED)
        while True:
            self.page.wait_for_function(either, polling=100, timeout=5 * TIMEOUT_SEC * 1000)
            if not asked.count():
                return
            asked.press('Enter')
            expect(asked).to_have_count(0)

    def run_all(self) -> None:
        """Choose Run All Cells in the menu, and wait until all have ended."""
        self.start_all()
        self.wait_for_all()

    def press_stop(self) -> None:
        """Press the stop button in the toolbar."""
        self._press('notebook:interrupt-kernel')

    def restart_kernel(self) -> None:
        """Press the restart button, confirm, and wait for the new kernel."""
        self.page.evaluate(
            f"""() => {{
              const seen = window.labkitStatuses = [];
              const kernel = {_NOTEBOOK}.sessionContext.session.kernel;
              kernel.statusChanged.connect((_, status) => seen.push(status));
            }}"""
        )
        self._press('notebook:restart-kernel')
        self.page.locator('.jp-Dialog-button.jp-mod-accept').click()
        # The old kernel may say once more that it is idle, after an answer to a view. Between the
        # two, the page has no connection: then it knows nothing of a kernel.
        self.page.wait_for_function(
            """() => {
              const seen = window.labkitStatuses;
              const restarting = seen.indexOf('restarting');
              return restarting >= 0 && seen.indexOf('unknown', restarting) >= 0
                && seen[seen.length - 1] === 'idle';
            }"""
        )

    def choose(self, menu: str, entry: str) -> None:
        """Choose an entry of a menu."""
        self.page.get_by_role('menuitem', name=menu, exact=True).click()
        self.page.get_by_role('menuitem', name=entry, exact=True).click()

    def execute(self, command: str, **arguments: Any) -> None:
        """Run a command of JupyterLab by its name, and wait until it is done."""
        self.page.evaluate(
            """async ([command, options]) => {
              await window.jupyterapp.commands.execute(command, options);
            }""",
            [command, arguments],
        )

    # -- what is visible ------------------------------------------------------------------------

    def scroll_to_top(self, cell_id: str) -> None:
        """Scroll a cell to the top of the visible part."""
        self.cell(cell_id)
        # Where a cell is, is known for certain only when those around it have been drawn.
        self.wait_for_pictures()
        self.page.evaluate(
            f"""index => {{
              const view = {_NOTEBOOK}.content.outerNode, node = {_CELLS}[index].node;
              const top = node => node.getBoundingClientRect().top;
              view.scrollTop += top(node) - top(view);
            }}""",
            self._index(cell_id),
        )

    def scroll_on(self) -> bool:
        """Scroll on by a screenful, but for a few lines; False if the last cell is visible."""
        more: bool = self.page.evaluate(
            f"""() => {{
              const view = {_NOTEBOOK}.content.outerNode, last = {_CELLS}.at(-1).node;
              const bottom = node => node.getBoundingClientRect().bottom;
              const more = !last.isConnected || bottom(last) > bottom(view);
              if (more) view.scrollTop += 0.9 * view.clientHeight;
              return more;
            }}"""
        )
        return more

    def wait_for_pictures(self) -> None:
        """Wait until all in the visible part is drawn, and its pictures loaded or broken."""
        # Two frames: in the first one, JupyterLab puts the cells in.
        self.page.evaluate(
            '() => new Promise(f => requestAnimationFrame(() => requestAnimationFrame(f)))'
        )
        self.page.wait_for_function(
            f"""() => {_CELLS}.every(cell => !cell.isPlaceholder() || !cell.node.isConnected)
              && [...document.querySelectorAll('.jp-Notebook img')].every(p => p.complete)"""
        )

    def broken_pictures(self, cell_id: str) -> list[str]:
        """Return the text alternatives of a cell's pictures that can not be shown."""
        place = self.cell(cell_id)
        self.wait_for_pictures()
        # That of a camera may come at any time, and is no picture before.
        found: list[str] = place.locator('img').evaluate_all("""async pictures => {
          const comes = (picture) => !picture.naturalWidth && !picture.complete;
          while (pictures.some(comes)) await new Promise(requestAnimationFrame);
          return pictures.filter((p) => !p.naturalWidth && !p.hidden).map((p) => p.alt);
        }""")
        return found

    def screenshot(self, path: str | os.PathLike[str]) -> None:
        """Save a picture of what is visible."""
        self.page.mouse.move(0, 0)  # what is under the mouse looks otherwise
        self.wait_for_pictures()
        self.page.screenshot(path=Path(path))

    def close(self) -> None:
        """Close the tab; the kernel goes on."""
        self.page.close()

    # -- details --------------------------------------------------------------------------------

    def _press(self, command: str) -> None:
        self.page.locator(f'.jp-NotebookPanel-toolbar [data-command="{command}"]').click()

    def _index(self, cell_id: str) -> int:
        ids = [cell['id'] for cell in self.cells()]
        return ids.index(cell_id)

    def _has_text(self, cell_id: str) -> bool:
        outputs = self.cells()[self._index(cell_id)]['outputs']
        texts = [output.get('text', '') for output in outputs if output['output_type'] == 'stream']
        return any(text.strip() for text in map(''.join, texts))

    def _wait_for_prompt(self, cell_id: str, condition: str) -> None:
        self.page.wait_for_function(
            f'index => {{ const prompt = {_CELLS}[index].prompt; return {condition} }}',
            arg=self._index(cell_id),
        )


def open_notebook(lab: JupyterLab, browser: BrowserContext, name: str) -> Notebook:
    """Open a notebook of the learner's folder, by its name without `.ipynb`, in a new tab."""
    return Notebook(browser.new_page()).open(lab.address(f'lab/tree/{name}.ipynb') + '&reset')
