// A bag: a table with a strip for each topic, and a slider that goes through its time.
//
// Lines and trail are here from the beginning. The kernel is asked for single messages and scans;
// it is asked anew only when it has answered, so that a busy one is not flooded.

const BINS = 240; // see bag_reading.py
const ASK_MS = 100;
const SLOW_MS = 4000;
const SPOKEN_MS = 1000; // a screen reader has to be able to speak what it is told
const RATES = [0.1, 0.5, 1, 2, 5, 10, 50, 100];
const JUMP = 0.5; // a longer way at once is none that was driven, m; see arena_robot.py

// Lines with the time of the slider: what comes later is pale.
class Replay extends Sheet {
  line(line, py) {
    const { context } = this;
    const end = indexAt(line.times, this.time) + 1;
    context.globalAlpha = 0.3;
    super.line({ ...line, times: line.times.slice(Math.max(0, end - 1)),
      values: line.values.slice(Math.max(0, end - 1)) }, py);
    context.globalAlpha = 1;
    if (end) {
      super.line({ ...line, times: line.times.slice(0, end), values: line.values.slice(0, end) },
        py);
    }
  }

  drawAt(time, lines, seconds) {
    this.time = time;
    this.draw(lines, 0, seconds || 1);
    this.cursor(time);
  }
}

// When the messages of a topic came, as columns: the more, the higher.
function drawStrip(canvas, bins) {
  const ratio = window.devicePixelRatio || 1;
  const { clientWidth: width, clientHeight: height } = canvas;
  if (!width) return;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const context = canvas.getContext('2d');
  context.scale(ratio, ratio);
  context.fillStyle = getComputedStyle(canvas).color;
  const most = bins.reduce((a, b) => Math.max(a, b), 1);
  bins.forEach((count, index) => {
    if (!count) return;
    const high = height * (0.3 + 0.7 * (count / most));
    const wide = Math.max(width / BINS, 1);
    context.fillRect((index * width) / BINS, height - high, wide, high);
  });
}

// The table of topics. A topic's button shows what its messages say; its strip is grabbed by `grab`.
class Topics {
  constructor(choose, grab) {
    [this.choose, this.grab] = [choose, grab];
    this.body = element('tbody');
    const heads = ['Topic', 'Messages', 'Rate', 'When they came'];
    this.table = element('table', { className: 'labkit-bag-topics' },
      element('thead', {}, element('tr', {}, ...heads.map(
        (text) => element('th', { textContent: text, scope: 'col' }),
      ))), this.body);
    this.strips = [];
  }

  build(topics, bins) {
    this.strips = topics.map((_, row) => {
      const canvas = element('canvas');
      canvas.setAttribute('role', 'img');
      return { canvas, bins: bins.subarray(row * BINS, (row + 1) * BINS) };
    });
    this.buttons = new Map();
    this.body.replaceChildren(...topics.map(([name, type, count, rate, , words], row) => {
      const button = element('button', {
        type: 'button', textContent: name, title: 'Show its messages',
      });
      button.setAttribute('aria-pressed', 'false');
      button.addEventListener('click', () => this.choose(name));
      this.buttons.set(name, button);
      const { canvas } = this.strips[row];
      canvas.setAttribute('aria-label', words);
      canvas.title = words;
      this.grab(canvas, (event) => event.offsetX / canvas.clientWidth);
      return element('tr', {},
        element('th', { scope: 'row' }, button,
          element('span', { className: 'labkit-bag-type' }, ...breakable(type))),
        element('td', { textContent: count }), element('td', { textContent: rate || '–' }),
        element('td', {}, element('div', { className: 'labkit-bag-strip' }, canvas)));
    }));
    this.draw();
  }

  draw() {
    for (const { canvas, bins } of this.strips) drawStrip(canvas, bins);
  }

  mark(name) {
    for (const [other, button] of this.buttons) {
      button.setAttribute('aria-pressed', String(other === name));
    }
  }
}

// Where the robot was, and the map of it.
class Trail {
  constructor(canvas) {
    this.map = new Map2d(canvas);
    this.robot = emptyRobot();
    this.scene = emptyScene(this.robot);
    this.times = [];
  }

