// A class: who is where, what is passed, what fails most, and for the teacher alone, who is who.

const FIGURES = ['sharing', 'at work', 'stuck'];
const HEADS = ['Learner', 'Lesson', 'Passed', 'Last check', 'Stuck', 'Last sign', 'Last two hours', 'Remark'];
const MOST_DOTS = 40;
const STRIP_MIN = 120; // see counting.py
const [STRIP_WIDTH, STRIP_HEIGHT] = [120, 16];

function titled(title, ...children) {
  return element('section', {}, element('h4', { textContent: title }), ...children);
}

function heads(names) {
  const cells = names.map((name) => element('th', { textContent: name, scope: 'col' }));
  return element('thead', {}, element('tr', {}, ...cells));
}

function cell(text, className = '') {
  return element('td', { textContent: text, className });
}

// Wide tables scroll, by keyboard, too.
function scrolling(label, table) {
  const box = element('div', { className: 'labkit-classroom-scroll', tabIndex: 0 }, table);
  box.setAttribute('role', 'region');
  box.setAttribute('aria-label', label);
  return box;
}

// A bar with two parts, and the same in words.
function exerciseBar([name, passed, tried], all) {
  const part = (count, kind) => {
    const made = element('span', { className: `labkit-classroom-${kind}` });
    made.style.width = `${(100 * count) / Math.max(all, 1)}%`;
    return made;
  };
  const bar = element('span', { className: 'labkit-classroom-bar' }, part(passed, 'passed'), part(tried, 'tried'));
  bar.setAttribute('aria-hidden', 'true');
  const trying = tried ? `, ${tried} trying` : '';
  return element('li', {},
    element('span', { className: 'labkit-classroom-exercise', textContent: name }), bar,
    element('span', { className: 'labkit-classroom-count', textContent: `${passed} passed${trying}` }));
}

function lessonRow([title, here, exercises], all) {
  const dots = element('span', { className: 'labkit-classroom-dots', textContent: '●'.repeat(Math.min(here, MOST_DOTS)) });
  dots.setAttribute('aria-hidden', 'true');
  return element('tr', {},
    element('th', { textContent: title, scope: 'row' }),
    element('td', {}, element('strong', { textContent: here || '–' }), dots),
    element('td', {}, element('ul', {}, ...exercises.map((one) => exerciseBar(one, all)))));
}

function minutes(count) {
  if (count === null) return '';
  if (count < 120) return `${count} min`;
  return count < 2880 ? `${Math.floor(count / 60)} h` : `${Math.floor(count / 1440)} days`;
}

// When somebody was at work: a line while the lesson was open, up to the last sign; a stroke for a
// try, a dot for a pass. Now is at the right.
function strip(since, quiet, marks) {
  const x = (ago) => STRIP_WIDTH - 4 - ((STRIP_WIDTH - 8) * Math.min(ago, STRIP_MIN)) / STRIP_MIN;
  const [middle, radius] = [STRIP_HEIGHT / 2, 4];
  const passed = marks.filter(([, isPassed]) => isPassed).length;
  const svg = svgElement('svg', {
    width: STRIP_WIDTH, height: STRIP_HEIGHT, role: 'img', class: 'labkit-classroom-strip',
    'aria-label': `${passed} passed, ${marks.length - passed} tried`,
  });
  svg.append(svgElement('path', { class: 'ground', d: `M4 ${middle}H${STRIP_WIDTH - 4}` }));
  if (since !== null && quiet !== null && quiet < STRIP_MIN) {
    svg.append(svgElement('path', { class: 'open', d: `M${x(since)} ${middle}H${x(quiet) + 0.5}` }));
  }
  marks.forEach(([ago, isPassed]) => svg.append(isPassed
    ? svgElement('circle', { class: 'passed', cx: x(ago), cy: middle, r: radius })
    : svgElement('path', { class: 'tried', d: `M${x(ago)} 2V${STRIP_HEIGHT - 2}` })));
  return element('td', {}, svg);
}

