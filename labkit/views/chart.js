// Lines over time on a canvas: one panel for each unit, and a table that tells their numbers.

const FRAME_MS = 50;
const WORDS_MS = 500; // numbers that change more often can't be read
// All lengths are those of a page with letters of so many pixels; with larger ones all is larger.
const LETTERS = 14;
const [LEFT, RIGHT, TOP, BOTTOM, GAP] = [64, 12, 10, 38, 14];
const DASHES = [[], [8, 4], [2, 3], [10, 3, 2, 3], [5, 2], [1, 4]]; // see plot_picture.py
const PANEL = { one: 230, many: 150 };
const [HUGE, TINY] = [Number.MAX_VALUE, 1e-302]; // see plot_picture.py

// Round numbers from low to high, some `most` of them.
function ticks(low, high, most) {
  const rough = Math.min(high - low, HUGE) / most;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((each) => each * power >= rough * 0.999);
  const found = [];
  for (let n = Math.ceil(low / step - 1e-9); n <= Math.floor(high / step + 1e-9); n += 1) {
    found.push(n * step);
  }
  return found;
}

function short(number) {
  const text = number.toPrecision(4);
  // The greatest numbers are infinite when they are rounded up.
  if (Number.isFinite(Number(text))) return `${Number(text)}`;
  return Number.isFinite(number) ? text : '–';
}

function inSeconds(time) {
  return `${time.toFixed(2)} s`;
}

