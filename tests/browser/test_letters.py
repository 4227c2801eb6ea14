"""Words on the canvases of map and plot: as large as the letters of the page, and all of each."""

from __future__ import annotations

import pytest

from labkit.views.widget import page_files

pytestmark = pytest.mark.slow('a page in the browser')

# What is written on a canvas: the text, its left and right edge in the canvas, and its size.
SPY = """
const written = [];
const plain = CanvasRenderingContext2D.prototype.fillText;
CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
  plain.call(this, text, x, y);
  const { a, b, e } = this.getTransform();
  const wide = this.measureText(text).width;
  const before = { right: wide, center: wide / 2 }[this.textAlign] ?? 0;
  const size = a * Number.parseFloat(this.font);
  if (!b) written.push([text, a * (x - before) + e, a * (x - before + wide) + e, size]);
};
"""
DRAW = {
    'arena': 'new Map2d(canvas).draw({ ...emptyScene(), shown: [-1.5, -1, RIGHT, 1] })',
    'plot': """new Sheet(canvas).draw([{ unit: 'm', number: 0, times: [0, RIGHT],
      values: [-1000, 1000] }], 0, RIGHT)""",
}


@pytest.mark.parametrize('name', DRAW)
def test_words_follow_the_letters_and_none_is_cut_off(browser, name):
    script = page_files(name)[0].partition('export default')[0]
    page = browser.new_page()
    page.set_content('<canvas style="width: 560px; height: 330px"></canvas>')
    page.add_script_tag(
        content=f"""{SPY}{script}
        const canvas = document.querySelector('canvas');
        window.write = (letters, RIGHT) => {{
          canvas.style.fontSize = `${{letters}}px`;
          written.length = 0;
          {DRAW[name]};
          return written;
        }};"""
    )
    for right in (1.5, 1.55, 1.62, 1.7, 2.0, 2.6):
        sizes = []
        for letters in (14, 18):
            written = page.evaluate(f'write({letters}, {right})')
            assert len(written) > 5
            assert [text for text, low, high, _ in written if low < 0 or high > 560] == []
            sizes.append({round(size / letters, 3) for *_, size in written})
        assert sizes[0] == sizes[1] and len(sizes[0]) == 1
    page.close()
