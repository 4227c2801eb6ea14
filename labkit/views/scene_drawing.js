// Shapes on a canvas by WebGL 2: boxes, cylinders, cones, spheres, meshes, points, lines.

const SIDES = 24;
const RINGS = 12;
const ROUND = 2 * Math.PI;
const AXIS = [0.08, 0.004]; // of the axes of a frame: length and width, m
const LETTER_PX = 40; // the letters of axes are there if those are as long
const LIFT = 0.03; // of points and lines, towards the eye, m
const CELLS = 10; // of the grid, to each side
const LIGHT = '0.34, -0.5, 0.8'; // from where it comes; see scene_picture.py
// Renderers of graphics without a graphics card: there each pixel costs time.
const SOFTWARE = /swiftshader|llvmpipe|software|basic render/i;

const SOLID = [`#version 300 es
layout(location = 0) in vec3 corner;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 tint;
uniform mat4 view, model;
uniform vec3 size;
uniform vec4 colour;
uniform float width, pixels, lift;
out vec3 facing;
out vec4 paint;
void main() {
  gl_Position = view * model * vec4(size * corner, 1.0);
  gl_Position.z -= lift / max(gl_Position.w, 0.1);
  gl_PointSize = pixels > 0.0 ? max(1.0, width * pixels / gl_Position.w) : width;
  facing = mat3(model) * (normal / size);
  paint = colour * tint;
}`, `#version 300 es
precision mediump float;
in vec3 facing;
in vec4 paint;
uniform float kind;
out vec4 pixel;
void main() {
  if (kind > 0.5 && distance(gl_PointCoord, vec2(0.5)) > 0.5) discard;
  float turned = kind < -0.5 && !gl_FrontFacing ? -1.0 : 1.0;
  float bright = kind > 0.5 ? 1.0 : 0.62 + 0.38 * turned * dot(normalize(facing), vec3(${LIGHT}));
  pixel = vec4(paint.rgb * bright, paint.a);
}`];

// A line is as wide as it shall be on the screen: two triangles for each piece.
const LINES = [`#version 300 es
layout(location = 0) in vec3 begin;
layout(location = 1) in vec3 end;
layout(location = 2) in vec4 tint;
layout(location = 3) in vec2 side;
uniform mat4 view, model;
uniform vec3 size;
uniform vec4 colour;
uniform vec2 half_screen;
uniform float width, pixels, lift;
out vec4 paint;
void main() {
  vec4 a = view * model * vec4(size * begin, 1.0);
  vec4 b = view * model * vec4(size * end, 1.0);
  float near = 0.001;
  if (a.w < near) a = mix(a, b, (near - a.w) / max(b.w - a.w, 1e-9));
  else if (b.w < near) b = mix(b, a, (near - b.w) / max(a.w - b.w, 1e-9));
  vec2 way = (b.xy / b.w - a.xy / a.w) * half_screen;
  float far = length(way);
  vec2 ahead = far > 0.0 ? way / far : vec2(1.0, 0.0);
  vec4 at = side.x < 0.5 ? a : b;
  float wide = pixels > 0.0 ? max(1.0, width * pixels / at.w) : width;
  at.xy += (vec2(-ahead.y, ahead.x) * side.y + ahead * (side.x - 0.5)) * 0.5 * wide
    / half_screen * at.w;
  at.z -= lift / max(at.w, 0.1);
  gl_Position = at;
  paint = colour * tint;
}`, `#version 300 es
precision mediump float;
in vec4 paint;
out vec4 pixel;
void main() { pixel = paint; }`];

// Corners and normals of shapes in a cube of edges of length 1.
function boxShape() {
  const made = [];
  for (const axis of [0, 1, 2]) {
    for (const sign of [1, -1]) {
      const at = (a, b) => {
        const corner = [0, 0, 0];
        const normal = [0, 0, 0];
        corner[axis] = sign / 2;
        normal[axis] = sign;
        corner[(axis + 1) % 3] = a / 2;
        corner[(axis + 2) % 3] = (sign * b) / 2;
        made.push(...corner, ...normal);
      };
      for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]]) at(a, b);
    }
  }
  return made;
}

