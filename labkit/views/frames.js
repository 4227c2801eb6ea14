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
  }, { label: 'Frames', least: READABLE });
  const zoom = zoomButtons(drawing);
  zoom.hidden = true;
  const empty = element('p', { className: 'labkit-graph-empty', hidden: true });
  const known = { small: {}, caption: [] };
  // The lines below the names, and the numbers above all, as they are now.
  const write = () => {
    for (const [part, lines] of Object.entries(known.small)) {
      const places = drawing.find(part)?.querySelectorAll('.small') ?? [];
      places.forEach((place, index) => setText(place, lines[index] ?? ''));
    }
    const above = drawing.place.querySelectorAll('.caption');
    known.caption.forEach((line, index) => above[index] && setText(above[index], line));
  };
  // What is wrong, and the numbers, are read where the drawing scrolls, too.
  const keepAbove = () => {
    const { place, svg } = drawing;
    const shift = svg ? (place.scrollLeft * svg.getAttribute('width')) / svg.clientWidth : 0;
    place.querySelectorAll('.caption').forEach((line) => {
      line.setAttribute('transform', `translate(${shift} 0)`);
    });
  };
  drawing.place.addEventListener('scroll', keepAbove);
  const { note, send, end } = follow(model, el, (news) => {
    if (news.svg !== undefined) {
      const isFirst = !drawing.svg;
      drawing.draw(news.svg, news.parts);
      // Where the root is, if it scrolls.
      const { place } = drawing;
      if (isFirst) place.scrollLeft = (place.scrollWidth - place.clientWidth) / 2;
      keepAbove();
      details.hidden = zoom.hidden = !news.svg;
    }
    if (news.told !== undefined) setText(told, news.told);
    if (news.empty !== undefined) {
      setText(empty, news.empty);
      empty.hidden = !news.empty;
    }
    if (news.rates) drawing.setRates(news.rates);
    for (const key of Object.keys(known)) known[key] = news[key] ?? known[key];
    write();
    if (news.ended) el.classList.add('labkit-graph-ended');
  });
  drawing.tell([]);
  el.append(told, drawing.place, empty, note,
    element('div', { className: 'labkit-graph-foot' }, details, zoom));
  const unfit = fitWidth(drawing, el, send);
  return () => {
    unfit();
    end();
  };
}

export default { render };
