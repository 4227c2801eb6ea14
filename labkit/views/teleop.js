// Keys, buttons and a pad become a way to go: v forwards and w to the left, each from -1 to 1.
// While there is one, it is sent ten times a second; when there is none, a stop is sent, once.

const PERIOD_MS = 100;
const PATIENCE_MS = 1500;
const ACTIONS = {
  forward: [1, 0], backward: [-1, 0], left: [0, 1], right: [0, -1],
};
const KEYS = {
  w: 'forward', arrowup: 'forward', x: 'backward', arrowdown: 'backward',
  a: 'left', arrowleft: 'left', d: 'right', arrowright: 'right',
  s: 'stop', ' ': 'stop', '+': 'faster', '=': 'faster', '-': 'slower',
};
const HINT = 'Click here, then hold a key: w a d x or the arrows drive, s or space stops, ' +
  '+ and - change the speed.';
const DRIVING = 'Your keys drive the robot. It stops when you click elsewhere.';
const IN_PANEL = ' Esc goes back to the cell, and F6 comes here from one.';
const SILENT = 'The kernel does not answer: it may be busy with a cell. The robot stops by itself.';

class Driver {
  constructor(send, show) {
    this.send = send;
    this.show = show;
    this.held = new Set();
    this.pad = null;
    this.steps = [0.25, 0.5, 0.75, 1];
    this.step = 3;
    this.turn = 0.5; // a key turns at this share of the turning rate, the pad at all of it
    this.timer = 0;
  }

  get share() { return this.steps[this.step]; }

  way() {
    if (this.pad) return this.pad;
    const sum = (axis) => [...this.held].reduce((all, name) => all + ACTIONS[name][axis], 0);
    return [sum(0), this.turn * sum(1)];
  }

  // Something was pressed or let go.
  change() {
    const moving = this.held.size > 0 || this.pad !== null;
    if (!moving && !this.timer) return;
    clearInterval(this.timer);
    this.timer = 0;
    if (moving) {
      this.repeat();
      this.timer = setInterval(() => this.repeat(), PERIOD_MS);
    } else {
      this.send({ stop: true });
    }
    this.show();
  }

  repeat() {
    const [v, w] = this.way();
    this.send({ v: v * this.share, w: w * this.share });
  }

  press(name) {
    if (name === 'stop') this.stop(true);
    else if (name === 'faster') this.changeSpeed(1);
    else if (name === 'slower') this.changeSpeed(-1);
    else {
      this.held.add(name);
      this.change();
    }
  }

  release(name) {
    if (this.held.delete(name)) this.change();
  }

  changeSpeed(by) {
    this.step = Math.max(0, Math.min(this.steps.length - 1, this.step + by));
    this.show();
  }

  // Let go of everything; `always` even if nothing is held, as somebody else may be driving.
  stop(always = false) {
    this.held.clear();
    this.pad = null;
    if (this.timer) this.change();
    else if (always) this.send({ stop: true });
    this.show();
  }
}

function button(label, name, title) {
  const made = element('button', { type: 'button', textContent: label, title, tabIndex: -1 });
  made.dataset.action = name;
  return made;
}

function keypad(driver) {
  const gap = () => element('span');
  const keys = element(
    'div',
    { className: 'labkit-teleop-keys' },
    gap(), button('w ↑', 'forward', 'forward'), gap(),
    button('a ←', 'left', 'turn left'), button('s ■', 'stop', 'stop'),
    button('d →', 'right', 'turn right'),
    gap(), button('x ↓', 'backward', 'backward'), gap(),
  );
  for (const key of keys.querySelectorAll('button')) {
    const { action } = key.dataset;
    key.addEventListener('pointerdown', (event) => {
      key.setPointerCapture(event.pointerId);
      driver.press(action);
    });
    // However the finger or the mouse goes away.
    for (const kind of ['pointerup', 'pointercancel', 'lostpointercapture']) {
      key.addEventListener(kind, () => driver.release(action));
    }
  }
  return keys;
}

function roundPad(driver) {
  const knob = element('div', { className: 'labkit-teleop-knob' });
  const pad = element('div', { className: 'labkit-teleop-pad' }, knob);
  pad.title = 'Drag: up is forward, left turns left';
  const drag = (event) => {
    const box = pad.getBoundingClientRect();
    const radius = box.width / 2 - 18;
    let x = (event.clientX - box.left - box.width / 2) / radius;
    let y = (event.clientY - box.top - box.height / 2) / radius;
    const length = Math.max(1, Math.hypot(x, y));
    [x, y] = [x / length, y / length];
    knob.style.transform = `translate(${x * radius}px, ${y * radius}px)`;
    const started = driver.pad === null;
    driver.pad = [-y, -x];
    if (started) driver.change();
  };
  pad.addEventListener('pointerdown', (event) => {
    pad.setPointerCapture(event.pointerId);
    drag(event);
  });
  pad.addEventListener('pointermove', (event) => {
    if (driver.pad !== null) drag(event);
  });
  for (const kind of ['pointerup', 'pointercancel', 'lostpointercapture']) {
    pad.addEventListener(kind, () => {
      if (driver.pad === null) return;
      driver.pad = null;
      driver.change();
    });
  }
  return { pad, centre: () => { knob.style.transform = ''; } };
}

