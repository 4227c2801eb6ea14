// A drawing as the kernel has made it: each part can be asked, and dots show messages that pass.

const LETTERS_PX = 14; // what JupyterLab has unless it is set; drawings are made for it
const TRAVEL_MS = 650;
// Dots of an arrow are apart: faster than that, one stands for several messages.
const APART_MS = 200;
const MOST_DOTS = 80;
const TICK_MS = 100; // see graph_live.py
// How large it is, as a part of what was drawn. With less than the first, letters are hard to read:
// rather than that, what is too high for the screen scrolls. What is too wide shrinks.
const [READABLE, SMALLEST, LARGEST, STEP] = [0.7, 0.1, 4, 1.25];
const STILL = window.matchMedia('(prefers-reduced-motion: reduce)');

// Dots on their way along arrows. They rest as long as there are none.
class Dots {
  constructor() {
    this.layer = null;
    this.dots = [];
    this.frame = 0;
  }

  restart(layer) {
    this.layer = layer;
    this.dots = [];
  }

  start(path, at) {
    if (!this.layer || this.dots.length >= MOST_DOTS) return;
    const dot = svgElement('circle', { r: 5, class: 'dot', visibility: 'hidden' });
    this.layer.append(dot);
    this.dots.push({ dot, path, length: path.getTotalLength(), at });
    if (!this.frame) this.frame = requestAnimationFrame((now) => this.move(now));
  }

  move(now) {
    this.dots = this.dots.filter(({ dot, path, length, at }) => {
      const part = (now - at) / TRAVEL_MS;
      if (part >= 1) {
        dot.remove();
        return false;
      }
      if (part >= 0) {
        const { x, y } = path.getPointAtLength(part * length);
        dot.setAttribute('cx', x);
        dot.setAttribute('cy', y);
        dot.setAttribute('visibility', 'visible');
      }
      return true;
    });
    this.frame = this.dots.length ? requestAnimationFrame((next) => this.move(next)) : 0;
  }

  end() {
    cancelAnimationFrame(this.frame);
  }
}