// The last index at which `times` is not above `time`, -1 if there is none.
function indexAt(times, time) {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

// What an axis shows of these lines.
function limits(lines) {
  let [low, high] = [Infinity, -Infinity];
  for (const { values } of lines) {
    for (const value of values) {
      if (value < low && value > -Infinity) low = value;
      if (value > high && value < Infinity) high = value;
    }
  }
  if (low > high) return [0, 1];
  let room = high - low > TINY ? Math.min(high - low, HUGE) * 0.06 : Math.abs(low) / 2;
  if (room <= TINY) room = 0.5;
  return [Math.max(low - room, -HUGE), Math.min(high + room, HUGE)];
}

// Lines between two times, and what they come from and lead to.
function between(lines, begin, end) {
  return lines.map((line) => {
    const [first, last] = [Math.max(0, indexAt(line.times, begin)), indexAt(line.times, end) + 2];
    return { ...line, times: line.times.slice(first, last), values: line.values.slice(first, last) };
  });
}

class Sheet {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
  }

  fit() {
    const ratio = window.devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (this.canvas.width !== Math.round(width * ratio)) {
      this.canvas.width = Math.round(width * ratio);
    }
    if (this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.height = Math.round(height * ratio);
    }
    const style = getComputedStyle(this.canvas);
    const larger = Number.parseFloat(style.fontSize) / LETTERS;
    this.context.setTransform(ratio * larger, 0, 0, ratio * larger, 0, 0);
    [this.width, this.height] = [width / larger, height / larger];
    this.colour = (name) => style.getPropertyValue(`--labkit-${name}`).trim() || '#777';
    this.font = `12px ${style.fontFamily}`;
  }

  // Draw the lines between two times.
  draw(lines, begin, end) {
    this.fit();
    const { context, width, height } = this;
    context.fillStyle = this.colour('ground');
    context.fillRect(0, 0, width, height);
    context.font = this.font;
    this.px = (time) => LEFT + ((width - LEFT - RIGHT) * (time - begin)) / (end - begin);
    const units = [...new Set(lines.map(({ unit }) => unit))];
    const panel = (height - TOP - BOTTOM - GAP * (units.length - 1)) / units.length;
    const times = ticks(begin, end, 8);
    units.forEach((unit, row) => {
      this.panel(lines.filter((line) => line.unit === unit), unit,
        TOP + row * (panel + GAP), panel, times);
    });
    context.fillStyle = this.colour('faint');
    context.textAlign = 'center';
    times.forEach((time) => context.fillText(short(time), this.px(time), height - BOTTOM + 16));
    context.fillText('time [s]', (LEFT + width - RIGHT) / 2, height - 5);
  }

  cursor(time) {
    const { context } = this;
    context.strokeStyle = this.colour('ink');
    context.setLineDash([]);
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(this.px(time), TOP);
    context.lineTo(this.px(time), this.height - BOTTOM);
    context.stroke();
  }

  // Mark what is between two places, from 0 to 1.
  mark(one, other) {
    const width = this.width - LEFT - RIGHT;
    this.context.fillStyle = this.colour('focus');
    this.context.globalAlpha = 0.2;
    this.context.fillRect(LEFT + one * width, TOP, (other - one) * width,
      this.height - TOP - BOTTOM);
    this.context.globalAlpha = 1;
  }

  // Where a pixel of the canvas is between the two times, from 0 to 1.
  partAt(x) {
    const inner = (x * this.width) / this.canvas.clientWidth - LEFT;
    return Math.max(0, Math.min(1, inner / (this.width - LEFT - RIGHT)));
  }

  panel(lines, unit, top, height, times) {
    const { context } = this;
    const right = this.width - RIGHT;
    const [low, high] = limits(lines);
    // Smaller by a power of two, since the difference of great numbers is infinite.
    const span = high / 1024 - low / 1024;
    const py = (value) => top + (height * (high / 1024 - value / 1024)) / span;
    context.lineWidth = 1;
    context.setLineDash([]);
    context.strokeStyle = this.colour('line');
    context.fillStyle = this.colour('faint');
    context.beginPath();
    for (const time of times) {
      context.moveTo(this.px(time), top);
      context.lineTo(this.px(time), top + height);
    }
    context.textAlign = 'right';
    for (const value of ticks(low, high, height / 30)) {
      context.moveTo(LEFT, py(value));
      context.lineTo(right, py(value));
      context.fillText(short(value), LEFT - 6, py(value) + 4);
    }
    context.stroke();
    context.strokeStyle = this.colour('edge');
    context.strokeRect(LEFT, top, right - LEFT, height);
    context.save();
    context.translate(14, top + height / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = 'center';
    context.fillText(unit, 0, 0);
    context.restore();
    context.save();
    context.beginPath();
    context.rect(LEFT, top - 2, right - LEFT, height + 4);
    context.clip();
    lines.forEach((line) => this.line(line, py));
    context.restore();
  }

  line({ times, values, number }, py) {
    const { context } = this;
    context.strokeStyle = context.fillStyle = this.colour(`line-${number}`);
    context.lineWidth = 2;
    context.lineJoin = 'round';
    context.setLineDash(DASHES[number]);
    context.beginPath();
    let drawn = 0;
    values.forEach((value, i) => {
      if (!Number.isFinite(value)) drawn = 0;
      else if (drawn) context.lineTo(this.px(times[i]), py(value));
      else context.moveTo(this.px(times[i]), py(value));
      if (Number.isFinite(value)) drawn += 1;
    });
    context.stroke();
    if (drawn) {
      context.beginPath();
      context.arc(this.px(times.at(-1)), py(values.at(-1)), 3, 0, 2 * Math.PI);
      context.fill();
    }
  }
}

function swatch(number) {
  const box = svgElement('svg', { width: 34, height: 10, 'aria-hidden': 'true' });
  const dashes = DASHES[number].join(' ') || 'none';
  const line = svgElement('path', {
    d: 'M0 5h34', fill: 'none', 'stroke-width': 2, 'stroke-dasharray': dashes,
  });
  line.style.stroke = `var(--labkit-line-${number})`;
  box.append(line);
  return box;
}

// The legend: a table that says in numbers what the lines show.
class Legend {
  constructor() {
    const heads = ['Field', 'Last', 'Least', 'Greatest', 'Unit'].map(
      (text) => element('th', { textContent: text, scope: 'col' }),
    );
    this.last = heads[1];
    this.body = element('tbody');
    this.table = element('table', {},
      element('thead', {}, element('tr', {}, ...heads)), this.body);
  }

  build(lines) {
    this.cells = lines.map(() => [0, 1, 2].map(() => element('td', { textContent: '–' })));
    this.body.replaceChildren(...lines.map(({ label, unit, number }, row) => element('tr', {},
      element('th', { scope: 'row' }, swatch(number), ` ${label}`), ...this.cells[row],
      element('td', { textContent: unit || '–' }))));
  }

  // The last values, or those at the time of a cursor.
  tell(lines, time = null) {
    setText(this.last, time === null ? 'Last' : `At ${inSeconds(time)}`);
    lines.forEach(({ times, values }, row) => {
      const finite = values.filter(Number.isFinite);
      const least = finite.reduce((a, b) => Math.min(a, b), Infinity);
      const greatest = finite.reduce((a, b) => Math.max(a, b), -Infinity);
      // As exact as the greatest of them asks for, so that they can be compared.
      const size = Math.log10(Math.max(Math.abs(least), Math.abs(greatest)) || 1);
      const digits = Math.max(0, 3 - Math.floor(size));
      const last = time === null ? finite.at(-1) : values[indexAt(times, time)];
      [last, least, greatest].forEach((number, column) => {
        // toFixed() takes at most 100 digits, and rounds nothing from 1e21 on.
        const rounds = Number.isFinite(number) && digits <= 100 && size < 21;
        const text = rounds ? `${Number(number.toFixed(digits))}` : short(number ?? NaN);
        setText(this.cells[row][column], text);
      });
    });
  }

  // The first column, as a sentence.
  words() {
    const rows = [...this.body.rows].map(({ cells: [name, value] }) => (
      `${name.textContent.trim()} ${value.textContent}`));
    return `${this.last.textContent}: ${rows.join(', ')}`;
  }
}

// How high the canvas of such lines is, in letters of the page.
function heightOf(lines) {
  const units = new Set(lines.map(({ unit }) => unit)).size;
  const height = units < 2 ? PANEL.one : PANEL.many * units + GAP * (units - 1);
  return (height + TOP + BOTTOM) / LETTERS;
}
