// Space for a scene: matrices of 16 numbers, column after column, as WebGL has them; and the camera.

const FIELD = (40 * Math.PI) / 180; // from top to bottom
const [NEAR, FAR] = [0.02, 500]; // m, at a distance of 1 m or more
const HOME = { azimuth: (-125 * Math.PI) / 180, elevation: (38 * Math.PI) / 180 }; // scene_picture.py
const LEAST_DISTANCE = 0.6; // m, from where all is seen; and how much room is around it
const ROOM = 1.02;
const FOLLOWED = 3; // times as near as where all is seen
const STEEPEST = 1.5; // rad
const DISTANCES = [0.1, 300]; // m
const AROUND_STEP = 0.25; // what is shown grows in steps of so many metres

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const plus = (a, b, factor = 1) => [0, 1, 2].map((i) => a[i] + factor * b[i]);
const across = (a, b) => [
  a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0],
];

function times(a, b) {
  const made = new Float32Array(16);
  for (let column = 0; column < 16; column += 4) {
    for (let row = 0; row < 4; row += 1) {
      for (let k = 0; k < 4; k += 1) made[column + row] += a[4 * k + row] * b[column + k];
    }
  }
  return made;
}

// Of where something is, and its turn as a quaternion.
function matrixOf([px, py, pz, x, y, z, w]) {
  return new Float32Array([
    1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0,
    2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0,
    2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0,
    px, py, pz, 1,
  ]);
}

const IDENTITY = matrixOf([0, 0, 0, 0, 0, 0, 1]);

function placed(matrix, [x, y, z]) {
  return [0, 1, 2].map((row) => (
    matrix[row] * x + matrix[4 + row] * y + matrix[8 + row] * z + matrix[12 + row]));
}

// It goes round a place, and looks at it; z is up. Until it is moved it sees all that there is.
class Camera {
  constructor() {
    this.around = null;
    this.home();
    this.followed = undefined; // until the kernel says what to follow
  }

  home() {
    Object.assign(this, HOME, { target: [0, 0, 0], distance: 3, followed: '', isMoved: false });
  }

  // What has to be seen: it never shrinks, and grows in steps, so that the camera is at rest.
  include([x, y, z]) {
    const low = [x, y, z].map((value) => Math.floor(value / AROUND_STEP) * AROUND_STEP);
    const high = [x, y, z].map((value) => Math.ceil(value / AROUND_STEP) * AROUND_STEP);
    this.around ??= { low, high };
    this.around = {
      low: this.around.low.map((value, i) => Math.min(value, low[i])),
      high: this.around.high.map((value, i) => Math.max(value, high[i])),
    };
  }

  look(width, height, frames) {
    const level = Math.cos(this.elevation);
    const ahead = [
      -level * Math.cos(this.azimuth), -level * Math.sin(this.azimuth), -Math.sin(this.elevation),
    ];
    const right = [-Math.sin(this.azimuth), Math.cos(this.azimuth), 0];
    const up = across(right, ahead);
    if (!this.isMoved && this.around) this.fit(right, up, ahead, width / height);
    const followed = frames.get(this.followed);
    if (followed) {
      this.target = placed(followed, [0, 0, 0]);
      // Nearer, unless it was chosen how near.
      if (!this.isMoved && this.around) this.distance /= FOLLOWED;
    }
    const eye = plus(this.target, ahead, -this.distance);
    
    const f = 1 / Math.tan(FIELD / 2);
    const scale = Math.min(1, this.distance);
    const [near, far] = [NEAR * scale, Math.max(FAR * scale, 3 * this.distance)];
    Object.assign(this, { width, height, right, up, eye, near });
    const lens = [
      (f * height) / width, 0, 0, 0, 0, f, 0, 0,
      0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0,
    ];
    const turned = [
      right[0], up[0], -ahead[0], 0, right[1], up[1], -ahead[1], 0,
      right[2], up[2], -ahead[2], 0, -dot(right, eye), -dot(up, eye), dot(ahead, eye), 1,
    ];
    this.view = times(lens, turned);
    return this.view;
  }

  // As near as all can be seen.
  fit(right, up, ahead, wide) {
    const { low, high } = this.around;
    this.target = plus(low, high).map((value) => value / 2);
    const slope = Math.tan(FIELD / 2);
    this.distance = LEAST_DISTANCE;
    for (let i = 0; i < 8; i += 1) {
      const corner = [0, 1, 2].map((axis) => [low, high][(i >> axis) & 1][axis]);
      const off = plus(corner, this.target, -1);
      const far = Math.max(Math.abs(dot(off, right)) / wide, Math.abs(dot(off, up))) / slope;
      this.distance = Math.max(this.distance, ROOM * far - dot(off, ahead));
    }
  }

  // Where a place is on the screen, px, and how far away, m; null if it is behind.
  onScreen([x, y, z]) {
    const at = (row) => (
      this.view[row] * x + this.view[4 + row] * y + this.view[8 + row] * z + this.view[12 + row]);
    const away = at(3);
    if (away < NEAR) return null;
    return [
      ((at(0) / away + 1) * this.width) / 2, ((1 - at(1) / away) * this.height) / 2, away,
    ];
  }

  // How long a pixel is in the middle, m.
  get pixel() { return (2 * this.distance * Math.tan(FIELD / 2)) / (this.height || 1); }

  turn(right, up) {
    this.isMoved = true;
    this.azimuth -= right;
    this.elevation = Math.max(-STEEPEST, Math.min(STEEPEST, this.elevation + up));
  }

  // So many pixels to the right and up.
  pan(right, up) {
    this.isMoved = true;
    this.followed = '';
    this.target = plus(this.target, this.right, -right * this.pixel);
    this.target = plus(this.target, this.up, -up * this.pixel);
  }

  zoom(factor) {
    this.isMoved = true;
    const [least, most] = DISTANCES;
    this.distance = Math.max(least, Math.min(most, this.distance / factor));
  }

  fromAbove() {
    this.isMoved = true;
    this.elevation = STEEPEST;
    this.azimuth = -Math.PI / 2;
  }
}
