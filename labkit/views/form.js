// What questions, guesses and the buttons under a verdict share.

const LETTERS = 'abcdefghijklmnopqrstuvwxyz';

function button(text, act, className = '') {
  const made = element('button', { type: 'button', className }, ...rich(text));
  made.addEventListener('click', act);
  return made;
}

// There before it is filled, so that a screen reader speaks what comes into it.
function toldPlace(tag) {
  const told = element(tag, { className: 'labkit-form-told' });
  told.setAttribute('aria-live', 'polite');
  return told;
}

function toldKeys(text) {
  return element('p', { className: 'labkit-form-keys' }, text);
}

// What each form is: where it says that its kernel is gone (which `lose` may see, too), what sends
// to the kernel, and what ends it.
function makeForm(model, el, name, lose = () => {}) {
  el.classList.add('labkit-form', name);
  const unmake = makeView(model, el);
  const note = makeNote();
  el.append(note);
  const sayGone = (isGone) => sayIn(note, isGone ? GONE : '');
  const { send, disconnect } = connect(model, () => {
    sayGone(true);
    lose();
  });
  const end = () => {
    disconnect();
    unmake();
  };
  return { sayGone, send, end };
}

// Who has run the cell of a form answers next, unless they are typing elsewhere by then.
function takeKeyboard(model, el, focus) {
  const watch = new ResizeObserver(() => {
    if (!el.isConnected) return;
    watch.disconnect();
    const typing = document.activeElement?.closest('input, textarea, [contenteditable="true"]');
    if (model.get('fresh') && !typing) focus();
    model.set('fresh', false);
    model.save_changes();
  });
  watch.observe(el);
  return () => watch.disconnect();
}