function roundShape(top) {
  const made = [];
  for (let i = 0; i < SIDES; i += 1) {
    const [a, b] = [i, i + 1].map((side) => (ROUND * side) / SIDES);
    const at = (angle, up, wide) => [
      0.5 * wide * Math.cos(angle), 0.5 * wide * Math.sin(angle), up / 2];
    const out = (angle) => [Math.cos(angle), Math.sin(angle), top ? 0 : 0.5];
    const put = (...points) => points.forEach(([place, normal]) => made.push(...place, ...normal));
    const low = [[at(a, -1, 1), out(a)], [at(b, -1, 1), out(b)]];
    const high = [[at(a, 1, top), out(a)], [at(b, 1, top), out(b)]];
    put(low[0], low[1], high[1], low[0], high[1], high[0]);
    const down = [0, 0, -1];
    put([at(b, -1, 1), down], [at(a, -1, 1), down], [[0, 0, -0.5], down]);
    const up = [0, 0, 1];
    if (top) put([at(a, 1, 1), up], [at(b, 1, 1), up], [[0, 0, 0.5], up]);
  }
  return made;
}

function sphereShape() {
  const made = [];
  const put = (i, j) => {
    const [down, round] = [(Math.PI * i) / RINGS, (ROUND * j) / SIDES];
    const normal = [
      Math.sin(down) * Math.cos(round), Math.sin(down) * Math.sin(round), Math.cos(down)];
    made.push(...normal.map((value) => value / 2), ...normal);
  };
  for (let i = 0; i < RINGS; i += 1) {
    for (let j = 0; j < SIDES; j += 1) {
      for (const [a, b] of [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]]) put(i + a, j + b);
    }
  }
  return made;
}

// A mesh has a normal for each triangle.
function meshShape(points) {
  const made = new Float32Array(2 * points.length);
  for (let i = 0; i + 8 < points.length; i += 9) {
    const [a, b, c] = [i, i + 3, i + 6].map((at) => points.slice(at, at + 3));
    const normal = across(plus(b, a, -1), plus(c, a, -1));
    const length = Math.hypot(...normal) || 1;
    [a, b, c].forEach((corner, j) => {
      made.set(corner, 2 * i + 6 * j);
      made.set(normal.map((value) => value / length), 2 * i + 6 * j + 3);
    });
  }
  return made;
}

const SHAPES = {
  box: boxShape, cylinder: () => roundShape(1), cone: () => roundShape(0), sphere: sphereShape,
};

class SceneDrawing {
  // Throws where the browser has no WebGL 2.
  constructor(canvas) {
    this.canvas = canvas;
    this.gl = canvas.getContext('webgl2', { antialias: true, alpha: false });
    if (!this.gl) throw new Error('no WebGL 2');
    const { gl } = this;
    const info = gl.getExtension('WEBGL_debug_renderer_info');
    this.renderer = info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : '';
    this.things = new Map();
    this.prepare();
  }

  // Make what lies on the graphics card; again when the card has lost it.
  prepare() {
    const { gl } = this;
    this.solid = this.program(SOLID);
    this.lines = this.program(LINES);
    this.sides = this.buffer(new Float32Array([0, -1, 1, -1, 1, 1, 0, -1, 1, 1, 0, 1]));
    this.units = {};
    for (const [name, make] of Object.entries(SHAPES)) {
      this.units[name] = this.mesh(new Float32Array(make()));
    }
    const grid = [];
    for (let i = -CELLS; i <= CELLS; i += 1) {
      grid.push(i, -CELLS, 0, i, CELLS, 0, -CELLS, i, 0, CELLS, i, 0);
    }
    this.grid = { shape: 'lines', ...this.ends(new Float32Array(grid), true) };
    for (const thing of this.things.values()) this.load(thing);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  }