  take(table) {
    const count = table.length / 6;
    this.times = Array.from({ length: count }, (_, row) => table[6 * row]);
    this.poses = this.times.map((_, row) => table.subarray(6 * row + 1, 6 * row + 6));
    // Where the path that leads to each pose begins: a robot that was put elsewhere begins anew.
    this.starts = [];
    this.poses.forEach(([x, y], row) => {
      include(this.scene.shown, x, y);
      const before = this.poses[row - 1];
      const jumped = !before || Math.hypot(x - before[0], y - before[1]) > this.jump();
      this.starts.push(jumped ? row : this.starts[row - 1]);
    });
  }

  // Poses that were thinned out are further from each other.
  jump() {
    if (this.apart === undefined) {
      const ways = this.poses.slice(1).map(
        ([x, y], row) => Math.hypot(x - this.poses[row][0], y - this.poses[row][1]),
      ).sort((a, b) => a - b);
      this.apart = Math.max(JUMP, 20 * (ways[ways.length >> 1] ?? 0));
    }
    return this.apart;
  }

  drawAt(time) {
    const index = indexAt(this.times, time);
    this.robot.pose = index < 0 ? null : [...this.poses[index]];
    const first = index < 0 ? 0 : this.starts[index];
    this.robot.trail = index < 0 ? [] : this.poses.slice(first, index + 1);
    if (this.map.canvas.clientWidth) this.map.draw(this.scene, null);
  }

  words() {
    if (!this.robot.pose) return 'The robot has not told yet where it is.';
    const [x, y, yaw, v, w] = this.robot.pose;
    const degrees = Math.round((yaw * 180) / Math.PI) + 0;
    return `Robot at x = ${x.toFixed(2)} m, y = ${y.toFixed(2)} m, heading ${degrees}°, `
      + `${v.toFixed(2)} m/s, ${w.toFixed(2)} rad/s.`;
  }
}

// The name of a type, which may go on in a new line after each slash.
function breakable(type) {
  const [first, ...others] = type.split('/');
  return [first, ...others.flatMap((word) => ['/', element('wbr'), word])];
}

// What a message says, as lines of text.
function showMessage(place, fields) {
  place.replaceChildren(...fields.map(([depth, name, type, , value]) => {
    const row = element('div', { className: 'labkit-bag-row' },
      element('span', { textContent: `${name}:` }), ' ',
      element('span', { textContent: value || '' }), ' ',
      element('span', { className: 'labkit-bag-type', textContent: type }));
    row.style.setProperty('--labkit-depth', depth);
    return row;
  }));
}

