// The tree of frames: the drawing, with the rate and the age of what moves, or with numbers.

function render({ model, el }) {
  el.classList.add('labkit-live', 'labkit-graph', 'labkit-frames');
  el.setAttribute('role', 'group');
  el.setAttribute('aria-label', 'Tree of frames, live');
  const told = element('p', { className: 'labkit-graph-told' });
  const name = element('strong');
  const about = element('span');
  const details = element('p', { className: 'labkit-graph-details', hidden: true }, name, about);
  const hint = 'Point at a frame, or press Tab and the arrow keys, to know more of it.';
  const drawing = new Drawing(([first, ...lines]) => {
    setText(name, first ?? '');
    setText(about, first ? lines.join(' · ') : hint);
  }, { label: 'Frames' });
  const zoom = zoomButtons(drawing);
  zoom.hidden = true;
  const known = { small: {}, result: '' };
  // The lines below the names, and the one above all, as they are now.
  const write = () => {
    for (const [part, lines] of Object.entries(known.small)) {
      const places = drawing.find(part)?.querySelectorAll('.small') ?? [];
      places.forEach((place, index) => setText(place, lines[index] ?? ''));
    }
    const caption = known.result && drawing.place.querySelector('.caption');
    if (caption) setText(caption, known.result);
  };
  const { note, send, end } = follow(model, el, (news) => {
    if (news.svg !== undefined) {
      drawing.draw(news.svg, news.parts);
      details.hidden = zoom.hidden = !news.svg;
    }
    if (news.told !== undefined) setText(told, news.told);
    if (news.rates) drawing.setRates(news.rates);
    for (const key of Object.keys(known)) known[key] = news[key] ?? known[key];
    write();
    if (news.ended) el.classList.add('labkit-graph-ended');
  });
  drawing.tell([]);
  el.append(told, drawing.place, note,
    element('div', { className: 'labkit-graph-foot' }, details, zoom));
  const unfit = fitWidth(drawing, el, send);
  return () => {
    unfit();
    end();
  };
}

export default { render };
