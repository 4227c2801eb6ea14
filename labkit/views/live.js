// What views share. It goes before their own code.

const ALIVE_MS = 2000; // see live_page.py
const AGAIN_MS = 500;
const QUIET_MS = 4000;
const FOCUSABLE = '[tabindex="0"], button, input, select';
// A page that is narrower than this has no room for the list of files, a notebook and a panel side by
// side; one that is narrower than the second has none for a notebook and a panel.
const ROOM_FOR_FILES = 1200;
const ROOM_BESIDE = 900;
const GONE = 'The kernel is silent. If it was restarted or stopped, run the setup cell at the top, '
  + 'then this one.';

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

function svgElement(tag, attributes) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  Object.entries(attributes).forEach(([name, value]) => made.setAttribute(name, value));
  return made;
}

// Only what is new: a screen reader speaks what is set, even if it is the same.
function setText(place, text) {
  if (place.textContent !== text) place.textContent = text;
}

// A copy: the bytes may lie anywhere in the message, numbers only at multiples of their size.
function numbersOf(data, Kind = Float32Array) {
  return new Kind(data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength));
}

// Text with `code` in it, as elements.
function rich(text) {
  const parts = text.split('`');
  return parts.map((part, index) => (index % 2 ? element('code', {}, part) : part));
}

// The panel of `lab.dock()` that a view is in, if that can be seen.
function panelOf(el) {
  const panel = el.closest('.jupyterlab-sidecar');
  return panel?.offsetParent ? panel : null;
}

// From the panel back to a cell: the one where the keyboard was, or else the one that has docked
// the view, or is in front.
function leavePanel(model, el) {
  const from = el.closest('.jupyterlab-sidecar')?.labkitFrom;
  const docked = document.querySelector(`.jp-Cell .${CSS.escape(model.get('mark'))}`);
  const cells = [from?.isConnected && from, docked?.closest('.jp-Cell'),
    document.querySelector('.jp-Notebook:not(.lm-mod-hidden) .jp-Cell.jp-mod-active')];
  const back = cells.find(Boolean);
  if (back) back.focus();
  else document.activeElement.blur();
}

// F6 goes from a cell to the panel, to the keys of a robot if there are any, and back.
function changePlaces(event, model, el) {
  const panel = event.key === 'F6' && panelOf(el);
  if (!panel) return;
  event.preventDefault();
  // A notebook takes the focus back at each key that it hears; other views would go on.
  event.stopImmediatePropagation();
  if (panel.contains(document.activeElement)) {
    leavePanel(model, el);
    return;
  }
  panel.labkitFrom = document.activeElement.closest('.jp-Cell');
  (panel.querySelector('.labkit-teleop') ?? panel.querySelector(FOCUSABLE))?.focus();
}

// What every view is. Its stored form hides while it is there (see stored_form.py). JupyterLab's own keys
// (a, b, x, arrows) stay out of it, but for those that run its cell; Escape leaves it.
function makeView(model, el) {
  el.classList.add('labkit-view', model.get('mark'));
  const suppress = 'data-lm-suppress-shortcuts';
  el.setAttribute(suppress, 'true');
  const runs = (event) => event.key === 'Enter' && (event.shiftKey || event.ctrlKey || event.altKey);
  el.addEventListener('keydown', (event) => {
    // The cell gets the keys then, as with Escape in its code.
    const cell = el.closest('.jp-Cell');
    if (event.key === 'Escape' && cell) cell.focus({ preventScroll: true });
    else if (event.key === 'Escape') leavePanel(model, el);
    if (!runs(event)) event.stopPropagation();
  });
  // JupyterLab hears a key before the view does.
  const onWayDown = (event) => {
    if (el.contains(event.target)) el.toggleAttribute(suppress, !runs(event));
    changePlaces(event, model, el);
  };
  window.addEventListener('keydown', onWayDown, true);
  return () => window.removeEventListener('keydown', onWayDown, true);
}

// What sends to the kernel. When it can't be reached any more, for whatever reason, `lose` is
// called, and nothing is sent from then on.
function connect(model, lose) {
  let lost = false;
  const end = () => {
    if (lost) return;
    lost = true;
    lose();
  };
  // From a kernel that is restarted, JupyterLab's widgets are cut off.
  model.on('comm_live_update', end);
  const send = (content) => {
    if (lost) return;
    try {
      model.send(content);
    } catch {
      end();
    }
  };
  const disconnect = () => model.off('comm_live_update', end);
  return { send, disconnect };
}

