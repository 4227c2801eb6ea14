// The last message of a topic as a tree, and what is known of the topic.

const AGE_MS = 200;
const SAMPLES = 60; // see monitor.py

// A row of the tree. Those with parts can be opened and closed, by mouse and by keyboard.
function makeRow([, name, type, hasParts], path, closed) {
  const value = element('span', { className: 'labkit-monitor-value' });
  const parts = [
    element('span', { className: 'labkit-monitor-name', textContent: name }), value,
    element('span', { className: 'labkit-monitor-kind', textContent: type }),
  ];
  if (!hasParts) return { row: element('div', { className: 'labkit-monitor-row' }, ...parts), value };
  const head = element('summary', { className: 'labkit-monitor-row' }, ...parts);
  const row = element('details', { open: !closed.has(path) }, head);
  row.addEventListener('toggle', () => closed[row.open ? 'delete' : 'add'](path));
  return { row, value };
}

// Build the tree anew. Returns the places of the values.
function buildTree(tree, fields, closed) {
  const places = [];
  const heads = () => [...tree.querySelectorAll('summary')];
  const focused = heads().indexOf(document.activeElement);
  const open = [tree];
  const names = [];
  const rows = fields.map((field) => {
    const [depth, name] = field;
    names.length = depth;
    names.push(name);
    const { row, value } = makeRow(field, names.join('.'), closed);
    row.style.setProperty('--labkit-depth', depth);
    places.push(value);
    return { row, depth };
  });
  tree.replaceChildren();
  for (const { row, depth } of rows) {
    open.length = depth + 1;
    open[depth].append(row);
    open.push(row);
  }
  heads()[focused]?.focus({ preventScroll: true });
  return places;
}

function age(seconds) {
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  return `${Math.floor(seconds / 60)} min ${Math.floor(seconds % 60)} s`;
}

function figure(name) {
  const place = element('dd', { textContent: '–' });
  return { place, box: element('div', {}, element('dt', { textContent: name }), place) };
}

// The course of a rate from zero on, the latest at the right. Its numbers stand beside it, as text.
function makeCourse() {
  const { box, place } = figure('Rate in the last minute');
  const line = svgElement('polyline', { 'vector-effect': 'non-scaling-stroke' });
  const svg = svgElement('svg', {
    class: 'labkit-monitor-course', viewBox: `0 0 ${SAMPLES - 1} 1`, preserveAspectRatio: 'none',
    'aria-hidden': 'true',
  });
  svg.append(line);
  const words = element('span');
  place.replaceChildren(svg, words);
  const show = (rates, range) => {
    const most = Math.max(...rates) || 1;
    const at = (rate, index) => `${SAMPLES - rates.length + index},${1 - (0.8 * rate) / most}`;
    line.setAttribute('points', rates.map(at).join(' '));
    setText(words, `${range} Hz`);
    box.hidden = rates.length < 2;
  };
  show([], '');
  return { box, show };
}

function publishersTable() {
  const cell = (text) => element('th', { textContent: text, scope: 'col' });
  const body = element('tbody');
  const head = element('thead', {}, element('tr', {},
    cell('Publisher'), cell('Reliability'), cell('Durability')));
  const title = element('summary');
  const box = element('details', { className: 'labkit-monitor-publishers', open: true },
    title, element('table', {}, head, body));
  const show = (publishers) => {
    title.textContent = publishers.length === 1 ? '1 publisher' : `${publishers.length} publishers`;
    body.replaceChildren(...publishers.map((words) => element('tr', {},
      ...words.map((text) => element('td', { textContent: text })))));
    box.hidden = !publishers.length;
  };
  show([]);
  return { box, show };
}

function render({ model, el }) {
  el.classList.add('labkit-live', 'labkit-monitor');
  el.setAttribute('role', 'group');
  const topic = element('span', { className: 'labkit-monitor-topic' });
  const type = element('span', { className: 'labkit-monitor-type' });
  const [rate, count, last] = ['Rate', 'Messages', 'Last one came'].map(figure);
  const course = makeCourse();
  const figures = element('dl', {}, rate.box, count.box, last.box, course.box);
  const tree = element('div', { className: 'labkit-monitor-tree' });
  const publishers = publishersTable();
  const closed = new Set();
  let [places, heardAt] = [[], null];
  const showAge = () => {
    if (heardAt !== null) setText(last.place, `${age((performance.now() - heardAt) / 1000)} ago`);
  };
  const { note, end } = follow(model, el, (news) => {
    if (news.topic) {
      topic.textContent = news.topic;
      el.setAttribute('aria-label', `Monitor of ${news.topic}`);
    }
    if (news.type !== undefined) type.textContent = news.type;
    if (news.rate !== undefined) setText(rate.place, news.rate ? `${news.rate} Hz` : '–');
    if (news.course) course.show(...news.course);
    if (news.count !== undefined) setText(count.place, `${news.count}`);
    if (news.publishers) publishers.show(news.publishers);
    if (news.age !== undefined) heardAt = performance.now() - 1000 * news.age;
    if (news.fields) places = buildTree(tree, news.fields, closed);
    news.values?.forEach((text, index) => setText(places[index], text));
    tree.hidden = !places.length;
    showAge();
  });
  const header = element('div', { className: 'labkit-live-header' }, topic, type);
  el.append(header, figures, note, tree, publishers.box);
  const ageing = setInterval(showAge, AGE_MS);
  return () => {
    clearInterval(ageing);
    end();
  };
}

export default { render };
