// What stands over the canvas of a map or a scene: its buttons; and how it comes into view.

// What makes a button: its text, its title, and what it does before all is drawn anew.
function overButton(redraw) {
  return (text, title, act) => {
    const made = element('button', { type: 'button', textContent: text, title });
    made.setAttribute('aria-label', title);
    made.addEventListener('click', () => {
      act();
      redraw();
    });
    return made;
  };
}

function fullScreenButton(make, el) {
  return make('Full screen', 'Full screen (key o)', () => {
    if (document.fullscreenElement) document.exitFullscreen();
    // With the keys, where they are beside it.
    else (keysBeside(el) ?? el).requestFullscreen();
  });
}

function dockButton(make, send) {
  return make('Dock', 'Keep it in the panel on the right (key k)', () => send({ dock: true }));
}

function buttonsOver(label, buttons) {
  const place = element('div', { className: 'labkit-over-buttons' }, ...buttons);
  place.setAttribute('role', 'group');
  place.setAttribute('aria-label', label);
  return place;
}

function showOver(dock, full, el) {
  dock.hidden = !el.closest('.jp-LabShell .jp-Notebook');
  setText(full, document.fullscreenElement ? 'Leave full screen' : 'Full screen');
}

// What holds this view and the keys of the same cell; nothing if there are none.
function keysBeside(el) {
  const area = el.closest('.jp-OutputArea');
  return area?.querySelector('.labkit-teleop') ? area : null;
}

// A cell that was run just now lets what it shows come into view, unless one has gone on.
function comeIntoView(el) {
  const number = (cell) => Number(cell?.dataset.windowedListIndex ?? NaN);
  const cell = el.closest('.jp-Notebook-cell');
  const active = cell?.parentElement.querySelector(':scope > .jp-mod-active');
  if (!(Math.abs(number(active) - number(cell)) <= 1)) return;
  const place = keysBeside(el) ?? el;
  const room = cell.closest('.jp-WindowedPanel-outer') ?? document.documentElement;
  const fits = place.offsetHeight <= room.clientHeight;
  place.scrollIntoView({ block: fits ? 'nearest' : 'start' });
}
