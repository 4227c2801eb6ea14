// What views share. It goes before their own code.

const ALIVE_MS = 2000; // see live_page.py
const QUIET_MS = 4000;

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

// Only what is new: a screen reader speaks what is set, even if it is the same.
function setText(place, text) {
  if (place.textContent !== text) place.textContent = text;
}

// JupyterLab's own keys (a, b, x, arrows) stay out of a view.
function keepKeys(el) {
  el.setAttribute('data-lm-suppress-shortcuts', 'true');
  el.addEventListener('keydown', (event) => event.stopPropagation());
}

// Hand over what the kernel sends, and tell the kernel that somebody looks on, again and again.
// Returns the place for what is wrong, what says it there, and what ends it all.
function follow(model, el, take) {
  keepKeys(el);
  const note = element('p', { className: 'labkit-live-note', hidden: true });
  note.setAttribute('role', 'status');
  let [heardAt, toldAt, ended, why] = [performance.now(), 0, '', ''];
  const tell = (view) => {
    toldAt = performance.now();
    model.send({ view });
  };
  const show = () => {
    const quiet = performance.now() - heardAt > QUIET_MS;
    setText(note, ended || (quiet
      ? 'The kernel says nothing. It may have been restarted or stopped: run this cell again.'
      : why));
    note.hidden = !note.textContent;
  };
  const say = (words) => {
    why = words;
    show();
  };
  const onMessage = (news, buffers) => {
    heardAt = performance.now();
    if (news.note !== undefined) why = news.note;
    if (news.ended) ended = news.ended;
    take(news, buffers);
    // For those who look on from outside, such as tests.
    el.dataset.updates = Number(el.dataset.updates ?? 0) + 1;
    show();
    // Not by the timer alone: in a tab that is not visible it may rest for a minute.
    if (heardAt - toldAt > ALIVE_MS && !ended) tell('there');
  };
  const watch = setInterval(() => {
    if (ended) return;
    if (performance.now() - toldAt > ALIVE_MS) tell('there');
    show();
  }, ALIVE_MS / 4);
  model.on('msg:custom', onMessage);
  // Several views may show the same.
  model.labkitViews = (model.labkitViews ?? 0) + 1;
  tell('seen');
  const end = () => {
    model.off('msg:custom', onMessage);
    clearInterval(watch);
    model.labkitViews -= 1;
    if (!model.labkitViews) model.send({ view: 'gone' });
  };
  return { note, say, end };
}