function render({ model, el }) {
  el.classList.add('labkit-live', 'labkit-bag');
  el.setAttribute('role', 'group');
  const unmake = makeView(model, el);
  const place = (tag, className, properties = {}) => element(tag, { className, ...properties });
  const title = place('span', 'labkit-bag-name');
  const about = place('span', 'labkit-bag-about', { textContent: 'The bag is being read.' });
  const note = makeNote();
  const button = element('button', { type: 'button', textContent: 'Play' });
  const slider = element('input', { type: 'range', min: 0, max: 1, step: 0.01, value: 0 });
  slider.setAttribute('aria-label', 'Time in the bag');
  const clock = place('output', 'labkit-bag-clock');
  const rate = element('select', {}, ...RATES.map(
    (value) => element('option', { value, textContent: `${value}×`, selected: value === 1 }),
  ));
  rate.setAttribute('aria-label', 'Rate');
  const controls = element('div', { className: 'labkit-bag-controls', hidden: true },
    button, slider, clock, rate);
  const chart = element('canvas');
  chart.setAttribute('role', 'img');
  const legend = new Legend();
  const plot = element('div', { className: 'labkit-plot', hidden: true },
    element('div', { className: 'labkit-live-header' }, legend.table), chart);
  const floor = element('canvas');
  floor.setAttribute('role', 'img');
  floor.setAttribute('aria-label', 'Map of the path of the robot, told in words below.');
  const words = place('div', 'labkit-arena-words');
  words.setAttribute('aria-live', 'polite');
  const arena = element('div', { className: 'labkit-arena', hidden: true }, floor, words);
  // What is long scrolls, by keys, too.
  const message = place('div', 'labkit-bag-message', { tabIndex: 0, role: 'region' });
  message.setAttribute('aria-label', 'Message');
  const picture = element('img', { alt: '', hidden: true });
  const pixels = place('div', 'labkit-bag-about');
  const came = place('div', 'labkit-bag-about');
  const field = element('select');
  field.setAttribute('aria-label', 'Number to plot');
  const add = element('button', { type: 'button', textContent: 'Plot' });
  const clear = element('button', { type: 'button', textContent: 'Clear plot' });
  const chosen = place('span', 'labkit-bag-name');
  const details = element('div', { className: 'labkit-bag-details', hidden: true },
    element('div', { className: 'labkit-bag-controls' }, chosen, field, add, clear), came,
    picture, pixels, message);

  const [sheet, trail] = [new Replay(chart), new Trail(floor)];
  const state = {
    seconds: 0, time: 0, lines: [], topic: '', scans: false, why: '', refused: '', ended: '',
    playing: false,
  };
  let [frame, last, spokenAt, askedAt, waiting, asked] = [0, null, 0, 0, false, null];
  // What can be dragged over sets the time: `partAt` tells where, from 0 to 1.
  const grab = (target, partAt) => {
    const move = (event) => {
      if (event.buttons !== 1 || !state.seconds) return;
      state.time = Math.max(0, Math.min(1, partAt(event))) * state.seconds;
      slider.value = state.time;
      redraw();
    };
    target.classList.add('labkit-bag-grabbed');
    target.addEventListener('pointerdown', (event) => {
      target.setPointerCapture(event.pointerId);
      move(event);
    });
    target.addEventListener('pointermove', move);
  };
  const topics = new Topics((name) => {
    state.topic = state.topic === name ? '' : name;
    topics.mark(state.topic);
    details.hidden = !state.topic;
    chosen.textContent = state.topic;
    field.replaceChildren();
    message.replaceChildren();
    came.textContent = pixels.textContent = '';
    showJpeg(picture, null);
    asked = null;
    if (state.topic) send({ paths: state.topic });
    redraw();
  }, grab);
  grab(chart, (event) => sheet.partAt(event.offsetX));

  const kernel = connect(model, () => {
    state.ended = GONE;
    play(false);
    showNote();
  });
  const send = (content) => {
    askedAt = performance.now();
    waiting = true;
    kernel.send(content);
  };
  const showNote = () => {
    const slow = waiting && performance.now() - askedAt > SLOW_MS;
    const words = [state.why, state.refused, slow ? GONE : ''];
    sayIn(note, state.ended || words.filter(Boolean).join(' '));
  };
  // Whether the kernel has something to tell that belongs to the time of the slider.
  const open = () => (state.topic || state.scans) && !state.ended
    && `${state.time} ${state.topic}` !== asked;
  const ask = () => {
    if (!open() || waiting || performance.now() - askedAt < ASK_MS) return;
    asked = `${state.time} ${state.topic}`;
    send({ at: state.time, topic: state.topic });
  };
  const draw = (moment) => {
    frame = 0;
    if (state.playing) {
      const passed = last === null ? 0 : (moment - last) / 1000;
      state.time = Math.min(state.seconds, state.time + passed * Number(rate.value));
      slider.value = state.time;
      if (state.time >= state.seconds) play(false);
    }
    last = moment;
    el.style.setProperty('--labkit-at', state.seconds ? state.time / state.seconds : 0);
    setText(clock, `${inSeconds(state.time)} of ${inSeconds(state.seconds)}`);
    slider.setAttribute('aria-valuetext', clock.textContent);
    if (!plot.hidden && chart.clientWidth) sheet.drawAt(state.time, state.lines, state.seconds);
    if (!arena.hidden) trail.drawAt(state.time);
    if (moment - spokenAt > SPOKEN_MS || !state.playing) {
      spokenAt = moment;
      tell();
    }
    ask();
    // For those who look on from outside, such as tests.
    el.dataset.time = state.time.toFixed(3);
    // While an answer is awaited nothing has to be done: it comes with a drawing.
    if (state.playing || (!waiting && open())) redraw();
  };
  const redraw = () => {
    frame ||= requestAnimationFrame(draw);
  };
  const tell = () => {
    if (!arena.hidden) setText(words, trail.words());
    legend.tell(state.lines.map((line) => {
      const end = indexAt(line.times, state.time) + 1;
      return { values: line.values.slice(0, end) };
    }));
  };
  const play = (on) => {
    state.playing = on;
    last = null;
    button.textContent = on ? 'Pause' : 'Play';
    redraw();
  };
  const takeLines = (series, buffers) => {
    state.lines = series.map(([label, unit], number) => {
      const numbers = numbersOf(buffers[number], Float64Array);
      const half = numbers.length / 2;
      return {
        label, unit, number, times: numbers.subarray(0, half), values: numbers.subarray(half),
      };
    });
    plot.hidden = !series.length;
    legend.build(state.lines);
    const names = state.lines.map(({ label, unit }) => (unit ? `${label} in ${unit}` : label));
    chart.setAttribute('aria-label',
      `Lines over the time of the bag: ${names.join(', ')}. The table has the numbers.`);
    chart.style.height = `${heightOf(state.lines)}em`;
  };
  const takeAll = (news, buffers) => {
    setText(title, news.name);
    setText(about, news.about);
    el.setAttribute('aria-label', `Bag ${news.name}`);
    state.seconds = news.seconds;
    slider.max = news.seconds;
    slider.step = Math.max(0.01, news.seconds / 10000);
    [state.scans, state.why] = [Boolean(news.scan && news.track), news.note];
    controls.hidden = !news.seconds;
    arena.hidden = !news.track;
    topics.build(news.topics, numbersOf(buffers[0]));
    topics.table.hidden = !news.topics.length;
    if (news.track) trail.take(numbersOf(buffers[1], Float64Array));
    takeLines(news.series, buffers.slice(news.track ? 2 : 1));
  };
  const takeMoment = (news, buffers) => {
    const sent = Object.fromEntries(news.buffers.map((name, index) => [name, buffers[index]]));
    trail.scene.scan = sent.scan ? numbersOf(sent.scan) : null;
    if (news.fields === undefined || news.of !== state.topic) return;
    showMessage(message, news.fields);
    showJpeg(picture, sent.picture);
    picture.alt = `Picture of ${state.topic}`;
    setText(pixels, news.picture ?? '');
    setText(came, news.came === null ? 'None has come by then.' : `Came at ${inSeconds(news.came)}`);
  };
  const takePaths = (news) => {
    if (news.of !== state.topic) return;
    field.replaceChildren(...news.paths.map((path) => element('option', { textContent: path })));
    field.disabled = add.disabled = !news.paths.length;
  };
  const onMessage = (news, buffers) => {
    waiting = false;
    state.refused = news.refused ?? '';
    if (news.ended) {
      state.ended = news.ended;
      play(false);
    }
    if (news.topics) takeAll(news, buffers);
    else if (news.series) takeLines(news.series, buffers ?? []);
    else if (news.paths) takePaths(news);
    else if (news.at !== undefined) takeMoment(news, buffers);
    // For those who look on from outside, such as tests.
    el.dataset.updates = Number(el.dataset.updates ?? 0) + 1;
    showNote();
    redraw();
  };

  button.addEventListener('click', () => {
    if (!state.playing && state.time >= state.seconds) state.time = 0;
    play(!state.playing);
  });
  slider.addEventListener('input', () => {
    // The last step of the slider may lie before the end of the bag.
    const rest = state.seconds - Number(slider.value);
    state.time = rest < Number(slider.step) ? state.seconds : Number(slider.value);
    redraw();
  });
  add.addEventListener('click', () => {
    const wanted = `${state.topic}.${field.value}`;
    send({ lines: [...new Set([...state.lines.map(({ label }) => label), wanted])] });
  });
  clear.addEventListener('click', () => takeLines([], []));
  model.on('msg:custom', onMessage);
  const header = element('div', { className: 'labkit-live-header' }, title, about);
  // Beside each other where there is room: play, map and topics are in sight together.
  el.append(header, note, controls, element('div', { className: 'labkit-bag-sides' },
    element('div', {}, arena, plot), element('div', {}, topics.table, details)));
  const sizes = new ResizeObserver(() => {
    topics.draw();
    redraw();
  });
  sizes.observe(el);
  const themes = new MutationObserver(() => {
    topics.draw();
    redraw();
  });
  themes.observe(document.body, { attributes: true });
  const watch = setInterval(showNote, SLOW_MS / 4);
  send({ see: true });
  return () => {
    model.off('msg:custom', onMessage);
    kernel.disconnect();
    unmake();
    sizes.disconnect();
    themes.disconnect();
    clearInterval(watch);
    cancelAnimationFrame(frame);
    showJpeg(picture, null);
  };
}

export default { render };
