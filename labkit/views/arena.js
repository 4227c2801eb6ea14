// A map that is drawn when there is something new, at most once a frame of the screen.

const ARROWS = {
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
};
const CROSS_STEP = 0.1; // m
const PAN = 0.15; // of the width of the map
const ZOOM = 1.3;
const SCALES = [4, 3000]; // pixels in a metre
const FOLLOWED = 2; // times what the whole map has
const AHEAD_MS = 250; // the robot goes on so long without a word of it; see arena_robot.py
const SMOOTH_MS = 80;
const BUMP_MS = 2500;
const DRAG_PX = 8; // less was a click

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

// The other way than onMap.
function fromMap(base, [x, y, yaw]) {
  if (!base) return [x, y, yaw];
  const [c, s] = [Math.cos(base[2]), Math.sin(base[2])];
  const [right, up] = [x - base[0], y - base[1]];
  return [c * right + s * up, c * up - s * right, yaw - base[2]];
}

// The map with what was seen before, and the part of it that is looked at.
class ArenaMap extends Map2d {
  constructor(canvas, occupancy) {
    super(canvas);
    this.occupancy = occupancy;
    this.above = 34;
    // null for all that there is.
    this.view = null;
    // The robot that is followed.
    this.followed = null;
    // Whether the next click is a goal.
    this.aims = false;
  }

  show(scene, cursor) {
    if (this.followed) {
      this.view ??= { scale: this.scale * FOLLOWED };
      [this.view.x, this.view.y] = onMap(this.followed.base, this.followed.pose);
    }
    this.draw({ ...scene, shown: this.shown(scene) }, cursor, this.view);
  }

  // What has to be seen, where another frame than theirs stands still. It never shrinks either.
  shown({ robots, shown }) {
    const [left, bottom, right, top] = shown;
    const base = robots[0]?.base;
    if (!base) return shown;
    this.around ??= emptyScene().shown;
    for (const corner of [[left, bottom], [left, top], [right, bottom], [right, top]]) {
      const [x, y] = onMap(base, corner);
      include(this.around, x, y);
    }
    return this.around;
  }

  below({ robots }) {
    const { context } = this;
    // What nobody has seen is a little darker, or lighter, than the floor.
    context.fillStyle = this.colour('ink');
    context.globalAlpha = 0.05;
    context.fillRect(0, 0, this.width, this.height);
    context.globalAlpha = 1;
    this.turned(robots[0]?.base, () => this.occupancy.draw(this));
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
    this.followed = null;
  }

  fitAll() {
    this.view = null;
    this.followed = null;
  }
}

function arenaButtons(map, robots, redraw, el, send) {
  const make = overButton(redraw);
  const full = fullScreenButton(make, el);
  // One robot after the other, then none.
  const follow = make('Follow', 'Follow the robot (key f)', () => {
    map.followed = robots[robots.indexOf(map.followed) + 1] ?? null;
  });
  const goal = make('Goal', 'Click where it shall go, drag to where it shall look (key g)', () => {
    map.aims = !map.aims;
    // A publisher is made now: those who listen find it before there is a goal.
    if (map.aims) send({ aim: true });
  });
  const dock = dockButton(make, send);
  const all = [
    make('+', 'Zoom in (key +)', () => map.zoom(ZOOM)),
    make('−', 'Zoom out (key -)', () => map.zoom(1 / ZOOM)),
    make('Fit', 'Show the whole map (key 0)', () => map.fitAll()),
    follow, goal, dock, full,
  ];
  return {
    place: buttonsOver('Map', all),
    keys: {
      '+': all[0], '=': all[0], '-': all[1], 0: all[2], f: follow, g: goal, k: dock, o: full,
    },
    show: () => {
      showOver(dock, full, el);
      goal.setAttribute('aria-pressed', String(map.aims));
      follow.setAttribute('aria-pressed', String(map.followed !== null));
      setText(follow, map.followed?.name ? `Follow ${map.followed.name}` : 'Follow');
    },
  };
}

