// One question at a time, as a form: the browser's own fieldset, inputs and buttons. The kernel
// judges. Enter answers; once an answer has been judged, Enter goes on.

const SIGNS = { good: '✔', bad: '✘', warn: '⚠' };
const WORDS = { good: 'right', bad: 'not yet right', warn: 'open', '': 'open' };
let forms = 0;

function signOf(tone) {
  const sign = element('span', { className: 'labkit-quiz-sign' }, SIGNS[tone] ?? '○');
  sign.setAttribute('aria-hidden', 'true');
  return sign;
}

function inputs(question, name) {
  if (question.kind === 'text') {
    const field = element('input', { type: 'text', name, autocomplete: 'off' });
    return [element('label', { className: 'labkit-quiz-word' }, 'Your answer: ', field)];
  }
  return question.labels.map((label, index) => {
    const value = LETTERS[index];
    const box = element('input', { type: question.kind, name, value });
    const words = element('span', {}, `${value}) `, ...rich(label));
    return element('label', { className: 'labkit-quiz-option' }, box, words);
  });
}

// The form of one question: what is chosen in it, and how an answer to it is shown.
function questionForm(question, place, buttons) {
  const ofText = question.kind === 'text';
  const legend = element('legend', { className: 'labkit-form-ask' },
    element('span', { className: 'labkit-quiz-place' }, place), ' ', ...rich(question.text),
    element('span', { className: 'labkit-quiz-how' }, ` (${question.how})`));
  const options = inputs(question, `labkit-quiz-${(forms += 1)}`);
  const told = toldPlace('div');
  const row = element('div', { className: 'labkit-form-row labkit-quiz-buttons' }, ...buttons);
  const form = element('form', {}, element('fieldset', {}, legend, ...options, told), row);
  const boxes = [...form.querySelectorAll('input')];
  const chosen = () => boxes.filter((box) => box.checked);
  const say = (...parts) => {
    for (const old of form.querySelectorAll('.labkit-quiz-why')) old.remove();
    told.replaceChildren(...parts);
  };
  // What is said to an option is seen under it, and heard after the verdict.
  const explain = (label, text, isRight) => {
    const index = LETTERS.indexOf(label);
    if (ofText || label.length > 1 || index < 0) return element('p', {}, ...rich(text));
    const tone = isRight && boxes[index].checked ? 'good' : 'bad';
    const why = element('p', { className: 'labkit-quiz-why' }, signOf(tone), ...rich(text));
    why.dataset.tone = tone;
    options[index].after(why);
    return element('p', { className: 'labkit-quiz-heard' }, `${label}: `, ...rich(text));
  };
  return {
    form,
    say,
    given: () => (ofText ? boxes[0].value : chosen().map((box) => box.value).join('')),
    focus: () => (chosen()[0] ?? boxes[0]).focus(),
    // Nothing is chosen and nothing said; what was typed may be mended.
    renew() {
      for (const box of boxes) box.checked = false;
      say();
      boxes[0].focus();
      if (ofText) boxes[0].select();
    },
    show({ given, tone, word, rows }) {
      for (const box of boxes) {
        if (ofText) box.value = given;
        else box.checked = given.includes(box.value);
      }
      const verdict = element('p', { className: 'labkit-quiz-verdict' }, signOf(tone), word);
      verdict.dataset.tone = tone;
      say(verdict);
      told.append(...rows.map(([label, text]) => explain(label, text, tone === 'good')));
    },
  };
}

