// A map of the floor on a canvas: robots, their trails, walls and goals.

const STEP = 0.25; // what is shown grows in steps of so many metres
const MARGIN = 0.25;
const LEAST = 1.0;
const SCAN_X = -0.032; // place of its scanner on the heading, m
const SAME_WALL = 8; // see arena_picture.py
const GRID_PX = 60; // lines of the grid are no nearer to each other
const GRIDS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];
// A TurtleBot3 Burger from above, m, its axle at x = 0. For the sources see arena_picture.py.
const RADIUS = 0.105; // of the disc that holds it
const BODY = [-0.102, 0.038, 0.062]; // back, front, half of the width
const WHEEL = [0.033, 0.08, 0.018]; // radius, place beside the middle, width
const LIDAR = 0.035;
const LEAST_PX = 13; // drawn no smaller than this radius
const FADE_MS = 60000; // by then a point of the trail is as pale as it gets
const SHADES = 10;
const [AXIS, AXIS_PX] = [0.25, 40]; // length of the axes of a frame, m, and the least one, pixels
const NAME_PX = 120; // room for the name of a frame
const SEVERAL = 4; // colours of robots that share a map

// Its base is where its frame is on the map: x, y and yaw; undefined if it is the map's own, and
// null if nobody knows.
function emptyRobot(name = '') {
  return { name, pose: null, trail: [], fades: false, scan: null, eye: null, bump: null };
}

function emptyScene(...robots) {
  return { robots, goals: [], shown: [-LEAST, -LEAST, LEAST, LEAST] };
}

// Let [left, bottom, right, top] hold a point; it never shrinks, so that the map does not jump.
function include(shown, x, y) {
  if (!Number.isFinite(x) || !Number.isFinite(y)) return;
  const low = (value) => Math.floor((value - MARGIN) / STEP) * STEP;
  const high = (value) => Math.ceil((value + MARGIN) / STEP) * STEP;
  if (x - MARGIN < shown[0]) shown[0] = low(x);
  if (y - MARGIN < shown[1]) shown[1] = low(y);
  if (x + MARGIN > shown[2]) shown[2] = high(x);
  if (y + MARGIN > shown[3]) shown[3] = high(y);
}

function take(shown, robot, news, scan) {
  if (news.lifted) robot.trail = [];
  if (news.bump !== undefined) robot.bump = news.bump;
  if (news.pose) {
    robot.pose = news.pose;
    include(shown, news.pose[0], news.pose[1]);
  }
  for (let i = 0; i + 1 < (news.trail?.length ?? 0); i += 2) {
    robot.trail.push([news.trail[i], news.trail[i + 1], performance.now()]);
    include(shown, news.trail[i], news.trail[i + 1]);
  }
  if (news.eye) {
    robot.scan = numbersOf(scan);
    robot.eye = news.eye;
    for (let i = 0; i < robot.scan.length; i += 2) {
      include(shown, robot.scan[i], robot.scan[i + 1]);
    }
  }
}

// Call for each beam that meets something: with its end, and with that of the next one if that
// is on the same wall.
function eachEnd(scan, [x, y], call) {
  const count = scan.length / 2;
  const apart = (ax, ay, bx, by) => Math.hypot(ax - bx, ay - by);
  for (let i = 0; i < count; i += 1) {
    const j = (i + 1) % count;
    const [ax, ay, bx, by] = [scan[2 * i], scan[2 * i + 1], scan[2 * j], scan[2 * j + 1]];
    if (!Number.isFinite(ax)) continue; // not a number where a beam met nothing
    const near = Math.min(apart(x, y, ax, ay), apart(x, y, bx, by));
    const same = apart(ax, ay, bx, by) <= (SAME_WALL * 2 * Math.PI * near) / count;
    call(ax, ay, same ? [bx, by] : null);
  }
}

// A pose, or the place of a point, on the map.
function onMap(base, [x, y, yaw = 0, ...more]) {
  if (!base) return [x, y, yaw, ...more];
  const [c, s] = [Math.cos(base[2]), Math.sin(base[2])];
  return [base[0] + c * x - s * y, base[1] + s * x + c * y, yaw + base[2], ...more];
}

