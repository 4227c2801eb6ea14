// A map that is drawn when there is something new, at most once a frame of the screen.

const ARROWS = {
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
};
const CROSS_STEP = 0.1; // m
const PAN = 0.15; // of the width of the map
const ZOOM = 1.3;
const SCALES = [4, 3000]; // pixels in a metre
const FOLLOWED = 2; // times what the whole map has
const AHEAD_MS = 250; // the robot goes on so long without a word of it; see arena.py
const SMOOTH_MS = 80;
const BUMP_MS = 2500;

// Where the robot is between two messages: it goes on as it did, and what that was wrong by goes
// away little by little.
class Glide {
  take(pose) {
    const now = performance.now();
    const before = this.pose ? this.at(now) : pose;
    this.pose = pose;
    this.since = now;
    this.off = [0, 1, 2].map((axis) => before[axis] - pose[axis]);
    this.off[2] = Math.atan2(Math.sin(this.off[2]), Math.cos(this.off[2]));
    // It was put there.
    if (Math.hypot(this.off[0], this.off[1]) > RADIUS) this.off = [0, 0, 0];
  }

  at(now) {
    const [x, y, yaw, v, w] = this.pose;
    const passed = now - this.since;
    const seconds = Math.min(passed, AHEAD_MS) / 1000;
    const share = Math.exp(-passed / SMOOTH_MS);
    const middle = yaw + (w * seconds) / 2;
    return [
      x + v * seconds * Math.cos(middle) + share * this.off[0],
      y + v * seconds * Math.sin(middle) + share * this.off[1],
      yaw + w * seconds + share * this.off[2], v, w,
    ];
  }

  moves(now) {
    const [, , , v, w] = this.pose;
    const passed = now - this.since;
    return (v !== 0 || w !== 0) ? passed < AHEAD_MS + 5 * SMOOTH_MS : passed < 5 * SMOOTH_MS;
  }
}

// The map with what was seen before, and the part of it that is looked at.
class ArenaMap extends Map2d {
  constructor(canvas, seen) {
    super(canvas);
    this.seen = seen;
    this.above = 34;
    // null for all that there is.
    this.view = null;
    this.following = false;
  }

  show(scene, cursor) {
    if (this.following && scene.pose) {
      this.view ??= { scale: this.scale * FOLLOWED };
      [this.view.x, this.view.y] = scene.pose;
    }
    this.draw(scene, cursor, this.view);
  }

  below() {
    const { context } = this;
    // What nobody has seen is a little darker, or lighter, than the floor.
    context.fillStyle = this.colour('ink');
    context.globalAlpha = 0.05;
    context.fillRect(0, 0, this.width, this.height);
    context.globalAlpha = 1;
    this.seen.draw(this);
  }

  // Nearer by a factor; the place under (px, py) stays there.
  zoom(factor, px = this.width / 2, py = this.middle()) {
    const [x, y] = this.metres(px, py);
    const scale = Math.max(SCALES[0], Math.min(SCALES[1], this.scale * factor));
    this.view = {
      x: x - (px - this.width / 2) / scale, y: y + (py - this.middle()) / scale, scale,
    };
  }

  middle() { return (this.height + this.above) / 2; }

  pan(dx, dy) {
    const [x, y] = this.metres(this.width / 2 - dx, this.middle() - dy);
    this.view = { x, y, scale: this.scale };
    this.following = false;
  }

  fitAll() {
    this.view = null;
    this.following = false;
  }
}

function arenaButtons(map, redraw, el) {
  const make = (text, title, act) => {
    const made = element('button', { type: 'button', textContent: text, title });
    made.setAttribute('aria-label', title);
    made.addEventListener('click', () => {
      act();
      redraw();
    });
    return made;
  };
  const full = make('Full screen', 'Full screen (key o)', () => {
    if (document.fullscreenElement) document.exitFullscreen();
    // With the keys, where they are beside the map.
    else (keysBeside(el) ?? el).requestFullscreen();
  });
  const follow = make('Follow', 'Follow the robot (key f)', () => {
    map.following = !map.following;
  });
  const all = [
    make('+', 'Zoom in (key +)', () => map.zoom(ZOOM)),
    make('−', 'Zoom out (key -)', () => map.zoom(1 / ZOOM)),
    make('Fit', 'Show the whole map (key 0)', () => map.fitAll()),
    follow, full,
  ];
  const place = element('div', { className: 'labkit-arena-buttons' }, ...all);
  place.setAttribute('role', 'group');
  place.setAttribute('aria-label', 'Map');
  return {
    place,
    keys: { '+': all[0], '=': all[0], '-': all[1], 0: all[2], f: follow, o: full },
    show: () => {
      follow.setAttribute('aria-pressed', String(map.following));
      setText(full, document.fullscreenElement ? 'Leave full screen' : 'Full screen');
    },
  };
}

// What holds this map and the keys of the same cell; nothing if there are none.
function keysBeside(el) {
  const area = el.closest('.jp-OutputArea');
  return area?.querySelector('.labkit-teleop') ? area : null;
}