function learnerRow([name, lesson, passed, exercise, last, stuck, quiet, since, marks, remark]) {
  const row = element('tr', {},
    element('th', { textContent: name, scope: 'row', dir: 'auto' }),
    cell(lesson), cell(passed, 'labkit-classroom-figure'),
    cell([exercise, last].filter(Boolean).join(' ')),
    cell(minutes(stuck), 'labkit-classroom-figure labkit-classroom-stuck'),
    cell(quiet === null ? '' : `${minutes(quiet)} ago`, 'labkit-classroom-figure'),
    strip(since, quiet, marks),
    cell(remark, 'labkit-classroom-remark'));
  row.classList.toggle('labkit-classroom-warned', stuck !== null);
  return row;
}

function failRow([count, exercise, sentence]) {
  const learners = count === 1 ? '1 learner' : `${count} learners`;
  return element('li', {},
    element('span', { className: 'labkit-classroom-many', textContent: learners }),
    element('div', {},
      element('span', { className: 'labkit-classroom-where', textContent: exercise }),
      element('span', { textContent: sentence })));
}

// How many guessed each answer before its cell was run, and after it. A star is what came.
function guessItem([title, ask, options, came]) {
  const all = [1, 2].map((at) => options.reduce((sum, option) => sum + option[at], 0));
  const bar = (count, sum, when) => {
    const part = element('span', { className: 'labkit-classroom-passed' });
    part.style.width = `${(100 * count) / Math.max(sum, 1)}%`;
    const made = element('span', { className: 'labkit-classroom-bar' }, part);
    made.setAttribute('aria-hidden', 'true');
    return [made, element('span', { className: 'labkit-classroom-count', textContent: `${count} ${when}` })];
  };
  const rows = options.map(([option, before, after], index) => element('li', {},
    element('span', { className: 'labkit-classroom-option' }, ...rich(`${option}${index === came ? ' ★' : ''}`)),
    ...bar(before, all[0], 'before'), ...(all[1] ? bar(after, all[1], 'after') : [])));
  return element('li', {},
    element('span', { className: 'labkit-classroom-where', textContent: title }),
    element('span', {}, ...rich(ask)), element('ul', {}, ...rows));
}

function render({ model, el }) {
  el.classList.add('labkit-live', 'labkit-classroom');
  el.setAttribute('role', 'group');
  el.setAttribute('aria-label', 'Class');
  const numbers = FIGURES.map(() => element('dd', { textContent: '–' }));
  const figures = element('dl', {}, ...FIGURES.map((name, index) => element('div', {},
    element('dt', { textContent: name }), numbers[index])));
  const lessonBody = element('tbody');
  const lessons = titled('Lessons', scrolling('Lessons', element('table', {},
    heads(['Lesson', 'Here now', 'Exercises']), lessonBody)));
  const failList = element('ol');
  const fails = titled('Fails most often, and is not passed yet', failList);
  const guessList = element('ol', { className: 'labkit-classroom-guesses' });
  const guesses = titled('Guesses (★ is what came)', guessList);
  const learnerBody = element('tbody');
  const learners = titled('Learners', scrolling('Learners', element('table', {}, heads(HEADS), learnerBody)));
  const told = element('p', { className: 'labkit-classroom-told' });
  let shown = {};
  const { note, end } = follow(model, el, (news) => {
    shown = { ...shown, ...news };
    news.figures?.forEach((count, index) => setText(numbers[index], `${count}`));
    if (news.lessons || news.figures) {
      lessonBody.replaceChildren(...(shown.lessons ?? []).map((row) => lessonRow(row, shown.figures[0])));
    }
    if (news.fails) failList.replaceChildren(...news.fails.map(failRow));
    if (news.guesses) guessList.replaceChildren(...news.guesses.map(guessItem));
    if (news.learners !== undefined) learnerBody.replaceChildren(...(news.learners ?? []).map(learnerRow));
    if (news.told !== undefined) setText(told, news.told);
    figures.hidden = !shown.figures?.[0];
    lessons.hidden = !shown.lessons?.length;
    fails.hidden = !shown.fails?.length;
    guesses.hidden = !shown.guesses?.length;
    learners.hidden = !shown.learners?.length;
  });
  for (const part of [figures, lessons, fails, guesses, learners]) part.hidden = true;
  el.append(figures, note, lessons, fails, guesses, learners, told);
  return end;
}

export default { render };
