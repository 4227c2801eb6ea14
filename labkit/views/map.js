// A map of the floor on a canvas: a robot, its trail, walls and goals.

const STEP = 0.25; // what is shown grows in steps of so many metres
const MARGIN = 0.25;
const LEAST = 1.0;
const RADIUS = 0.105; // of a TurtleBot3 Burger, m
const SCAN_X = -0.032; // place of its scanner on the heading, m
const SAME_WALL = 8; // see arena_picture.py

function emptyScene() {
  return {
    pose: null, trail: [], scan: null, goals: [],
    shown: [-LEAST, -LEAST, LEAST, LEAST],
  };
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

function take(scene, news, scan) {
  if (news.lifted) scene.trail = [];
  if (news.goals) {
    scene.goals = news.goals;
    for (const [x, y] of scene.goals) include(scene.shown, x, y);
  }
  if (news.pose) {
    scene.pose = news.pose;
    include(scene.shown, news.pose[0], news.pose[1]);
  }
  for (let i = 0; i + 1 < (news.trail?.length ?? 0); i += 2) {
    scene.trail.push([news.trail[i], news.trail[i + 1]]);
    include(scene.shown, news.trail[i], news.trail[i + 1]);
  }
  if (scan) {
    // A copy: the bytes may lie anywhere in the message, numbers only at multiples of four.
    const bytes = scan.buffer.slice(scan.byteOffset, scan.byteOffset + scan.byteLength);
    scene.scan = new Float32Array(bytes);
    for (let i = 0; i < scene.scan.length; i += 2) {
      include(scene.shown, scene.scan[i], scene.scan[i + 1]);
    }
  }
}

class Map2d {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
  }

  // Fit the floor that is shown into the canvas; y goes up.
  fit([left, bottom, right, top]) {
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
    this.scale = Math.min(width / (right - left), height / (top - bottom));
    this.x0 = width / 2 - (this.scale * (left + right)) / 2;
    this.y0 = height / 2 + (this.scale * (bottom + top)) / 2;
    const style = getComputedStyle(this.canvas);
    this.colour = (name) => style.getPropertyValue(`--labkit-${name}`).trim() || '#777';
    this.font = `11px ${style.fontFamily}`;
  }

  px(x) { return this.x0 + this.scale * x; }
  py(y) { return this.y0 - this.scale * y; }
  metres(px, py) { return [(px - this.x0) / this.scale, (this.y0 - py) / this.scale]; }

  draw(scene, cursor) {
    this.fit(scene.shown);
    const { context } = this;
    context.fillStyle = this.colour('ground');
    context.fillRect(0, 0, this.width, this.height);
    context.font = this.font;
    this.grid();
    if (scene.scan && scene.pose) this.walls(scene.scan, scene.pose);
    this.trail(scene.trail);
    if (scene.pose) this.robot(...scene.pose);
    // Above the robot, which may stand on one.
    scene.goals.forEach(([x, y], index) => {
      this.goal(x, y, scene.goals.length > 1 ? `${index + 1}` : '');
    });
    this.ruler();
    if (cursor) this.cursor(cursor);
  }

  grid() {
    const [left, top] = this.metres(0, 0);
    const [right, bottom] = this.metres(this.width, this.height);
    const step = right - left > 20 ? 5 : 1;
    const first = (value) => Math.ceil(value / step) * step;
    for (let x = first(left); x <= right; x += step) {
      this.line([[x, bottom], [x, top]], x === 0 ? 'axis' : 'grid', 1);
      this.label(x === 0 ? '0 m' : `${x}`, this.px(x) + 3, this.height - 4);
    }
    for (let y = first(bottom); y <= top; y += step) {
      this.line([[left, y], [right, y]], y === 0 ? 'axis' : 'grid', 1);
      // The corner at the bottom is that of the labels along x.
      if (this.py(y) < this.height - 20) this.label(y === 0 ? '0 m' : `${y}`, 3, this.py(y) - 3);
    }
    this.label('x', this.width - 10, this.py(0) - 4);
    this.label('y', this.px(0) - 10, 11);
  }

  walls(scan, [x, y, yaw]) {
    const { context } = this;
    const count = scan.length / 2;
    const eye = [x + SCAN_X * Math.cos(yaw), y + SCAN_X * Math.sin(yaw)];
    const apart = (ax, ay, bx, by) => Math.hypot(ax - bx, ay - by);
    context.strokeStyle = context.fillStyle = this.colour('wall');
    context.lineWidth = 2.5;
    context.beginPath();
    for (let i = 0; i < count; i += 1) {
      const j = (i + 1) % count;
      const [ax, ay, bx, by] = [scan[2 * i], scan[2 * i + 1], scan[2 * j], scan[2 * j + 1]];
      const near = Math.min(apart(...eye, ax, ay), apart(...eye, bx, by));
      // False for NaN, the end of a beam that met nothing.
      if (apart(ax, ay, bx, by) <= (SAME_WALL * 2 * Math.PI * near) / count) {
        context.moveTo(this.px(ax), this.py(ay));
        context.lineTo(this.px(bx), this.py(by));
      }
      context.fillRect(this.px(ax) - 1.5, this.py(ay) - 1.5, 3, 3);
    }
    context.stroke();
  }

  trail(points) {
    if (points.length > 1) this.line(points, 'trail', 2.5);
  }

  goal(x, y, label) {
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
    context.stroke();
    context.fillText(label, px + 12, py - 8);
  }

  robot(x, y, yaw) {
    const { context } = this;
    const radius = Math.max(RADIUS * this.scale, 7);
    const corner = (turn, part) => [
      this.px(x) + part * radius * Math.cos(yaw + turn),
      this.py(y) - part * radius * Math.sin(yaw + turn),
    ];
    context.beginPath();
    context.arc(this.px(x), this.py(y), radius, 0, 2 * Math.PI);
    context.fillStyle = this.colour('ground');
    context.fill();
    context.lineWidth = 2.5;
    context.strokeStyle = this.colour('robot');
    context.stroke();
    context.beginPath();
    context.moveTo(...corner(0, 1));
    context.lineTo(...corner(2.4, 0.75));
    context.lineTo(this.px(x), this.py(y));
    context.lineTo(...corner(-2.4, 0.75));
    context.closePath();
    context.fillStyle = this.colour('ink');
    context.fill();
  }

  ruler() {
    const [right, bottom] = [this.width - 12, this.height - 24];
    const { context } = this;
    context.strokeStyle = this.colour('faint');
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(right - this.scale, bottom - 4);
    context.lineTo(right - this.scale, bottom);
    context.lineTo(right, bottom);
    context.lineTo(right, bottom - 4);
    context.stroke();
    this.label('1 m', right - this.scale / 2 - 9, bottom - 5);
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
    context.fillRect(this.width - width, 0, width, 18);
    context.fillStyle = this.colour('ink');
    context.fillText(text, this.width - width + 5, 13);
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
