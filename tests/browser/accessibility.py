"""What people who do not see or do not use a mouse would miss: found by axe-core in the page."""

from __future__ import annotations

from axe_playwright_python.base import AXE_SCRIPT

from tests.browser.page import Notebook

# What axe looks at is a part of the page, and what JupyterLab has put around it is not ours. Text
# that scrolls in a box is reached by Tab in today's browsers, which axe does not know, see
# test_output.py.
_RUN = """async index => {
  const place = document.querySelector(
    `.jp-Notebook-cell[data-windowed-list-index="${index}"] .jp-Cell-outputArea`);
  if (!place || !place.textContent.trim() && !place.querySelector('img, svg, canvas, input'))
    return [];
  const found = await axe.run(place, {resultTypes: ['violations'], elementRef: true});
  const isText = (rule, node) => rule.id === 'scrollable-region-focusable'
    && node.element.matches('.jp-RenderedText');
  return found.violations.flatMap(rule => rule.nodes.filter(node => !isText(rule, node)).map(
    node => `${rule.id}: ${rule.help}: ${node.html.slice(0, 200)} ${node.failureSummary}`));
}"""


def violations(notebook: Notebook, cell_id: str) -> list[str]:
    """Return what axe-core finds wrong in the outputs of a cell, one text each."""
    notebook.cell(cell_id)
    notebook.wait_for_pictures()
    if not notebook.page.evaluate('Boolean(window.axe)'):
        notebook.page.evaluate(AXE_SCRIPT)
    index = [cell['id'] for cell in notebook.cells()].index(cell_id)
    found: list[str] = notebook.page.evaluate(_RUN, index)
    return found
