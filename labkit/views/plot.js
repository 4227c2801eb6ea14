// A plot that follows: the latest time is at the right.

const ROOM = 0.2; // so much of the width may be empty, at the right
const LEAST_DRAG = 0.01; // a pointer that moves less, as a part of the width, was to click

// The lines, as they come from the kernel.
class Lines {
  constructor() {
    [this.lines, this.seconds, this.ahead, this.latest] = [[], 10, null, 0];
  }

  get now() {
    return this.ahead === null ? 0 : performance.now() / 1000 + this.ahead;
  }

  // The right edge. It does not run away from what came last: where nothing comes any more, most
  // of the last window stays.
  get end() {
    return Math.max(Math.min(this.now, this.latest + this.seconds * ROOM), this.seconds);
  }

  take(news, buffers) {
    if (news.seconds) this.seconds = news.seconds;
    if (news.now !== undefined) {
      // How far the kernel's clock is ahead; evened out, because messages are late now and then.
      const ahead = news.now - performance.now() / 1000;
      this.ahead = this.ahead === null || news.anew ? ahead : 0.9 * this.ahead + 0.1 * ahead;
    }
    if (news.series) {
      this.lines = news.series.map(([label, unit], number) => ({
        label, unit, number, times: [], values: [], ...this.kept(number, news.anew),
      }));
    }
    news.parts?.forEach((number, index) => this.add(this.lines[number], buffers[index]));
    for (const line of this.lines) {
      const first = line.times.findIndex((time) => time > this.end - this.seconds);
      // One before the window, so that its line begins at the edge.
      const old = first < 0 ? line.times.length - 1 : first - 1;
      if (old > 0) {
        line.times.splice(0, old);
        line.values.splice(0, old);
      }
    }
  }

  kept(number, anew) {
    const { times, values } = (anew ? null : this.lines[number]) ?? {};
    return times ? { times, values } : {};
  }

  add(line, data) {
    // A copy: the bytes may lie anywhere in the message, numbers only at multiples of eight.
    const bytes = data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength);
    const numbers = new Float64Array(bytes);
    const [times, values] = [0, 1].map((half) => [
      ...numbers.subarray((half * numbers.length) / 2, ((half + 1) * numbers.length) / 2),
    ]);
    line.times.push(...times);
    line.values.push(...values);
    const last = values.findLastIndex(Number.isFinite);
    if (last >= 0) this.latest = Math.max(this.latest, times[last]);
  }

  // A copy that stays as it is, for a pause.
  frozen() {
    const { end } = this;
    return [this.lines.map((line) => ({
      ...line, times: [...line.times], values: [...line.values],
    })), end - this.seconds, end];
  }
}

// The numbers that are drawn, a row for each time.
function asCsv(lines) {
  const samples = lines.flatMap(({ times, values }, column) => (
    times.map((time, index) => ({ time, column, value: values[index] }))));
  const rows = [];
  for (const { time, column, value } of samples.sort((one, other) => one.time - other.time)) {
    if (!Number.isFinite(value)) continue;
    // Two of one field and one time are the least and the greatest of many.
    if (rows.at(-1)?.[0] !== time || rows.at(-1)[column + 1] !== '') {
      rows.push([time, ...lines.map(() => '')]);
    }
    rows.at(-1)[column + 1] = value;
  }
  const names = lines.map(({ label, unit }) => (unit ? `${label} [${unit}]` : label));
  const head = ['time [s]', ...names].map((name) => `"${name.replaceAll('"', '""')}"`);
  return [head, ...rows].map((row) => `${row.join(',')}\r\n`).join('');
}

function save(text, name) {
  const address = URL.createObjectURL(new Blob([text], { type: 'text/csv' }));
  element('a', { href: address, download: name }).click();
  URL.revokeObjectURL(address);
}