function speedControl(driver) {
  const share = element('output');
  const slower = element('button', { type: 'button', textContent: '−', title: 'slower (key -)' });
  const faster = element('button', { type: 'button', textContent: '+', title: 'faster (key +)' });
  slower.addEventListener('click', () => driver.press('slower'));
  faster.addEventListener('click', () => driver.press('faster'));
  return {
    place: element('div', { className: 'labkit-teleop-speed' }, slower, share, faster),
    share,
  };
}

// With spaces that are not broken: a line ends between the numbers.
function command([v, w], topic, count) {
  const number = (value) => (value || 0).toFixed(2); // no minus before a zero
  const parts = [`linear.x = ${number(v)} m/s`, `angular.z = ${number(w)} rad/s`];
  return [`${topic} #${count}`, ...parts].map((part) => part.replaceAll(' ', '\u00a0')).join('  ');
}

function render({ model, el }) {
  const hint = element('div', { className: 'labkit-teleop-wide labkit-teleop-hint' }, HINT);
  const published = element('div', { className: 'labkit-teleop-wide labkit-teleop-published' });
  el.classList.add('labkit-live', 'labkit-teleop');
  el.tabIndex = 0;
  el.setAttribute('role', 'application');
  el.setAttribute('aria-label', `Drive the robot. ${HINT}`);

  let [speeds, topic, way, fault] = [[0, 0], '/cmd_vel', [0, 0], ''];
  let [ended, asked, answered] = [false, 0, 0];
  const driver = new Driver(
    (content) => {
      if (ended) return;
      // From the first question that has no answer yet.
      if (asked <= answered) asked = performance.now();
      else if (performance.now() - asked > PATIENCE_MS) say(SILENT);
      send(content);
    },
    () => {
      speed.share.textContent = `${driver.share * 100} %: ` +
        `${(speeds[0] * driver.share).toFixed(2)} m/s, ` +
        `${(speeds[1] * driver.share * driver.turn).toFixed(2)} rad/s`;
      for (const key of keys.querySelectorAll('button')) {
        key.classList.toggle('labkit-held', driver.held.has(key.dataset.action));
      }
      if (driver.pad === null) round.centre();
    },
  );
  const takeSettings = (news) => {
    ({ topic, speeds } = news);
    ({ steps: driver.steps, step: driver.step, turn: driver.turn } = news);
  };
  const keys = keypad(driver);
  const round = roundPad(driver);
  const speed = speedControl(driver);
  const { note, say, send, end } = follow(model, el, (news) => {
    if (news.topic) takeSettings(news);
    if (news.note !== undefined) fault = news.note;
    if (news.published) way = news.published;
    if (news.count) {
      // Only this is an answer: a kernel that can't hear the page goes on saying that it is there.
      answered = performance.now();
      published.textContent = command(way, topic, news.count);
      say(fault);
    }
    if (news.ended) {
      ended = true;
      driver.stop();
      setText(hint, '');
      el.setAttribute('aria-label', 'Drive the robot. This has ended.');
    }
    driver.show();
  });
  note.classList.add('labkit-teleop-wide');
  el.append(keys, round.pad, speed.place, hint, published, note);

  el.addEventListener('keydown', (event) => {
    const name = KEYS[event.key.toLowerCase()];
    // What is typed with these belongs to the browser: Ctrl+S, Alt+left.
    if (!name || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    if (!event.repeat) driver.press(name);
  });
  el.addEventListener('keyup', (event) => {
    const name = KEYS[event.key.toLowerCase()];
    event.stopPropagation();
    if (!name) return;
    event.preventDefault();
    driver.release(name);
  });
  el.addEventListener('pointerdown', () => el.focus({ preventScroll: true }));
  el.addEventListener('focusin', () => {
    setText(hint, ended ? '' : DRIVING + (panelOf(el) ? IN_PANEL : ''));
  });
  el.addEventListener('focusout', (event) => {
    if (el.contains(event.relatedTarget)) return;
    driver.stop();
    setText(hint, ended ? '' : HINT);
  });
  const leave = () => driver.stop();
  const hide = () => document.hidden && driver.stop();
  window.addEventListener('blur', leave);
  window.addEventListener('pagehide', leave);
  document.addEventListener('visibilitychange', hide);

  return () => {
    driver.stop();
    end();
    window.removeEventListener('blur', leave);
    window.removeEventListener('pagehide', leave);
    document.removeEventListener('visibilitychange', hide);
  };
}

export default { render };
