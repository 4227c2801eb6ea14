// A plot that follows: the latest time is at the right.

const ROOM = 0.2; // so much of the width may be empty, at the right

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

function render({ model, el }) {
  el.classList.add('labkit-live', 'labkit-plot');
  el.setAttribute('role', 'group');
  const canvas = element('canvas');
  canvas.setAttribute('role', 'img');
  const button = element('button', { type: 'button', textContent: 'Pause' });
  const slider = element('input', { type: 'range', min: 0, max: 1, step: 0.005, hidden: true });
  slider.setAttribute('aria-label', 'Time of the cursor');
  const data = new Lines();
  const legend = new Legend();
  const sheet = new Sheet(canvas);
  // `at` is where the cursor is between the edges, from 0 to 1; null without one.
  let [paused, at, frame, drawnAt, toldAt] = [null, null, 0, 0, 0];

  const draw = (moment) => {
    frame = requestAnimationFrame(draw);
    if (moment - drawnAt < FRAME_MS || !data.lines.length || !canvas.clientWidth) return;
    drawnAt = moment;
    const [lines, begin, end] = paused ?? [data.lines, data.end - data.seconds, data.end];
    const time = at === null ? null : begin + at * (end - begin);
    sheet.draw(lines, begin, end);
    if (time !== null) sheet.cursor(time);
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
  canvas.addEventListener('pointermove', (event) => point(sheet.partAt(event.offsetX)));
  canvas.addEventListener('pointerleave', () => {
    if (!paused) point(null);
  });
  slider.addEventListener('input', () => point(Number(slider.value)));
  button.addEventListener('click', () => {
    paused = paused ? null : data.frozen();
    point(paused ? 1 : null);
    slider.hidden = !paused;
    button.textContent = paused ? 'Resume' : 'Pause';
    el.classList.toggle('labkit-plot-paused', paused !== null);
  });
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
  el.append(element('div', { className: 'labkit-live-header' }, legend.table, button), note, canvas, slider);
  frame = requestAnimationFrame(draw);
  return () => {
    cancelAnimationFrame(frame);
    end();
  };
}

export default { render };