class Map2d {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
    this.above = 0; // pixels at the top that something else covers
    this.yaw = 0; // by which what is drawn is turned
  }

  // Fit the floor that is shown into the canvas, or look at one place of it; y goes up.
  fit([left, bottom, right, top], view) {
    const ratio = window.devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (this.canvas.width !== Math.round(width * ratio)) {
      this.canvas.width = Math.round(width * ratio);
    }
    if (this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.height = Math.round(height * ratio);
    }
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.width = width;
    this.height = height;
    const { x, y, scale } = view ?? {
      x: (left + right) / 2, y: (bottom + top) / 2,
      scale: Math.min(width / (right - left), (height - this.above) / (top - bottom)),
    };
    this.scale = scale;
    this.x0 = width / 2 - scale * x;
    this.y0 = (height + this.above) / 2 + scale * y;
    const style = getComputedStyle(this.canvas);
    this.colour = (name) => style.getPropertyValue(`--labkit-${name}`).trim() || '#777';
    this.letters = 0.8 * parseFloat(style.fontSize);
    this.font = `${this.letters}px ${style.fontFamily}`;
  }

  px(x) { return this.x0 + this.scale * x; }
  py(y) { return this.y0 - this.scale * y; }
  metres(px, py) { return [(px - this.x0) / this.scale, (this.y0 - py) / this.scale]; }

  draw(scene, cursor, view = null) {
    this.fit(scene.shown, view);
    const { context } = this;
    context.fillStyle = this.colour('ground');
    context.fillRect(0, 0, this.width, this.height);
    context.font = this.font;
    this.below(scene);
    this.grid();
    const { robots } = scene;
    const each = (act) => robots.forEach((robot, i) => this.turned(robot.base, () => act(robot, i)));
    each(({ pose, scan, eye: seen }) => {
      const eye = pose && (seen ?? this.ahead(pose, SCAN_X));
      if (scan && eye) {
        this.fan(scan, eye);
        this.walls(scan, eye);
      }
    });
    const colour = (index, only) => (robots.length > 1 ? `robot-${index % SEVERAL}` : only);
    each(({ trail, fades }, i) => this.trail(trail, fades, colour(i, 'trail')));
    each(({ name, pose }, i) => {
      if (pose) this.robot(name, pose, colour(i, 'robot-0'));
    });
    // Above the robots, which may stand on one.
    this.turned(robots[0]?.base, () => scene.goals.forEach(([x, y, yaw], index) => {
      this.goal(x, y, scene.goals.length > 1 ? `${index + 1}` : '', yaw);
    }));
    each(({ bump }) => { if (bump) this.bump(...bump); });
    this.axes(scene.axes ?? []);
    this.ruler();
    if (scene.fixed) this.label(scene.fixed, 6, 1.3 * this.letters);
    if (cursor) this.cursor(cursor);
  }

  // Draw in the frame of a robot, see emptyRobot.
  turned(base, draw) {
    if (base === null) return;
    if (!base) {
      draw();
      return;
    }
    const { context } = this;
    context.save();
    context.translate(this.px(base[0]), this.py(base[1]));
    context.rotate(-base[2]);
    context.translate(-this.x0, -this.y0);
    this.yaw = base[2];
    draw();
    this.yaw = 0;
    context.restore();
  }

  // Write upright beside (px, py), however the map is turned.
  write(text, px, py, right, down, around = null) {
    const { context } = this;
    context.save();
    context.translate(px, py);
    context.rotate(this.yaw);
    if (around) {
      context.lineWidth = 3;
      context.strokeStyle = around;
      context.strokeText(text, right, down);
    }
    context.fillText(text, right, down);
    context.restore();
  }

  // The axes of frames, each with its letter: colour alone says nothing. Their names stand below
  // each other.
  axes(every) {
    const { context } = this;
    const length = Math.max(AXIS, AXIS_PX / this.scale);
    const [ground, row] = [this.colour('ground'), 1.3 * this.letters];
    const names = [];
    context.textAlign = 'center';
    for (const [name, [x, y], tips] of every) {
      for (const [letter, [ahead, left]] of Object.entries(tips)) {
        const at = (part) => [x + part * length * ahead, y + part * length * left];
        this.line([[x, y], at(1)], `axis-${letter}`, 3);
        context.fillStyle = this.colour(`axis-${letter}`);
        const [beyondX, beyondY] = at(1.2);
        this.write(letter, this.px(beyondX), this.py(beyondY), 0, 4, ground);
      }
      const place = [this.px(x), this.py(y) + row];
      const near = ([px, py]) => Math.abs(px - place[0]) < NAME_PX && Math.abs(py - place[1]) < row;
      while (names.some(near)) place[1] += row;
      names.push(place);
      context.fillStyle = this.colour('ink');
      this.write(name, ...place, 0, 0, ground);
    }
    context.textAlign = 'start';
  }

  // What lies on the floor, for those that know more of it.
  below() {}

  ahead([x, y, yaw], way) { return [x + way * Math.cos(yaw), y + way * Math.sin(yaw)]; }

  grid() {
    const [left, top] = this.metres(0, 0);
    const [right, bottom] = this.metres(this.width, this.height);
    const step = GRIDS.find((size) => size * this.scale >= GRID_PX)
      ?? 10 ** Math.ceil(Math.log10(GRID_PX / this.scale));
    this.step = step;
    const multiples = (low, high) => {
      const [first, last] = [Math.ceil(low / step), Math.floor(high / step)];
      return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => (first + i) * step);
    };
    const text = (value) => (value === 0 ? '0 m' : `${Number(value.toFixed(1))}`);
    for (const x of multiples(left, right)) {
      this.line([[x, bottom], [x, top]], x === 0 ? 'axis' : 'grid', 1);
      const end = this.px(x) + 3 + this.context.measureText(text(x)).width;
      if (end <= this.width) this.label(text(x), this.px(x) + 3, this.height - 4);
    }
    for (const y of multiples(bottom, top)) {
      this.line([[left, y], [right, y]], y === 0 ? 'axis' : 'grid', 1);
      // The corner at the bottom is that of the labels along x.
      if (this.py(y) < this.height - 1.8 * this.letters) this.label(text(y), 3, this.py(y) - 3);
    }
    this.label('x', this.width - 0.9 * this.letters, this.py(0) - 4);
    this.label('y', this.px(0) - 0.9 * this.letters, this.letters);
  }

  // What the scanner sees at once, from its eye to the ends of its beams.
  fan(scan, eye) {
    const { context } = this;
    const [px, py] = [this.px(eye[0]), this.py(eye[1])];
    context.beginPath();
    context.moveTo(px, py);
    eachEnd(scan, eye, (ax, ay, next) => {
      context.lineTo(this.px(ax), this.py(ay));
      if (next) context.lineTo(this.px(next[0]), this.py(next[1]));
      else context.lineTo(px, py);
    });
    context.closePath();
    context.fillStyle = this.colour('scan');
    context.globalAlpha = 0.12;
    context.fill();
    context.globalAlpha = 1;
  }

  walls(scan, eye) {
    const { context } = this;
    context.strokeStyle = context.fillStyle = this.colour('wall');
    context.lineWidth = 2.5;
    context.lineCap = 'round';
    context.beginPath();
    eachEnd(scan, eye, (ax, ay, next) => {
      const [px, py] = [this.px(ax), this.py(ay)];
      if (next) {
        context.moveTo(px, py);
        context.lineTo(this.px(next[0]), this.py(next[1]));
      } else context.fillRect(px - 1.25, py - 1.25, 2.5, 2.5);
    });
    context.stroke();
    context.lineCap = 'butt';
  }

  // Oldest first. Where it fades, points have times, and what is long ago is pale.
  trail(points, fades, colour) {
    const { context } = this;
    const now = performance.now();
    const shade = ([, , time]) => (
      fades ? Math.round(SHADES * Math.min(1, (now - time) / FADE_MS)) : 0
    );
    let begin = 0;
    for (let i = 1; i < points.length; i += 1) {
      if (i + 1 === points.length || shade(points[i + 1]) !== shade(points[i])) {
        context.globalAlpha = 1 - (0.85 * shade(points[i])) / SHADES;
        this.line(points.slice(begin, i + 1), colour, 2.5);
        begin = i;
      }
    }
    context.globalAlpha = 1;
  }

  // With the direction in which the robot shall look there, if it has one.
  goal(x, y, label, yaw) {
    const { context } = this;
    const [px, py] = [this.px(x), this.py(y)];
    context.strokeStyle = context.fillStyle = this.colour('goal');
    context.lineWidth = 2;
    context.beginPath();
    context.arc(px, py, 8, 0, 2 * Math.PI);
    context.moveTo(px - 12, py);
    context.lineTo(px + 12, py);
    context.moveTo(px, py - 12);
    context.lineTo(px, py + 12);
    if (yaw !== undefined) {
      context.moveTo(px, py);
      context.lineTo(px + 30 * Math.cos(yaw), py - 30 * Math.sin(yaw));
    }
    context.stroke();
    this.write(label, px, py, 12, -8);
  }

  // From above: two wheels, a body with round corners, the scanner on top, and a nose ahead.
  robot(name, [x, y, yaw], colour) {
    const { context } = this;
    const scale = Math.max(this.scale, LEAST_PX / RADIUS);
    const [ink, ground, accent] = ['ink', 'ground', colour].map(this.colour);
    const shape = (fill, line, draw) => {
      context.beginPath();
      draw();
      context.fillStyle = fill;
      context.fill();
      if (!line) return;
      context.lineWidth = line / scale;
      context.strokeStyle = ink;
      context.stroke();
    };
    context.save();
    context.translate(this.px(x), this.py(y));
    context.scale(scale, -scale);
    context.rotate(yaw);
    // The room that it needs: what comes into this disc is a bump.
    context.globalAlpha = 0.18;
    shape(accent, 0, () => context.arc(0, 0, RADIUS, 0, 2 * Math.PI));
    context.globalAlpha = 1;
    const [wheel, beside, wide] = WHEEL;
    for (const side of [beside, -beside]) {
      shape(ink, 0, () => context.roundRect(-wheel, side - wide / 2, 2 * wheel, wide, 0.006));
    }
    const [back, front, half] = BODY;
    shape(ground, 1.8, () => context.roundRect(back, -half, front - back, 2 * half, 0.028));
    shape(accent, 0, () => {
      context.moveTo(0.088, 0);
      context.lineTo(front - 0.004, 0.04);
      context.lineTo(front - 0.004, -0.04);
    });
    shape(ink, 0, () => context.arc(SCAN_X, 0, LIDAR, 0, 2 * Math.PI));
    shape(accent, 0, () => context.arc(SCAN_X, 0, 0.4 * LIDAR, 0, 2 * Math.PI));
    context.restore();
    if (!name) return;
    context.textAlign = 'center';
    context.fillStyle = ink;
    this.write(name, this.px(x), this.py(y), 0, -scale * RADIUS - 5, ground);
    context.textAlign = 'start';
  }

  // A star where it touches something.
  bump(x, y) {
    const { context } = this;
    const [px, py] = [this.px(x), this.py(y)];
    context.beginPath();
    for (let i = 0; i < 16; i += 1) {
      const [angle, radius] = [(i * Math.PI) / 8, i % 2 ? 6 : 13];
      context.lineTo(px + radius * Math.cos(angle), py + radius * Math.sin(angle));
    }
    context.closePath();
    context.fillStyle = this.colour('bump');
    context.fill();
    context.lineWidth = 1.5;
    context.strokeStyle = this.colour('ground');
    context.stroke();
  }

  // A step of the grid.
  ruler() {
    const [right, bottom, wide] = [this.width - 12, this.height - 24, this.scale * this.step];
    const { context } = this;
    context.strokeStyle = this.colour('faint');
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(right - wide, bottom - 4);
    context.lineTo(right - wide, bottom);
    context.lineTo(right, bottom);
    context.lineTo(right, bottom - 4);
    context.stroke();
    const text = `${this.step} m`;
    this.label(text, right - (wide + context.measureText(text).width) / 2, bottom - 5);
  }

  cursor([x, y]) {
    const text = `x = ${x.toFixed(2)} m, y = ${y.toFixed(2)} m`;
    const { context } = this;
    const [px, py] = [this.px(x), this.py(y)];
    context.strokeStyle = this.colour('faint');
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(px - 8, py);
    context.lineTo(px + 8, py);
    context.moveTo(px, py - 8);
    context.lineTo(px, py + 8);
    context.stroke();
    const width = context.measureText(text).width + 10;
    context.fillStyle = this.colour('ground');
    context.fillRect(0, 0, width, 20);
    context.fillStyle = this.colour('ink');
    context.fillText(text, 5, 14);
  }

  line(points, colour, width) {
    const { context } = this;
    context.strokeStyle = this.colour(colour);
    context.lineWidth = width;
    context.lineJoin = 'round';
    context.beginPath();
    points.forEach(([x, y], i) => {
      if (i) context.lineTo(this.px(x), this.py(y));
      else context.moveTo(this.px(x), this.py(y));
    });
    context.stroke();
  }

  label(text, x, y) {
    this.context.fillStyle = this.colour('faint');
    this.context.fillText(text, x, y);
  }
}