// A cell that was run just now lets what it shows come into view, unless one has gone on.
function comeIntoView(el) {
  const number = (cell) => Number(cell?.dataset.windowedListIndex ?? NaN);
  const cell = el.closest('.jp-Notebook-cell');
  const active = cell?.parentElement.querySelector(':scope > .jp-mod-active');
  if (!(Math.abs(number(active) - number(cell)) <= 1)) return;
  const place = keysBeside(el) ?? el;
  const room = cell.closest('.jp-WindowedPanel-outer') ?? document.documentElement;
  const fits = place.offsetHeight <= room.clientHeight;
  place.scrollIntoView({ block: fits ? 'nearest' : 'start' });
}

// Mouse: drag to move, wheel to zoom. The wheel alone scrolls the page until the map was clicked.
function pointAt(canvas, map, change) {
  let drag = null;
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    drag = [event.offsetX, event.offsetY];
  });
  canvas.addEventListener('pointermove', ({ offsetX, offsetY }) => {
    if (drag) {
      map.pan(offsetX - drag[0], offsetY - drag[1]);
      drag = [offsetX, offsetY];
    }
    change(map.scale ? map.metres(offsetX, offsetY) : null);
  });
  for (const kind of ['pointerup', 'pointercancel', 'lostpointercapture']) {
    canvas.addEventListener(kind, () => { drag = null; });
  }
  canvas.addEventListener('wheel', (event) => {
    if (document.activeElement !== canvas && !event.ctrlKey) return;
    event.preventDefault();
    map.zoom(ZOOM ** (-Math.sign(event.deltaY) / 2), event.offsetX, event.offsetY);
    change(map.metres(event.offsetX, event.offsetY));
  }, { passive: false });
}

function render({ model, el }) {
  el.classList.add('labkit-live', 'labkit-arena');
  const words = element('div', { className: 'labkit-arena-words' });
  words.setAttribute('aria-live', 'polite');
  const canvas = element('canvas', { tabIndex: 0 });
  canvas.setAttribute('role', 'img');
  canvas.setAttribute(
    'aria-label',
    'Map around the robot, told in words below. Arrow keys move it, plus and minus zoom, 0 shows '
    + 'all, f follows the robot. Arrow keys with Shift move a cross, Escape removes it.',
  );
  // Several views may show the same; and JupyterLab makes one anew that was out of sight.
  const seen = model.labkitSeen ??= new Seen();
  const map = new ArenaMap(canvas, seen);
  const glide = new Glide();
  const scene = { ...emptyScene(), fades: true };
  let [cursor, frame, bumpedAt] = [null, 0, 0];

  const redraw = () => {
    frame ||= requestAnimationFrame((now) => {
      frame = 0;
      if (!canvas.clientWidth) return;
      if (scene.pose) scene.pose = glide.at(now);
      map.show(scene, cursor);
      buttons.show();
      // For those who look on from outside, such as tests.
      canvas.dataset.view = map.view
        ? ['x', 'y', 'scale'].map((part) => map.view[part].toFixed(2)).join(' ') : 'all';
      if (scene.pose && glide.moves(now)) redraw();
    });
  };
  const buttons = arenaButtons(map, redraw, el);
  const badge = element('div', { className: 'labkit-arena-bump', textContent: 'Bump', hidden: true });
  const { note, end } = follow(model, el, (news, buffers) => {
    take(scene, news, buffers?.[0]);
    if (news.pose) glide.take(news.pose);
    if (news.eye) seen.take(scene.scan, scene.eye);
    if (news.met) seen.meet(numbers(buffers.at(-1)));
    if (news.text) setText(words, news.text);
    if (news.bump !== undefined) {
      scene.bump = news.bump;
      badge.hidden = !news.bump;
      if (news.bump) {
        bumpedAt = performance.now();
        canvas.dataset.bumps = Number(canvas.dataset.bumps ?? 0) + 1;
      }
    }
    if (performance.now() - bumpedAt > BUMP_MS) badge.hidden = true;
    canvas.dataset.frames = Number(canvas.dataset.frames ?? 0) + 1;
    if (news.pose) canvas.dataset.pose = news.pose.map((value) => value.toFixed(3)).join(' ');
    redraw();
    if (news.fresh) comeIntoView(el);
  });
  el.append(element('div', { className: 'labkit-arena-map' }, canvas, badge, buttons.place),
    words, note);
  pointAt(canvas, map, (place) => {
    cursor = place;
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
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    buttons.keys[event.key]?.click();
    const arrow = ARROWS[event.key];
    if (!arrow) return;
    event.preventDefault();
    const far = PAN * map.width;
    if (!event.shiftKey) map.pan(-far * arrow[0], far * arrow[1]);
    else {
      cursor = [0, 1].map((axis) => (cursor ?? scene.pose ?? [0, 0])[axis]
        + CROSS_STEP * arrow[axis]);
    }
    redraw();
  });
  const repaint = () => {
    seen.repaint();
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
  };
}

export default { render };
