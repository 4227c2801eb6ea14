// The buttons under a verdict. The cards above them are JupyterLab's to draw (see verdict_form.py).

function render({ model, el }) {
  const told = toldPlace('span');
  let [waiting, isQuiet, isLost, heard] = [0, false, false, model.get('heard')];
  const { sayGone, send, end } = makeForm(model, el, 'labkit-help', () => {
    isLost = true;
    show();
  });
  const make = (ask, text) => {
    const made = button(text, () => {
      if (made.getAttribute('aria-disabled') === 'true') return;
      clearTimeout(waiting);
      waiting = setTimeout(() => {
        isQuiet = true;
        show();
      }, QUIET_MS);
      send({ ask });
    });
    return made;
  };
  const hint = make('hint', '');
  const again = make('check', 'Check again');
  const solution = make('solution', 'Solution');
  const row = element('div', { className: 'labkit-form-row' }, hint, again, solution, told);

  function show() {
    const [count, shown] = [model.get('count'), model.get('told')];
    // What becomes hidden loses the keyboard, in some browsers at once.
    const before = document.activeElement;
    const had = row.contains(before);
    if (model.get('heard') !== heard) {
      heard = model.get('heard');
      clearTimeout(waiting);
      isQuiet = false;
    }
    setText(hint, `Hint (${Math.min(shown + 1, count)} of ${count})`);
    hint.hidden = shown >= count;
    solution.hidden = !model.get('solves');
    // One that is disabled would lose the keyboard.
    again.setAttribute('aria-disabled', String(model.get('busy')));
    row.setAttribute('aria-busy', String(model.get('busy')));
    row.hidden = isLost || model.get('done');
    setText(told, model.get('words'));
    sayGone(isLost || isQuiet);
    if (had && row.hidden) el.closest('.jp-Cell')?.focus({ preventScroll: true });
    else if (had && before.hidden) again.focus({ preventScroll: true });
  }

  const news = 'change:told change:solves change:done change:busy change:words change:heard';
  el.append(row);
  show();
  model.on(news, show);
  return () => {
    clearTimeout(waiting);
    model.off(news, show);
    end();
  };
}

export default { render };
