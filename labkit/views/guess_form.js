// A guess: a question, and a button for each answer. The kernel says what comes of it.

const LETTERS = 'abcd';
const KEYS = 'A letter guesses, too. Esc leaves the guess.';

function render({ model, el }) {
  el.classList.add('labkit-guess');
  const unmake = makeView(model, el);
  const note = makeNote();
  const { send, disconnect } = connect(model, () => {
    setText(note, GONE);
    note.hidden = false;
  });
  const told = element('p', { className: 'labkit-guess-told' });
  told.setAttribute('aria-live', 'polite');
  const buttons = model.get('options').map((option, index) => {
    const letter = element('span', { className: 'labkit-guess-letter' }, LETTERS[index]);
    const made = element('button', { type: 'button' }, letter, ' ', ...rich(option));
    made.addEventListener('click', () => send({ guess: index }));
    return made;
  });
  const row = element('div', { className: 'labkit-guess-options' }, ...buttons);
  const ask = element('p', { className: 'labkit-guess-ask' }, ...rich(model.get('ask')));
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
  el.append(note, ask, row, told, element('p', { className: 'labkit-guess-keys' }, KEYS));
  show();
  model.on('change:guessed change:words', show);
  const leave = takeKeyboard(model, el, () => {
    (buttons[model.get('guessed')] ?? buttons[0]).focus({ preventScroll: true });
  });
  return () => {
    leave();
    model.off('change:guessed change:words', show);
    disconnect();
    unmake();
  };
}

export default { render };
