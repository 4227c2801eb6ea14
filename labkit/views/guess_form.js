// A guess: a question, and a button for each answer. The kernel says what comes of it.

const KEYS = 'A letter guesses, too. Esc leaves the guess.';

function render({ model, el }) {
  const { send, end } = makeForm(model, el, 'labkit-guess');
  el.classList.add('labkit-form-framed');
  const told = toldPlace('p');
  const buttons = model.get('options').map((option, index) => {
    const made = button(option, () => send({ guess: index }));
    made.prepend(element('span', { className: 'labkit-guess-letter' }, LETTERS[index]), ' ');
    return made;
  });
  const row = element('div', { className: 'labkit-form-row labkit-guess-options' }, ...buttons);
  const ask = element('p', { className: 'labkit-form-ask' }, ...rich(model.get('ask')));
  row.setAttribute('role', 'group');
  row.setAttribute('aria-label', model.get('ask'));
  el.addEventListener('keydown', (event) => {
    const index = LETTERS.indexOf(event.key.toLowerCase());
    if (event.ctrlKey || event.metaKey || event.altKey || event.key.length > 1) return;
    if (index >= 0) buttons[index]?.click();
  });
  const show = () => {
    buttons.forEach((made, index) => {
      made.setAttribute('aria-pressed', String(index === model.get('guessed')));
    });
    const words = model.get('words');
    if (told.textContent !== words.replaceAll('`', '')) told.replaceChildren(...rich(words));
  };
  el.append(ask, row, told, toldKeys(KEYS));
  show();
  model.on('change:guessed change:words', show);
  const leave = takeKeyboard(model, el, () => {
    (buttons[model.get('guessed')] ?? buttons[0]).focus({ preventScroll: true });
  });
  return () => {
    leave();
    model.off('change:guessed change:words', show);
    end();
  };
}

export default { render };
