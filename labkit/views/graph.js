// The graph: the drawing, with switches for what is shown.

// Switches for what is there besides topics.
function makeSwitches(send) {
  const place = element('div', { className: 'labkit-graph-switches' });
  const inputs = {};
  // What was asked for. News that were on their way before do not know of it.
  const asked = {};
  const show = (states) => {
    Object.entries(states).forEach(([name, on]) => {
      if (!inputs[name]) {
        inputs[name] = element('input', { type: 'checkbox' });
        inputs[name].addEventListener('change', () => {
          asked[name] = inputs[name].checked;
          send({ [name]: asked[name] });
        });
        place.append(element('label', {}, inputs[name], `${name[0].toUpperCase()}${name.slice(1)}`));
      }
      if (asked[name] === on) delete asked[name];
      inputs[name].checked = asked[name] ?? on;
    });
    Object.entries(inputs).forEach(([name, input]) => {
      input.parentElement.hidden = !(name in states);
    });
  };
  return { place, show };
}

function render({ model, el }) {
  el.classList.add('labkit-live', 'labkit-graph');
  el.setAttribute('role', 'group');
  el.setAttribute('aria-label', 'Graph of nodes and topics, live');
  const told = element('p', { className: 'labkit-graph-told' });
  const empty = element('p', {
    className: 'labkit-graph-empty',
    textContent: 'No node is running. Start one with lab.spin(node): it appears here.',
  });
  const name = element('strong');
  const about = element('span');
  const details = element('p', { className: 'labkit-graph-details' }, name, about);
  const known = { then: false, changed: false };
  const hint = () => `Point at a part${known.svg?.includes('"sign"') ? ' with a sign' : ''}, `
    + 'or press Tab and the arrow keys, to know more of it. '
    + 'Click a node, or press Enter, for its parameters.';
  const drawing = new Drawing(([first, ...lines]) => {
    setText(name, first ?? '');
    setText(about, first ? lines.join(' · ') : hint());
  }, { label: 'Nodes and topics', ask: (node) => send({ ask: node }) });
  const send = (content) => kernel.send(content);
  const switches = makeSwitches(send);
  const zoom = zoomButtons(drawing);
  const back = element('button', { type: 'button', textContent: 'Show it' });
  const since = element('span');
  const changed = element('p', { className: 'labkit-graph-changed', hidden: true }, since, back);
  const showChanged = () => {
    changed.hidden = !known.changed && !known.then;
    setText(since, known.then
      ? 'This is how it was when the cell was run.'
      : 'This has changed since the cell was run.');
    setText(back, known.then ? 'Show it as it is' : 'Show it as it was');
  };
  back.addEventListener('click', () => send({ then: !known.then }));

  const kernel = follow(model, el, (news) => {
    Object.keys(known).forEach((key) => {
      known[key] = news[key] ?? known[key];
    });
    if (news.svg !== undefined || news.parts) {
      known.svg = news.svg ?? known.svg;
      drawing.draw(known.svg, news.parts ?? drawing.parts);
      empty.hidden = Boolean(known.svg);
      details.hidden = zoom.hidden = !known.svg;
    }
    if (news.told !== undefined) setText(told, news.told);
    if (news.switches) switches.show(news.switches);
    if (news.rates) drawing.setRates(news.rates);
    if (news.passed) drawing.pass(news.passed);
    if (news.parameters) drawing.setParameters(news.parameters);
    if (news.ended) el.classList.add('labkit-graph-ended');
    showChanged();
  });
  drawing.tell([]);
  el.append(told, drawing.place, empty, kernel.note, changed,
    element('div', { className: 'labkit-graph-foot' }, details, switches.place, zoom));

  // Only what can be seen is counted.
  let inView = false;
  let seen = null;
  const look = () => {
    const visible = inView && document.visibilityState === 'visible';
    if (visible !== seen) send({ visible });
    seen = visible;
  };
  const views = new IntersectionObserver((entries) => {
    inView = entries.at(-1).isIntersecting;
    look();
  });
  views.observe(el);
  document.addEventListener('visibilitychange', look);
  const unfit = fitWidth(drawing, el, send);
  return () => {
    views.disconnect();
    unfit();
    document.removeEventListener('visibilitychange', look);
    drawing.dots.end();
    kernel.end();
  };
}

export default { render };