// Show a JPEG, or nothing. The one before is let go.
function showJpeg(picture, bytes) {
  const before = picture.src;
  if (bytes) picture.src = URL.createObjectURL(new Blob([bytes], { type: 'image/jpeg' }));
  else picture.removeAttribute('src');
  picture.hidden = !bytes;
  if (before) URL.revokeObjectURL(before);
}

// Close the panel of `lab.dock()`, if this is in one. It is a widget of its own, and outlives the
// kernel: after a restart there would be two.
async function closePanel(model) {
  const panel = model.get('panel');
  if (!panel) return;
  try {
    const { views } = await model.widget_manager.get_model(panel);
    for (const view of Object.values(views ?? {})) (await view)._outputView?.dispose();
  } catch {
    // The kernel has closed it already.
  }
}

// Leave room for the notebook beside the panel of `lab.dock()`: in a narrow page the list of files is
// folded, as Ctrl B does, and in a very narrow one the panel lies under the notebook. Once for each
// panel: where somebody moves it, there it stays. Without labkit's settings of JupyterLab the page
// does not give its app away, and all stays where it is.
function makeRoom(el) {
  const watch = new ResizeObserver(() => {
    const panel = el.closest('.jupyterlab-sidecar');
    if (!el.isConnected) return;
    watch.disconnect();
    const { shell, commands } = window.jupyterapp ?? {};
    if (!panel || !shell || panel.dataset.labkitRoom) return;
    panel.dataset.labkitRoom = 'made';
    const files = document.querySelector('#jp-left-stack:not(.lm-mod-hidden)');
    if (window.innerWidth < ROOM_FOR_FILES && files) commands.execute('application:toggle-left-area');
    if (window.innerWidth >= ROOM_BESIDE) return;
    const widget = [...shell.widgets('right')].find((one) => one.node === panel);
    if (widget) shell.add(widget, 'main', { mode: 'split-bottom', activate: false });
  });
  watch.observe(el);
  return () => watch.disconnect();
}

// The place where a view says what is wrong. Under a cell whose kernel is gone it has a button.
function makeNote() {
  const back = bringBackButton();
  const note = element('p', { className: 'labkit-live-note', hidden: true }, element('span'), back);
  note.setAttribute('role', 'status');
  return note;
}

function sayIn(note, text) {
  const [words, back] = note.children;
  setText(words, text);
  back.hidden = text !== GONE || !note.closest('.jp-Cell');
  note.hidden = !text;
}

// Hand over what the kernel sends, and tell the kernel that somebody looks on, again and again.
// Returns the place for what is wrong, what says it there, what sends to the kernel, and what ends
// it all. A kernel that is gone ends the view as one that says so does.
function follow(model, el, take) {
  const unmake = makeView(model, el);
  const leave = makeRoom(el);
  const note = makeNote();
  let [heardAt, toldAt, complete, ended, why] = [performance.now(), 0, false, '', ''];
  // All there is to know is asked for until it comes: while a page is loaded, messages get lost.
  const tell = (view = complete ? 'there' : 'seen') => {
    toldAt = performance.now();
    send({ view });
  };
  const show = () => {
    const quiet = performance.now() - heardAt > QUIET_MS;
    sayIn(note, ended || (quiet ? GONE : why));
  };
  const say = (words) => {
    why = words;
    show();
  };
  const onMessage = (news, buffers) => {
    heardAt = performance.now();
    if (news.all) complete = true;
    if (news.ended) ended = news.ended;
    // Before that, news say what has changed since another page was told.
    if (!complete && !ended) {
      if (heardAt - toldAt > AGAIN_MS) tell();
      return;
    }
    if (news.note !== undefined) why = news.note;
    take(news, buffers);
    // For those who look on from outside, such as tests.
    el.dataset.updates = Number(el.dataset.updates ?? 0) + 1;
    show();
    // Not by the timer alone: in a tab that is not visible it may rest for a minute.
    if (heardAt - toldAt > ALIVE_MS && !ended) tell();
  };
  const { send, disconnect } = connect(model, () => {
    ended = GONE;
    take({ ended });
    show();
    closePanel(model);
  });
  const watch = setInterval(() => {
    if (ended) return;
    if (performance.now() - toldAt > ALIVE_MS) tell();
    show();
  }, ALIVE_MS / 4);
  model.on('msg:custom', onMessage);
  // Several views may show the same.
  model.labkitViews = (model.labkitViews ?? 0) + 1;
  // When the view is complete.
  queueMicrotask(tell);
  const end = () => {
    model.labkitViews -= 1;
    if (!model.labkitViews) tell('gone');
    model.off('msg:custom', onMessage);
    disconnect();
    unmake();
    leave();
    clearInterval(watch);
  };
  return { note, say, send, end };
}