  program(sources) {
    const { gl } = this;
    const made = gl.createProgram();
    sources.forEach((source, index) => {
      const shader = gl.createShader(index ? gl.FRAGMENT_SHADER : gl.VERTEX_SHADER);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(made, shader);
    });
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS) && !gl.isContextLost()) {
      throw new Error(gl.getProgramInfoLog(made));
    }
    const names = ['view', 'model', 'size', 'colour', 'width', 'pixels', 'kind', 'half_screen',
      'lift'];
    made.at = Object.fromEntries(names.map((name) => [name, gl.getUniformLocation(made, name)]));
    return made;
  }

  buffer(numbers) {
    const { gl } = this;
    const made = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, made);
    gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
    return made;
  }

  // An input of a program: so many numbers of a buffer for each corner, or for each piece.
  input(place, buffer, count, stride, offset, each = 0, isByte = false) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(place);
    const kind = isByte ? gl.UNSIGNED_BYTE : gl.FLOAT;
    gl.vertexAttribPointer(place, count, kind, isByte, stride, offset);
    gl.vertexAttribDivisor(place, each);
  }

  array(fill) {
    const { gl } = this;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const buffers = fill();
    gl.bindVertexArray(null);
    return { array, buffers };
  }

  mesh(corners, colours) {
    const made = this.array(() => {
      const buffers = [this.buffer(corners)];
      this.input(0, buffers[0], 3, 24, 0);
      this.input(1, buffers[0], 3, 24, 12);
      if (colours) {
        buffers.push(this.buffer(colours));
        this.input(2, buffers[1], 4, 4, 0, 0, true);
      }
      return buffers;
    });
    return { ...made, count: corners.length / 6 };
  }

  dots(points, colours) {
    const made = this.array(() => {
      const buffers = [this.buffer(points)];
      this.input(0, buffers[0], 3, 12, 0);
      if (colours) {
        buffers.push(this.buffer(colours));
        this.input(2, buffers[1], 4, 4, 0, 0, true);
      }
      return buffers;
    });
    return { ...made, count: points.length / 3 };
  }

  // Of lines in pairs of ends, or of one through all points.
  ends(points, isPairs, colours) {
    const step = isPairs ? 2 : 1;
    const made = this.array(() => {
      const buffers = [this.buffer(points)];
      this.input(0, buffers[0], 3, 12 * step, 0, 1);
      this.input(1, buffers[0], 3, 12 * step, 12, 1);
      if (colours) {
        buffers.push(this.buffer(colours));
        this.input(2, buffers[1], 4, 4 * step, 0, 1, true);
      }
      this.input(3, this.sides, 2, 8, 0);
      return buffers;
    });
    const count = points.length / 3;
    return { ...made, count: isPairs ? count / 2 : Math.max(0, count - 1) };
  }

  load(thing) {
    const { shape, points, colours } = thing;
    let made = {};
    if (shape === 'mesh') made = this.mesh(meshShape(points), colours);
    else if (shape === 'points') made = this.dots(points, colours);
    else if (points) made = this.ends(points, shape === 'lines', colours);
    Object.assign(thing, made);
  }

  // A thing as the kernel tells it (see scene_things.py), or null if it has gone.
  take(name, told, buffers) {
    const { gl } = this;
    const before = this.things.get(name);
    before?.buffers?.forEach((buffer) => gl.deleteBuffer(buffer));
    if (before?.array) gl.deleteVertexArray(before.array);
    if (!told) {
      this.things.delete(name);
      return;
    }
    const thing = { ...told, at: matrixOf(told.at) };
    if (told.points !== undefined) thing.points = numbersOf(buffers[told.points]);
    if (told.colours !== undefined) thing.colours = numbersOf(buffers[told.colours], Uint8Array);
    this.load(thing);
    this.things.set(name, thing);
  }

  // Where a thing is, or undefined as long as that is not known.
  model({ frame, at }, frames) {
    if (!frame) return at;
    const outer = frames.get(frame);
    return outer && times(outer, at);
  }

  // How many pixels of the screen one of the canvas has.
  get ratio() {
    return SOFTWARE.test(this.renderer) ? 1 : Math.min(2, window.devicePixelRatio || 1);
  }

  draw(camera, frames, { axes, grid, colour }) {
    const { gl, canvas, ratio } = this;
    const { clientWidth: wide, clientHeight: high } = canvas;
    const [width, height] = [Math.round(wide * ratio), Math.round(high * ratio)];
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    const view = camera.look(wide, high, frames);
    gl.viewport(0, 0, width, height);
    gl.clearColor(...colour('space'), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    // What this makes of its depth is that of a place so much nearer, but for where it is seen.
    this.lift = 2 * camera.near * LIFT;
    const pixels = height / 2 / Math.tan(FIELD / 2);
    for (const program of [this.solid, this.lines]) {
      gl.useProgram(program);
      gl.uniformMatrix4fv(program.at.view, false, view);
      gl.uniform2f(program.at.half_screen, width / 2, height / 2);
    }
    const put = (thing, model, paint, alpha) => {
      const isSolid = thing.shape === 'points' || !thing.points;
      this.put(thing, model, [...paint, alpha], pixels, isSolid && thing !== this.grid);
    };
    if (grid) {
      const [x, y] = camera.target.map(Math.round);
      const here = matrixOf([x, y, 0, 0, 0, 0, 1]);
      put({ ...this.grid, size: [1, 1, 1], points: true, width: 1 }, here, colour('grid'), 1);
    }
    const glassy = [];
    for (const thing of this.things.values()) {
      const model = thing.shape !== 'text' && this.model(thing, frames);
      const paint = model && colour(thing.colour);
      if (model && thing.alpha < 1) glassy.push([thing, model, paint]);
      else if (model) put(thing, model, paint, 1);
    }
    if (axes) this.axes(frames, put, colour);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    const away = ([, model]) => Math.hypot(...plus([model[12], model[13], model[14]], camera.eye, -1));
    glassy.sort((one, other) => away(other) - away(one));
    for (const [thing, model, paint] of glassy) put(thing, model, paint, thing.alpha);
    gl.disable(gl.BLEND);
    gl.depthMask(true);
  }

  axes(frames, put, colour) {
    const [length, width] = AXIS;
    for (const frame of frames.values()) {
      ['x', 'y', 'z'].forEach((letter, axis) => {
        const size = [width, width, width];
        size[axis] = length;
        const middle = [0, 0, 0, 0, 0, 0, 1];
        middle[axis] = length / 2;
        const bar = { ...this.units.box, shape: 'box', size };
        put(bar, times(frame, matrixOf(middle)), colour(letter), 1);
      });
    }
  }

  put(thing, model, paint, pixels) {
    const { gl } = this;
    const { shape, size, width = 2, metres = false } = thing;
    const isLine = shape === 'line' || shape === 'lines';
    const program = isLine ? this.lines : this.solid;
    const { array, count } = thing.array ? thing : this.units[shape];
    const { at } = program;
    gl.useProgram(program);
    gl.uniformMatrix4fv(at.model, false, model);
    gl.uniform3fv(at.size, size);
    gl.uniform4fv(at.colour, paint);
    gl.uniform1f(at.width, metres ? width : width * this.ratio);
    gl.uniform1f(at.pixels, metres ? pixels : 0);
    // What is on a wall or on the floor is seen.
    const isMark = shape === 'points' || (isLine && width > 1);
    gl.uniform1f(at.lift, isMark ? this.lift : 0);
    if (!isLine) gl.uniform1f(at.kind, { points: 1, mesh: -1 }[shape] ?? 0);
    gl.bindVertexArray(array);
    // For those without a colour of their own for each corner.
    if (!thing.colours) gl.vertexAttrib4f(2, 1, 1, 1, 1);
    if (isLine) gl.drawArraysInstanced(gl.TRIANGLES, 0, 6, count);
    else gl.drawArrays(shape === 'points' ? gl.POINTS : gl.TRIANGLES, 0, count);
  }

  // What has a name on the screen: its text, its place in the fixed frame, how much it matters.
  *names(frames, axes, pixel) {
    for (const [, thing] of this.things) {
      const model = thing.shape === 'text' && this.model(thing, frames);
      if (model) yield [thing.text, placed(model, [0, 0, 0]), 'text'];
    }
    if (!axes) return;
    for (const [name, frame] of frames) yield [name, placed(frame, [0, 0, 0]), 'frame'];
    const [length] = AXIS;
    if (length / pixel < LETTER_PX) return;
    for (const frame of frames.values()) {
      for (const [axis, letter] of ['x', 'y', 'z'].entries()) {
        const tip = [0, 0, 0];
        tip[axis] = 1.15 * length;
        yield [letter, placed(frame, tip), 'letter'];
      }
    }
  }

  end() {
    this.gl.getExtension('WEBGL_lose_context')?.loseContext();
  }
}