// The drawing, and what is known of each of its parts by the part's name.
class Drawing {
  constructor(tell, { label, ask = () => {}, least = 0 }) {
    this.place = element('div', { className: 'labkit-graph-drawing' });
    [this.tell, this.name, this.ask, this.least] = [tell, label, ask, least];
    // Node -> its parameters, as far as they were asked for.
    this.parameters = {};
    this.dots = new Dots();
    this.parts = {};
    this.rates = {};
    this.chosen = '';
    // null: its letters can be read; 0: all of it is seen.
    this.scale = null;
    // Part -> when its last dot starts.
    this.startedAt = {};
    this.place.addEventListener('keydown', (event) => this.onKey(event));
    this.place.addEventListener('click', () => this.askChosen());
    this.place.addEventListener('pointerover', (event) => this.choose(this.partAt(event.target)));
    this.place.addEventListener('pointerleave', () => {
      this.choose(this.partAt(document.activeElement));
    });
    this.place.addEventListener('focusin', (event) => this.choose(this.partAt(event.target)));
    this.place.addEventListener('focusout', () => this.choose(''));
    this.place.addEventListener('wheel', (event) => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY / 400), event.clientX, event.clientY);
    }, { passive: false });
    this.place.addEventListener('pointermove', (event) => {
      // A finger moves it anyway.
      if (event.buttons === 1 && event.pointerType !== 'touch') {
        this.place.scrollBy(-event.movementX, -event.movementY);
      }
    });
  }

  get svg() {
    return this.place.querySelector('svg');
  }

  resize() {
    if (!this.svg) return;
    const [width, height] = ['width', 'height'].map((name) => this.svg.getAttribute(name));
    // As large as the letters of the page: its width is in theirs, not in its own.
    const letters = width / LETTERS_PX;
    const least = this.scale === null ? READABLE * letters : 0;
    // What must not shrink further scrolls.
    const wide = this.scale === null ? this.least * letters : 0;
    const whole = `${width / height} * var(--labkit-graph-high)`;
    this.svg.style.maxWidth = 'none';
    const fits = `min(${letters}em, 100%, max(${least}em, ${whole}))`;
    this.svg.style.width = this.scale ? `${this.scale * letters}em`
      : wide ? `max(${wide}em, ${fits})` : fits;
  }

  // Make it larger by a factor. A point of the page stays where it is.
  zoom(factor, x, y) {
    if (!this.svg) return;
    const [place, before] = [this.place.getBoundingClientRect(), this.svg.getBoundingClientRect()];
    const letters = Number.parseFloat(getComputedStyle(this.svg).fontSize);
    const scale = (factor * before.width * LETTERS_PX) / (letters * this.svg.getAttribute('width'));
    this.scale = Math.max(SMALLEST, Math.min(LARGEST, scale));
    this.resize();
    const grown = this.svg.getBoundingClientRect().width / before.width - 1;
    this.place.scrollBy(grown * ((x ?? place.x + place.width / 2) - before.x),
      grown * ((y ?? place.y + place.height / 2) - before.y));
  }

  showAll() {
    this.scale = 0;
    this.resize();
  }

  partAt(target) {
    const part = this.place.contains(target) ? target.closest('[data-part]') : null;
    return part?.dataset.part ?? '';
  }

  get all() {
    return [...this.place.querySelectorAll('[data-part]')];
  }

  find(name) {
    return this.place.querySelector(`[data-part="${name}"]`);
  }

  // Text of others comes in as text: the parser of XML runs nothing, and no script is in it.
  draw(text, parts) {
    const had = this.parts[this.partAt(document.activeElement)]?.[0];
    this.parts = parts;
    const { scrollLeft, scrollTop } = this.place;
    this.place.replaceChildren();
    this.chosen = '';
    this.tell([]);
    if (!text) return;
    const svg = document.importNode(
      new DOMParser().parseFromString(text, 'image/svg+xml').documentElement, true);
    svg.querySelectorAll('title, desc').forEach((each) => each.remove());
    svg.removeAttribute('aria-labelledby');
    svg.setAttribute('role', 'group');
    svg.setAttribute('aria-label', this.name);
    svg.lastElementChild.setAttribute('font-size', svg.getAttribute('font-size'));
    svg.removeAttribute('font-size');
    svg.style.height = '';
    const layer = svgElement('g', { 'aria-hidden': 'true' });
    svg.lastElementChild.append(layer);
    this.place.append(svg);
    this.resize();
    this.place.scrollTo(scrollLeft, scrollTop);
    this.dots.restart(layer);
    this.all.forEach((part, index) => {
      part.setAttribute('role', 'img');
      part.setAttribute('tabindex', index ? -1 : 0);
      const way = part.querySelector('.way');
      // Wide enough to be pointed at.
      if (way) part.prepend(svgElement('path', { d: way.getAttribute('d'), class: 'hit' }));
    });
    this.label();
    const again = this.all.find((part) => parts[part.dataset.part]?.[0] === had);
    if (had) (again ?? this.all[0])?.focus({ preventScroll: true });
  }

  lines(name) {
    const [rate, known] = [this.rates[name], this.parameters[this.nodeOf(name)]];
    return [...(this.parts[name] ?? []), ...(rate ? [`${rate}`] : []),
      ...(known ? [`Parameters: ${known}`] : [])];
  }

  // The node that a part stands for; '' if it is none, or several.
  nodeOf(name) {
    const [first = ''] = this.parts[name] ?? [];
    return first.startsWith('Node ') ? first.slice('Node '.length) : '';
  }

  askChosen() {
    const node = this.nodeOf(this.chosen);
    if (!node) return;
    this.setParameters({ [node]: this.parameters[node] ?? '…' });
    this.ask(node);
  }

  setParameters(known) {
    Object.assign(this.parameters, known);
    this.label();
    if (this.chosen) this.tell(this.lines(this.chosen));
  }

  label() {
    this.all.forEach((part) => {
      part.setAttribute('aria-label', this.lines(part.dataset.part).join('. '));
    });
  }

  setRates(rates) {
    this.rates = rates;
    this.label();
    if (this.chosen) this.tell(this.lines(this.chosen));
  }

  choose(name) {
    if (name === this.chosen) return;
    this.find(this.chosen)?.classList.remove('chosen');
    this.chosen = name;
    this.find(name)?.classList.add('chosen');
    this.tell(name ? this.lines(name) : []);
  }

  onKey(event) {
    if (event.ctrlKey || event.metaKey) return; // the browser zooms
    if (event.key === '0') this.showAll();
    if (event.key === 'Enter' && !event.shiftKey && !event.altKey) this.askChosen();
    const factor = { '+': STEP, '=': STEP, '-': 1 / STEP }[event.key];
    if (factor) {
      this.zoom(factor);
      document.activeElement.scrollIntoView({ block: 'nearest', inline: 'nearest' });
    }
    const parts = this.all;
    const here = parts.indexOf(document.activeElement);
    const steps = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 };
    const to = { Home: 0, End: parts.length - 1 }[event.key] ?? here + (steps[event.key] ?? 0);
    if (here < 0 || (to === here && !(event.key in steps))) return;
    event.preventDefault();
    const next = parts[Math.max(0, Math.min(parts.length - 1, to))];
    parts[here].setAttribute('tabindex', -1);
    next.setAttribute('tabindex', 0);
    next.focus();
  }

  // Show messages that have passed: a dot for each, as far as they can be told apart.
  pass(passed) {
    Object.entries(passed).forEach(([name, count]) => {
      const part = this.find(name);
      const way = part?.querySelector('.way');
      if (!way) return;
      part.dataset.passed = Number(part.dataset.passed ?? 0) + count;
      // What is handed on comes after what has come in.
      const wait = part.classList.contains('hears') ? TRAVEL_MS : 0;
      const now = performance.now();
      for (let index = 0; index < count && !STILL.matches; index += 1) {
        const at = Math.max(now + (index * TICK_MS) / count, (this.startedAt[name] ?? 0) + APART_MS);
        if (at > now + TICK_MS) break;
        this.startedAt[name] = at;
        this.dots.start(way, at + wait);
      }
    });
  }
}

function zoomButtons(drawing) {
  const button = (text, label, act) => {
    const made = element('button', { type: 'button', textContent: text, title: label });
    made.setAttribute('aria-label', label);
    made.addEventListener('click', act);
    return made;
  };
  return element('div', { className: 'labkit-graph-zoom' },
    button('−', 'Zoom out (key -)', () => drawing.zoom(1 / STEP)),
    button('+', 'Zoom in (key +)', () => drawing.zoom(STEP)),
    button('Fit', 'Fit all of it (key 0)', () => drawing.showAll()));
}

// Tell the kernel how wide a drawing may be, now and whenever that changes.
function fitWidth(drawing, el, send) {
  let width = 0;
  const sizes = new ResizeObserver(() => {
    const letters = Number.parseFloat(getComputedStyle(el).fontSize);
    // In steps, so that a page that is being resized asks now and then.
    const fits = Math.floor(((drawing.place.offsetWidth / letters) * LETTERS_PX) / 20) * 20;
    if (fits && fits !== width) send({ width: fits });
    width = fits || width;
  });
  sizes.observe(el);
  return () => sizes.disconnect();
}
