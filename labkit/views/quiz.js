// One form a question: the browser's own fieldset, inputs and button. The kernel judges.

const LETTERS = 'abcdefghijklmnopqrstuvwxyz';
let forms = 0;

function inputs(question, name) {
  if (question.kind === 'text') {
    const field = element('input', { type: 'text', name, autocomplete: 'off' });
    return [element('label', { className: 'labkit-quiz-option' }, 'Your answer: ', field)];
  }
  return question.labels.map((label, index) => {
    const value = LETTERS[index];
    const box = element('input', { type: question.kind, name, value });
    return element('label', { className: 'labkit-quiz-option' }, box, ` ${value}) ${label}`);
  });
}

function given(form, question, name) {
  if (question.kind === 'text') return form.elements[name].value;
  return [...form.querySelectorAll('input:checked')].map((box) => box.value).join('');
}

function render({ model, el }) {
  el.classList.add('labkit-quiz');
  keepKeys(el);
  const spoken = model.get('questions').map((question, index) => {
    const number = index + 1;
    const name = `labkit-quiz-${(forms += 1)}`;
    const legend = element('legend', {}, `${number}. ${question.text} (${question.how})`);
    const button = element('button', { type: 'submit' }, 'Check this answer');
    const status = element('div');
    // There before it is filled, so that a screen reader speaks what comes into it.
    status.setAttribute('aria-live', 'polite');
    const fields = element('fieldset', {}, legend, ...inputs(question, name), button, status);
    const form = element('form', {}, fields);
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      const answer = given(form, question, name);
      if (answer.trim()) model.send({ number, answer });
      else status.textContent = 'Choose or write an answer first.';
    });
    el.append(form);
    return status;
  });
  const show = () => {
    const feedback = model.get('feedback');
    spoken.forEach((status, index) => {
      const html = feedback[String(index + 1)] ?? '';
      // Written by labkit, with everything in it escaped.
      if (status.dataset.shown !== html) {
        status.dataset.shown = html;
        status.innerHTML = html;
      }
    });
  };
  show();
  model.on('change:feedback', show);
  return () => model.off('change:feedback', show);
}

export default { render };