// Mouse: drag to move, wheel to zoom. The wheel alone scrolls the page until the map was clicked.
// A goal is where the mouse is pressed, and looks to where it is let go.
function pointAt(canvas, map, change, setGoal) {
  let drag = null;
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    drag = [event.offsetX, event.offsetY];
  });
  canvas.addEventListener('pointerup', ({ offsetX, offsetY }) => {
    if (!map.aims || !drag) return;
    const [right, down] = [offsetX - drag[0], offsetY - drag[1]];
    setGoal(map.metres(...drag), Math.hypot(right, down) > DRAG_PX ? Math.atan2(-down, right) : 0);
  });
  canvas.addEventListener('pointermove', ({ offsetX, offsetY }) => {
    if (drag && !map.aims) {
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
    + 'all, f follows the robot. Arrow keys with Shift move a cross, Escape removes it. After g, '
    + 'Enter sets a goal at the cross.',
  );
  // Several views may show the same; and JupyterLab makes one anew that was out of sight.
  const occupancy = model.labkitOccupancy ??= new OccupancyGrid();
  const map = new ArenaMap(canvas, occupancy);
  const scene = emptyScene();
  const { robots } = scene;
  // Where the frame of each one's odometry is on the map.
  const bases = {};
  // Each joins when it has told where it is.
  const robotNamed = (name) => {
    const known = robots.find((robot) => robot.name === name);
    if (known) return known;
    const made = { ...emptyRobot(name), fades: true, glide: new Glide() };
    robots.push(made);
    robots.sort((one, other) => (one.name < other.name ? -1 : 1));
    return made;
  };
  const badge = element('div', { className: 'labkit-arena-bump', textContent: 'Bump', hidden: true });
  const takeRobot = (name, news, buffers) => {
    if (news.gone) {
      const gone = robots.findIndex((robot) => robot.name === name);
      if (map.followed === robots[gone]) map.followed = null;
      if (gone >= 0) robots.splice(gone, 1);
      return;
    }
    const robot = robotNamed(name);
    take(scene.shown, robot, news, news.eye ? buffers.shift() : null);
    if (news.pose) robot.glide.take(news.pose);
    // In another frame, robots have no floor in common.
    const walls = !scene.fixed || robot === robots[0];
    if (news.eye && walls) occupancy.take(robot.scan, robot.eye);
    const met = news.met ? numbersOf(buffers.shift()) : [];
    if (walls) occupancy.meet(met);
    if (news.bump) {
      bumpedAt = performance.now();
      canvas.dataset.bumps = Number(canvas.dataset.bumps ?? 0) + 1;
    }
  };
  let [cursor, frame, bumpedAt] = [null, 0, 0];

  const redraw = () => {
    frame ||= requestAnimationFrame((now) => {
      frame = 0;
      if (!canvas.clientWidth) return;
      // What tf2 turns stays where tf2 has it.
      const glides = !scene.axes;
      for (const robot of robots) robot.pose = glides ? robot.glide.at(now) : robot.glide.pose;
      map.show(scene, cursor);
      buttons.show();
      canvas.style.cursor = map.aims ? 'crosshair' : '';
      // For those who look on from outside, such as tests.
      canvas.dataset.view = map.view
        ? ['x', 'y', 'scale'].map((part) => map.view[part].toFixed(2)).join(' ') : 'all';
      if (glides && robots.some(({ glide }) => glide.moves(now))) redraw();
    });
  };
  const buttons = arenaButtons(map, robots, redraw, el, (content) => send(content));
  const { note, send, end } = follow(model, el, (news, buffers) => {
    if (news.goals) {
      scene.goals = news.goals;
      for (const [x, y] of scene.goals) include(scene.shown, x, y);
    }
    const parts = [...buffers ?? []];
    for (const [name, told] of Object.entries(news.robots ?? {})) takeRobot(name, told, parts);
    scene.fixed = news.fixed ?? scene.fixed;
    scene.axes = news.axes ?? scene.axes;
    Object.assign(bases, news.bases);
    for (const robot of robots) robot.base = bases[robot.name];
    if (news.text) setText(words, news.text);
    badge.hidden = !robots.some(({ bump }) => bump);
    if (performance.now() - bumpedAt > BUMP_MS) badge.hidden = true;
    canvas.dataset.frames = Number(canvas.dataset.frames ?? 0) + 1;
    if (news.robots) {
      canvas.dataset.pose = robots.map(
        ({ glide }) => glide.pose.map((value) => value.toFixed(3)).join(' '),
      ).join(', ');
    }
    redraw();
    if (news.fresh) comeIntoView(el);
  });
  el.append(element('div', { className: 'labkit-arena-map' }, canvas, badge, buttons.place),
    words, note);
  const setGoal = (place, turn) => {
    map.aims = false;
    send({ goal: fromMap(robots[0]?.base, [...place, turn]) });
    redraw();
  };
  pointAt(canvas, map, (place) => {
    cursor = place;
    redraw();
  }, setGoal);
  const noCursor = () => {
    cursor = null;
    redraw();
  };
  canvas.addEventListener('pointerleave', noCursor);
  canvas.addEventListener('blur', noCursor);
  canvas.addEventListener('keydown', (event) => {
    if (event.key === 'Escape') {
      map.aims = false;
      noCursor();
    }
    if (event.key === 'Enter' && map.aims && cursor) setGoal(cursor, 0);
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    buttons.keys[event.key]?.click();
    const arrow = ARROWS[event.key];
    if (!arrow) return;
    event.preventDefault();
    const far = PAN * map.width;
    if (!event.shiftKey) map.pan(-far * arrow[0], far * arrow[1]);
    else {
      const at = robots[0]?.pose && onMap(robots[0].base, robots[0].pose);
      cursor = [0, 1].map((axis) => (cursor ?? at ?? [0, 0])[axis]
        + CROSS_STEP * arrow[axis]);
    }
    redraw();
  });
  const repaint = () => {
    occupancy.repaint();
    redraw();
  };
  const sizes = new ResizeObserver(redraw);
  sizes.observe(canvas);
  const themes = new MutationObserver(repaint);
  themes.observe(document.body, { attributes: true });
  const onFullScreen = () => {
    // The room fills it.
    if (document.fullscreenElement?.contains(el) && !map.followed) map.fitAll();
    redraw();
  };
  document.addEventListener('fullscreenchange', onFullScreen);

  return () => {
    sizes.disconnect();
    themes.disconnect();
    document.removeEventListener('fullscreenchange', onFullScreen);
    cancelAnimationFrame(frame);
    end();
  };
}

export default { render };