function render({ model, el }) {
  const { send, end: leaveKernel } = makeForm(model, el, 'labkit-quiz', () => {
    stopWaiting();
    mark();
  });
  el.classList.add('labkit-form-framed');
  const questions = model.get('questions');
  const end = questions.length;
  const answerTo = (index) => model.get('answers')[String(index + 1)];
  const toneOf = (index) => answerTo(index)?.tone ?? '';
  const isOpen = (index) => toneOf(index) !== 'good';
  const all = [...questions.keys()];
  const firstOpen = (from) => all.find((index) => index >= from && isOpen(index)) ?? end;
  let [at, waiting, shown] = [firstOpen(0), 0, {}];

  const main = all.map(() => element('button', { type: 'submit', className: 'labkit-quiz-main' }));
  const renewed = new Set();
  const again = all.map(() => element('button', { type: 'button' }, 'Try again'));
  const cards = questions.map((question, index) => {
    const back = button('Back', () => go(index - 1));
    back.disabled = index === 0;
    const skip = button('Skip', () => go(index + 1));
    again[index].addEventListener('click', () => {
      renewed.add(index);
      cards[index].renew();
      mark();
    });
    const buttons = [main[index], again[index], back, skip];
    const card = questionForm(question, `${index + 1} of ${end}`, buttons);
    card.form.addEventListener('input', mark);
    card.form.addEventListener('submit', (event) => {
      event.preventDefault();
      submit(index);
    });
    return card;
  });
  const steps = all.map((index) => button(`${index + 1}`, () => go(index), 'labkit-quiz-step'));
  const ending = button('Results', () => go(end), 'labkit-quiz-step');
  const stage = element('div');

  // An answer of an earlier session comes without its reasons: it may be given again.
  const isJudged = (index) => {
    const answer = answerTo(index);
    return Boolean(answer?.rows.length) && ['good', 'bad'].includes(answer.tone)
      && answer.given === cards[index].given() && !renewed.has(index);
  };

  function mark() {
    [...steps, ending].forEach((step, index) => {
      if (index === at) step.setAttribute('aria-current', 'step');
      else step.removeAttribute('aria-current');
    });
    steps.forEach((step, index) => {
      step.dataset.tone = toneOf(index);
      step.title = `Question ${index + 1}: ${WORDS[toneOf(index)]}`;
      step.setAttribute('aria-label', step.title);
      step.replaceChildren(`${index + 1}`, signOf(toneOf(index)));
      const on = firstOpen(index + 1) === end ? 'Results' : 'Next question';
      setText(main[index], isJudged(index) ? on : 'Check this answer');
      again[index].hidden = !isJudged(index) || !isOpen(index);
    });
    if (waiting) setText(main[at], 'Checking ...');
  }

  function results() {
    const missing = all.filter(isOpen).length;
    const title = element('p', { className: 'labkit-quiz-title', tabIndex: -1 },
      element('strong', {}, 'Results: '), `${end - missing} of ${end} right`);
    const lines = questions.map((question, index) => {
      const tone = toneOf(index);
      const state = element('span', { className: 'labkit-quiz-state' }, signOf(tone), WORDS[tone]);
      state.dataset.tone = tone;
      return element('li', {}, state, button(question.text, () => go(index), 'labkit-quiz-link'));
    });
    const what = missing === 1 ? 'the one that is' : `the ${missing} that are`;
    const again = button(`Try ${what} missing`, () => go(firstOpen(0)), 'labkit-quiz-main');
    const list = element('ol', { className: 'labkit-quiz-list' }, ...lines);
    return [title, list, ...(missing ? [again] : [])];
  }

  function show() {
    stage.replaceChildren(...(at < end ? [cards[at].form] : results()));
    mark();
  }

  function go(index) {
    at = index;
    show();
    if (at < end) cards[at].focus();
    else stage.querySelector('.labkit-quiz-title').focus();
  }

  function stopWaiting() {
    clearTimeout(waiting);
    waiting = 0;
  }

  function submit(index) {
    if (waiting) return;
    const answer = cards[index].given();
    if (isJudged(index)) go(firstOpen(index + 1));
    else if (!answer.trim()) cards[index].say('Choose or write an answer first.');
    else {
      const giveUp = () => {
        stopWaiting();
        cards[index].say(GONE);
        mark();
      };
      waiting = setTimeout(giveUp, QUIET_MS);
      mark();
      send({ number: index + 1, answer });
    }
  }

  function take() {
    for (const index of all) {
      const answer = answerTo(index);
      if (answer && shown[index] !== answer.count) {
        shown[index] = answer.count;
        renewed.delete(index);
        cards[index].show(answer);
        stopWaiting();
      }
    }
    if (at === end) show();
    else mark();
  }

  const bar = element('div', { className: 'labkit-form-row labkit-quiz-steps' }, ...steps, ending);
  bar.setAttribute('role', 'group');
  bar.setAttribute('aria-label', 'Questions of the quiz');
  const keys = 'Enter answers, and goes on. Esc leaves the quiz.';
  el.append(bar, stage, toldKeys(keys));
  show();
  take();
  model.on('change:answers', take);
  const leave = takeKeyboard(model, el, () => {
    if (at < end) cards[at].focus();
  });
  return () => {
    leave();
    stopWaiting();
    model.off('change:answers', take);
    leaveKernel();
  };
}

export default { render };
