// The occupancy grid: squares of the floor that a scanner has seen free, and those with a wall.
//
// Squares as in the maps of ROS, 0.05 m wide, in tiles. A beam that passes through a square takes
// away from what was met there, so that who has walked on does not stay on the map.

const CELL = 0.05; // m
const SIDE = 64; // squares along a side of a tile
const [HIT, PASS] = [4, -1];
const [SURE, FREE] = [12, -4];
const NEAR_WALL = 1.5 * CELL; // so near to its end a beam may be in the square of a wall

class OccupancyGrid {
  constructor() {
    this.tiles = new Map();
  }

  // The index of the square at (x, y) in its tile, which becomes the one at hand.
  find(x, y) {
    const [column, row] = [Math.round(x / CELL), Math.round(y / CELL)];
    const [i, j] = [Math.floor(column / SIDE), Math.floor(row / SIDE)];
    const key = i * 65536 + j;
    if (this.key !== key) {
      if (!this.tiles.has(key)) {
        this.tiles.set(key, { i, j, squares: new Int8Array(SIDE * SIDE), canvas: null });
      }
      [this.key, this.tile] = [key, this.tiles.get(key)];
    }
    return (row - j * SIDE) * SIDE + column - i * SIDE;
  }

  // Above 0 for what stands there, below for what is free, 0 for what nobody has seen.
  at(x, y) {
    const index = this.find(x, y);
    return this.tile.squares[index];
  }

  mark(x, y, change) {
    const index = this.find(x, y);
    const before = this.tile.squares[index];
    const after = Math.max(FREE, Math.min(SURE, before + change)) || Math.sign(change);
    this.tile.squares[index] = after;
    if (Math.sign(before) !== Math.sign(after)) this.tile.stale = true;
  }

  // Along the way from (x, y) to what a beam has met: free, but for the square where that is.
  pass(x, y, toX, toY) {
    const way = Math.hypot(toX - x, toY - y);
    for (let at = 0; at < way - CELL / 2; at += CELL) {
      const [nextX, nextY] = [x + ((toX - x) * at) / way, y + ((toY - y) * at) / way];
      if (at < way - NEAR_WALL || this.at(nextX, nextY) <= 0) this.mark(nextX, nextY, PASS);
    }
  }

  // Along a wall.
  meetAlong(x, y, toX, toY) {
    const way = Math.hypot(toX - x, toY - y);
    for (let at = 0; at < way; at += CELL) {
      this.mark(x + ((toX - x) * at) / way, y + ((toY - y) * at) / way, HIT);
    }
  }

  take(scan, [x, y]) {
    eachEnd(scan, [x, y], (ax, ay, next) => {
      if (next) this.meetAlong(ax, ay, ...next);
      else this.mark(ax, ay, HIT);
    });
    eachEnd(scan, [x, y], (ax, ay, next) => {
      this.pass(x, y, ax, ay);
      // Far away the next beam may be more than a square away.
      if (next) this.pass(x, y, (ax + next[0]) / 2, (ay + next[1]) / 2);
    });
  }

  // Walls that were met before this page was there: pairs of numbers.
  meet(points) {
    for (let i = 0; i + 1 < points.length; i += 2) this.mark(points[i], points[i + 1], SURE);
  }

  repaint() {
    for (const tile of this.tiles.values()) tile.stale = true;
  }

  paint(tile, floor, wall) {
    tile.canvas ??= element('canvas', { width: SIDE, height: SIDE });
    tile.stale = false;
    const context = tile.canvas.getContext('2d');
    context.clearRect(0, 0, SIDE, SIDE);
    for (let row = 0; row < SIDE; row += 1) {
      for (let begin = 0, column = 1; column <= SIDE; column += 1) {
        const sign = Math.sign(tile.squares[row * SIDE + begin]);
        const same = column < SIDE && Math.sign(tile.squares[row * SIDE + column]) === sign;
        if (same) continue;
        context.fillStyle = sign > 0 ? wall : floor;
        if (sign) context.fillRect(begin, SIDE - 1 - row, column - begin, 1);
        begin = column;
      }
    }
  }

  draw(map) {
    const { context } = map;
    const [floor, wall] = ['ground', 'met'].map(map.colour);
    context.imageSmoothingEnabled = false;
    for (const tile of this.tiles.values()) {
      if (tile.stale) this.paint(tile, floor, wall);
      // At whole pixels, so that no line is left between tiles.
      const edge = (number) => (number * SIDE - 0.5) * CELL;
      const [left, right] = [map.px(edge(tile.i)), map.px(edge(tile.i + 1))].map(Math.round);
      const [top, bottom] = [map.py(edge(tile.j + 1)), map.py(edge(tile.j))].map(Math.round);
      if (map.yaw === 0 && (right < 0 || bottom < 0 || left > map.width || top > map.height)) continue;
      context.drawImage(tile.canvas, left, top, right - left, bottom - top);
    }
  }
}