function render({ model, el }) {
  el.classList.add('labkit-live', 'labkit-plot');
  el.setAttribute('role', 'group');
  const canvas = element('canvas', { title: 'Drag sideways to zoom in' });
  canvas.setAttribute('role', 'img');
  const [pause, zoomIn, zoomOut, csv] = ['Pause', 'Zoom in', 'Zoom out', 'Save as CSV'].map(
    (textContent, index) => element('button', { type: 'button', textContent, hidden: index > 0 }),
  );
  csv.title = 'The numbers as they are drawn: of many at once, the least and the greatest';
  const slider = element('input', { type: 'range', min: 0, max: 1, step: 0.005, hidden: true });
  slider.setAttribute('aria-label', 'Time of the cursor');
  const data = new Lines();
  const legend = new Legend();
  const sheet = new Sheet(canvas);
  // `paused` is what was there when it was paused, `span` the times that are shown of it. `at` and
  // `from`, where the pointer is and was pressed, lie between the edges, from 0 to 1; or are null.
  let [paused, span, at, from, frame, drawnAt, toldAt] = [null, null, null, null, 0, 0, 0];
  let shown = [];

  const draw = (moment) => {
    frame = requestAnimationFrame(draw);
    if (moment - drawnAt < FRAME_MS || !data.lines.length || !canvas.clientWidth) return;
    drawnAt = moment;
    const [begin, end] = span ?? [data.end - data.seconds, data.end];
    const lines = paused ? shown : data.lines;
    const time = at === null ? null : begin + at * (end - begin);
    sheet.draw(lines, begin, end);
    if (time !== null) sheet.cursor(time);
    if (time !== null && from !== null) sheet.mark(from, at);
    if (moment - toldAt > WORDS_MS) {
      toldAt = moment;
      legend.tell(lines, time);
      if (paused) slider.setAttribute('aria-valuetext', legend.words());
    }
    // For those who look on from outside, such as tests.
    canvas.dataset.frames = Number(canvas.dataset.frames ?? 0) + 1;
  };
  const point = (part) => {
    [at, toldAt] = [part, 0];
    if (part !== null) slider.value = part;
  };
  const show = (begin, end) => {
    const [lines, first, last] = paused;
    span = [Math.max(first, begin), Math.min(last, end)];
    shown = between(lines, ...span);
    zoomOut.disabled = span[0] === first && span[1] === last;
    toldAt = 0;
  };
  const setPaused = (wanted) => {
    paused = wanted ? data.frozen() : null;
    if (paused) show(paused[1], paused[2]);
    else span = null;
    for (const each of [slider, zoomIn, zoomOut, csv]) each.hidden = !paused;
    pause.textContent = paused ? 'Resume' : 'Pause';
    el.classList.toggle('labkit-plot-paused', paused !== null);
  };
  // Zoom by a factor. What the cursor is at stays where it is.
  const zoom = (factor) => {
    const part = at ?? 1;
    const [begin, end] = span;
    const length = Math.min((end - begin) * factor, paused[2] - paused[1]);
    const time = begin + part * (end - begin);
    const first = Math.max(paused[1], Math.min(paused[2] - length, time - part * length));
    show(first, first + length);
  };
  const stopDrag = () => {
    from = null;
  };
  canvas.addEventListener('pointerdown', (event) => {
    if (event.button !== 0) return;
    from = sheet.partAt(event.offsetX);
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener('pointermove', (event) => {
    point(sheet.partAt(event.offsetX));
    // What is marked must not run away.
    if (from !== null && !paused && Math.abs(at - from) > LEAST_DRAG) setPaused(true);
  });
  canvas.addEventListener('pointerup', () => {
    if (from === null) return;
    const [low, high] = [Math.min(from, at), Math.max(from, at)];
    stopDrag();
    if (!paused || high - low <= LEAST_DRAG) return;
    const [begin, end] = span;
    show(begin + low * (end - begin), begin + high * (end - begin));
  });
  canvas.addEventListener('pointercancel', stopDrag);
  canvas.addEventListener('pointerleave', () => {
    if (!paused) point(null);
  });
  slider.addEventListener('input', () => point(Number(slider.value)));
  pause.addEventListener('click', () => {
    setPaused(!paused);
    point(paused ? 1 : null);
  });
  zoomIn.addEventListener('click', () => zoom(0.5));
  zoomOut.addEventListener('click', () => zoom(2));
  csv.addEventListener('click', () => save(asCsv(shown), 'plot.csv'));
  const { note, end } = follow(model, el, (news, buffers) => {
    data.take(news, buffers);
    if (!news.series) return;
    legend.build(data.lines);
    const names = data.lines.map(({ label, unit }) => (unit ? `${label} in ${unit}` : label));
    el.setAttribute('aria-label', `Plot of ${names.join(', ')}`);
    canvas.setAttribute('aria-label',
      `Lines over the last ${data.seconds} s: ${names.join(', ')}. The table has the numbers.`);
    canvas.style.height = `${heightOf(data.lines)}em`;
  });
  const buttons = element('div', { className: 'labkit-plot-buttons' }, pause, zoomIn, zoomOut, csv);
  el.append(element('div', { className: 'labkit-live-header' }, legend.table, buttons), note,
    canvas, slider);
  frame = requestAnimationFrame(draw);
  return () => {
    cancelAnimationFrame(frame);
    end();
  };
}

export default { render };
