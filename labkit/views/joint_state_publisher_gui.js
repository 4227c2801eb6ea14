// A slider for each joint, as the browser has them: mouse, touch and arrow keys move it.

function jointSlider(row, move) {
  const value = element('output');
  // With steps it may not reach its end: they are rounded. Keys move it by a hundredth anyway.
  const slider = element('input', {
    type: 'range', min: row.lower, max: row.upper, step: 'any',
  });
  slider.setAttribute('aria-label', `${row.name}, ${row.unit}`);
  const show = (position) => {
    setText(value, `${position.toFixed(3)} ${row.unit}`);
    slider.setAttribute('aria-valuetext', value.textContent);
  };
  slider.addEventListener('input', () => {
    show(slider.valueAsNumber);
    move(row.name, slider.valueAsNumber);
  });
  const take = (position) => {
    // Not while it is dragged: what comes back then is a moment old.
    if (!slider.matches(':active')) slider.valueAsNumber = position;
    show(position);
  };
  take(row.position);
  return { parts: [element('span', { textContent: row.name }), slider, value], take };
}

function render({ model, el }) {
  el.classList.add('labkit-live', 'labkit-joints');
  const list = element('div', { className: 'labkit-joints-list' });
  const centre = element('button', { type: 'button', textContent: 'Centre' });
  let [sliders, known] = [new Map(), ''];
  const { note, send, end } = follow(model, el, (news) => {
    if (news.ended) {
      for (const part of el.querySelectorAll('input, button')) part.disabled = true;
    }
    if (!news.rows) return;
    const shape = JSON.stringify(news.rows.map(({ position, ...rest }) => rest));
    if (shape !== known) {
      known = shape;
      const move = (name, position) => send({ name, position });
      sliders = new Map(news.rows.map((row) => [row.name, jointSlider(row, move)]));
      list.replaceChildren(...[...sliders.values()].flatMap(({ parts }) => parts));
      centre.hidden = !sliders.size;
    }
    for (const row of news.rows) sliders.get(row.name).take(row.position);
  });
  centre.addEventListener('click', () => send({ centre: true }));
  el.append(list, centre, note);
  return end;
}

export default { render };
