// What RViz shows: a scene in three dimensions, drawn when something has changed.

const ARROWS = {
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
};
const TURN = 0.1; // rad, of a key
const TURN_PX = 0.008; // rad, of a pixel
const PAN_PX = 30; // of a key
const ZOOM = 1.2;
const NAME_PX = 13; // lines of names are no nearer to each other
const NO_WEBGL = 'This browser draws nothing in three dimensions: it has no WebGL 2, or it is switched '
  + 'off. Another browser on this computer may have it. What there is stands below in words.';
const ABOUT = 'Scene in three dimensions, told in words below. Arrow keys go round it, with Shift '
  + 'they move it, plus and minus zoom, 0 shows all, t looks from above, f follows the robot, d '
  + 'goes to the displays.';

// The colours of the theme, as numbers from 0 to 1. The page's may be written in any way.
class Palette {
  constructor(canvas) {
    this.canvas = canvas;
    this.paint = element('canvas', { width: 1, height: 1 }).getContext('2d');
    this.known = new Map();
  }

  forget() { this.known.clear(); }

  of(name) {
    if (!this.known.has(name)) {
      const written = name.startsWith('#') ? name
        : getComputedStyle(this.canvas).getPropertyValue(`--labkit-${name}`).trim();
      this.paint.fillStyle = written || '#777';
      this.paint.fillRect(0, 0, 1, 1);
      const { data } = this.paint.getImageData(0, 0, 1, 1);
      this.known.set(name, [...data.slice(0, 3)].map((part) => part / 255));
    }
    return this.known.get(name);
  }
}

// Names beside what they are of. Where there is no room, the first one is there.
class Names {
  constructor() {
    this.place = element('div', { className: 'labkit-scene-names' });
    this.place.setAttribute('aria-hidden', 'true');
  }

