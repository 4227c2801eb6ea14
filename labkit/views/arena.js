// A map that is drawn when there is something new, at most once a frame of the screen.

const ARROWS = {
  ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1],
};

function render({ model, el }) {
  el.classList.add('labkit-live', 'labkit-arena');
  const words = element('div', { className: 'labkit-arena-words' });
  words.setAttribute('aria-live', 'polite');
  const canvas = element('canvas', { tabIndex: 0 });
  canvas.setAttribute('role', 'img');
  canvas.setAttribute(
    'aria-label',
    'Map around the robot, told in words below. Arrow keys move a cross, Escape removes it.',
  );
  const map = new Map2d(canvas);
  const scene = emptyScene();
  let [cursor, frame] = [null, 0];

  const redraw = () => {
    frame ||= requestAnimationFrame(() => {
      frame = 0;
      if (canvas.clientWidth) map.draw(scene, cursor);
    });
  };
  const { note, end } = follow(model, el, (news, buffers) => {
    take(scene, news, buffers?.[0]);
    if (news.text) setText(words, news.text);
    // For those who look on from outside, such as tests.
    canvas.dataset.frames = Number(canvas.dataset.frames ?? 0) + 1;
    if (scene.pose) canvas.dataset.pose = scene.pose.map((value) => value.toFixed(3)).join(' ');
    redraw();
  });
  el.append(canvas, words, note);
  canvas.addEventListener('pointermove', ({ offsetX, offsetY }) => {
    if (map.scale) cursor = map.metres(offsetX, offsetY);
    redraw();
  });
  const noCursor = () => {
    cursor = null;
    redraw();
  };
  canvas.addEventListener('pointerleave', noCursor);
  canvas.addEventListener('blur', noCursor);
  canvas.addEventListener('keydown', (event) => {
    if (event.key === 'Escape') noCursor();
    const step = ARROWS[event.key];
    if (!step) return;
    event.preventDefault();
    cursor = [0, 1].map((axis) => (cursor ?? scene.pose ?? [0, 0])[axis] + step[axis]);
    redraw();
  });
  const sizes = new ResizeObserver(redraw);
  sizes.observe(canvas);
  const themes = new MutationObserver(redraw);
  themes.observe(document.body, { attributes: true });

  return () => {
    sizes.disconnect();
    themes.disconnect();
    cancelAnimationFrame(frame);
    end();
  };
}

export default { render };