  show(names, camera) {
    const taken = [];
    const found = [];
    for (const [text, place, kind] of names) {
      const at = camera.onScreen(place);
      if (at) found.push([text, kind, ...at]);
    }
    const shown = found.filter(([text, , x, y]) => {
      const half = 3.5 * text.length;
      const hits = taken.some(([a, b, width]) => (
        Math.abs(x - a) < half + width && Math.abs(y - b) < NAME_PX));
      const isIn = x > 0 && x < camera.width && y > 0 && y < camera.height;
      if (!hits && isIn) taken.push([x, y, half]);
      return !hits && isIn;
    });
    while (this.place.children.length < shown.length) this.place.append(element('span'));
    [...this.place.children].forEach((child, index) => {
      child.hidden = index >= shown.length;
      if (child.hidden) return;
      const [text, kind, x, y] = shown[index];
      setText(child, text);
      child.className = `labkit-scene-${kind}`;
      child.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, 0)`;
    });
  }
}

// What cameras see, below in a corner.
class Insets {
  constructor() {
    this.place = element('div', { className: 'labkit-scene-pictures' });
    this.known = new Map();
  }

  take(topic, bytes) {
    if (!this.known.has(topic)) {
      const picture = element('img', { alt: `Picture of ${topic}` });
      const figure = element('figure', {}, picture, element('figcaption', { textContent: topic }));
      this.place.append(figure);
      this.known.set(topic, { picture, figure });
    }
    showJpeg(this.known.get(topic).picture, bytes);
  }

  // Only those that are on.
  keep(topics) {
    for (const [topic, { picture, figure }] of this.known) {
      if (!topics.includes(topic)) {
        showJpeg(picture, null);
        figure.remove();
        this.known.delete(topic);
      }
    }
  }
}

// The list of what is shown, with the frames that stand still and are followed.
function displayPanel(camera, redraw, send) {
  const list = element('ul');
  const choice = (label, act) => {
    const select = element('select');
    select.addEventListener('change', () => act(select.value));
    return [element('label', {}, `${label} `, select), select];
  };
  const [fixedLabel, fixed] = choice('Fixed frame', (name) => send({ fixed: name }));
  const [followLabel, followed] = choice('Follow', (name) => {
    camera.followed = name;
    redraw();
  });
  const summary = element('summary', { textContent: 'Displays' });
  const place = element('details', { className: 'labkit-scene-displays' },
    summary, element('div', {}, fixedLabel, followLabel, list));
  const fill = (select, names, chosen) => {
    const texts = names.join('\n');
    if (select.dataset.names !== texts) {
      select.dataset.names = texts;
      select.replaceChildren(...names.map(
        (name) => element('option', { value: name, textContent: name || 'nothing' })));
    }
    select.value = chosen;
  };
  const boxes = new Map();
  const show = (displays) => {
    const names = displays.map(([name]) => name);
    for (const [name, { row }] of boxes) {
      if (!names.includes(name)) {
        row.remove();
        boxes.delete(name);
      }
    }
    for (const [name, isOn, why] of displays) {
      if (!boxes.has(name)) {
        const box = element('input', { type: 'checkbox' });
        box.addEventListener('change', () => send({ display: name, on: box.checked }));
        const reason = element('small', { hidden: true });
        const row = element('li', {}, element('label', {}, box, ` ${name}`), reason);
        list.append(row);
        boxes.set(name, { row, box, reason });
      }
      const { box, reason } = boxes.get(name);
      box.checked = isOn;
      setText(reason, why && `⚠ ${why}`);
      reason.hidden = !why;
    }
    const wrong = displays.filter(([, , why]) => why).length;
    setText(summary, wrong ? `Displays (⚠ ${wrong})` : 'Displays');
  };
  return {
    place,
    open: () => {
      place.open = !place.open;
      if (place.open) summary.focus();
    },
    show,
    frames: (names, standing) => {
      fill(fixed, names, standing);
      fill(followed, ['', ...names], camera.followed);
    },
  };
}

// Mouse: drag to go round, with another button or Shift to move, wheel to zoom. The wheel alone
// scrolls the page until the scene was clicked. Touch: one finger goes round, two move and zoom.
function pointAtScene(canvas, camera, redraw) {
  const fingers = new Map();
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a[0] - b[0], a[1] - b[1]);
  };
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
  });
  canvas.addEventListener('pointermove', (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const [right, down] = [event.offsetX - before[0], event.offsetY - before[1]];
    const apart = fingers.size === 2 ? spread() : 0;
    fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    if (fingers.size === 2) {
      camera.zoom(spread() / (apart || 1));
      camera.pan(right / 2, -down / 2);
    } else if (event.buttons !== 1 || event.shiftKey) camera.pan(right, -down);
    else camera.turn(TURN_PX * right, TURN_PX * down);
    redraw();
  });
  for (const kind of ['pointerup', 'pointercancel', 'lostpointercapture']) {
    canvas.addEventListener(kind, ({ pointerId }) => fingers.delete(pointerId));
  }
  canvas.addEventListener('contextmenu', (event) => {
    event.preventDefault();
    event.stopPropagation();
  });
  canvas.addEventListener('wheel', (event) => {
    if (document.activeElement !== canvas && !event.ctrlKey) return;
    event.preventDefault();
    camera.zoom(ZOOM ** (-Math.sign(event.deltaY) / 2));
    redraw();
  }, { passive: false });
}

function sceneButtons(camera, frames, robots, redraw, el, send) {
  const make = overButton(redraw);
  const full = fullScreenButton(make, el);
  const dock = dockButton(make, send);
  // One robot after the other, then none; where there is none, the frames.
  const follow = make('Follow', 'Follow the robot (key f)', () => {
    const names = robots.length ? robots : [...frames.keys()];
    camera.followed = names[names.indexOf(camera.followed) + 1] ?? '';
  });
  const all = [
    make('+', 'Come nearer (key +)', () => camera.zoom(ZOOM)),
    make('−', 'Go away (key -)', () => camera.zoom(1 / ZOOM)),
    make('Fit', 'Show all (key 0)', () => camera.home()),
    make('Top', 'Look from above (key t)', () => camera.fromAbove()),
    follow, dock, full,
  ];
  return {
    place: buttonsOver('Scene', all),
    keys: {
      '+': all[0], '=': all[0], '-': all[1], 0: all[2], t: all[3], f: follow, k: dock, o: full,
    },
    show: () => {
      showOver(dock, full, el);
      follow.setAttribute('aria-pressed', String(Boolean(camera.followed)));
      setText(follow, camera.followed ? `Follow ${camera.followed}` : 'Follow');
    },
  };
}

function render({ model, el }) {
  el.classList.add('labkit-live', 'labkit-scene');
  el.setAttribute('role', 'group');
  el.setAttribute('aria-label', 'Scene');
  const canvas = element('canvas', { tabIndex: 0 });
  canvas.setAttribute('role', 'img');
  canvas.setAttribute('aria-label', ABOUT);
  const words = element('div', { className: 'labkit-scene-words' });
  words.setAttribute('aria-live', 'polite');
  // JupyterLab makes a view anew that was out of sight.
  const camera = model.labkitCamera ??= new Camera();
  const frames = new Map();
  const palette = new Palette(canvas);
  const names = new Names();
  const insets = new Insets();
  let drawing = null;
  try {
    drawing = new SceneDrawing(canvas);
  } catch {
    canvas.hidden = true;
  }
  const shown = { axes: true, grid: true };
  const robots = [];
  let [frame, standing] = [0, ''];
  const redraw = () => {
    if (!drawing) return;
    frame ||= requestAnimationFrame(() => {
      frame = 0;
      if (!canvas.clientWidth || drawing.gl.isContextLost()) return;
      drawing.draw(camera, frames, { ...shown, colour: (name) => palette.of(name) });
      names.show(drawing.names(frames, shown.axes, camera.pixel), camera);
      buttons.show();
      panel.frames([...frames.keys()], standing);
      // For those who look on from outside, such as tests.
      canvas.dataset.draws = Number(canvas.dataset.draws ?? 0) + 1;
      canvas.dataset.things = drawing.things.size;
      const { azimuth, elevation, distance, target } = camera;
      canvas.dataset.view = [azimuth, elevation, distance, ...target]
        .map((value) => value.toFixed(2)).join(' ');
    });
  };
  const ask = (content) => send(content);
  const panel = displayPanel(camera, redraw, ask);
  const buttons = sceneButtons(camera, frames, robots, redraw, el, ask);
  const { note, say, send, end } = follow(model, el, (news, buffers) => {
    if (news.frames) {
      frames.clear();
      for (const [name, place] of Object.entries(news.frames)) frames.set(name, matrixOf(place));
    }
    if (news.fixed !== undefined && news.fixed !== standing) {
      standing = news.fixed;
      camera.around = null;
    }
    if (news.robots) robots.splice(0, robots.length, ...news.robots);
    if (news.all) camera.followed ??= news.follow;
    for (const [name, told] of Object.entries(news.things ?? {})) {
      drawing?.take(name, told, buffers ?? []);
    }
    if (news.all || news.things) includeAll(camera, drawing, frames);
    if (news.displays) {
      panel.show(news.displays);
      insets.keep(news.displays.filter(([, on]) => on).map(([name]) => name));
      const isOn = (name) => news.displays.some(([one, on]) => one === name && on);
      Object.assign(shown, { axes: isOn('frames'), grid: isOn('grid') });
    }
    for (const [topic, index] of Object.entries(news.pictures ?? {})) {
      insets.take(topic, buffers[index]);
    }
    if (news.text !== undefined) setText(words, news.text || news.empty || '');
    if (news.frames || news.things || news.displays || news.fixed !== undefined) redraw();
    if (news.fresh) comeIntoView(el);
  });
  const over = element('div', { className: 'labkit-scene-over' },
    names.place, insets.place, panel.place, buttons.place);
  el.append(element('div', { className: 'labkit-scene-space' }, canvas, over), words, note);
  if (!drawing) say(NO_WEBGL);
  pointAtScene(canvas, camera, redraw);
  canvas.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key === 'd') panel.open();
    buttons.keys[event.key]?.click();
    const arrow = ARROWS[event.key];
    if (!arrow) return;
    event.preventDefault();
    if (event.shiftKey) camera.pan(-PAN_PX * arrow[0], -PAN_PX * arrow[1]);
    else camera.turn(-TURN * arrow[0], TURN * arrow[1]);
    redraw();
  });
  canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
  canvas.addEventListener('webglcontextrestored', () => {
    drawing.prepare();
    redraw();
  });
  const repaint = () => {
    palette.forget();
    redraw();
  };
  const sizes = new ResizeObserver(redraw);
  sizes.observe(canvas);
  const themes = new MutationObserver(repaint);
  themes.observe(document.body, { attributes: true });
  document.addEventListener('fullscreenchange', redraw);
  return () => {
    sizes.disconnect();
    themes.disconnect();
    document.removeEventListener('fullscreenchange', redraw);
    cancelAnimationFrame(frame);
    end();
    insets.keep([]);
    drawing?.end();
  };
}

// Let the camera know how far all reaches.
function includeAll(camera, drawing, frames) {
  if (!drawing) return;
  for (const matrix of frames.values()) camera.include(placed(matrix, [0, 0, 0]));
  for (const thing of drawing.things.values()) {
    const model = drawing.model(thing, frames);
    if (!model) continue;
    const { points, size } = thing;
    const at = (corner) => camera.include(placed(model, corner.map((v, i) => v * size[i])));
    if (!points) {
      for (const sign of [-0.5, 0.5]) at([sign, sign, sign]);
    } else {
      // Of many points some are enough.
      const step = 3 * Math.max(1, Math.floor(points.length / 300));
      for (let i = 0; i + 2 < points.length; i += step) at([...points.slice(i, i + 3)]);
    }
  }
}

export default { render };
