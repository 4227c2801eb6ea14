// Runs the setup cell of a notebook, and then another cell, by the keys that a person would press:
// what stands in an output has no other way to run cells.
async function bringBack(cell) {
  const keys = { key: 'Enter', code: 'Enter', keyCode: 13, ctrlKey: true };
  const press = (target) => {
    target.focus({ preventScroll: true });
    // A command waits for the end of its key.
    for (const kind of ['keydown', 'keyup']) {
      target.dispatchEvent(new KeyboardEvent(kind, { ...keys, bubbles: true, cancelable: true }));
    }
  };
  // What runs is the cell that is active by then.
  const begins = (target) => new Promise((resolve) => {
    const watch = new MutationObserver(() => {
      watch.disconnect();
      resolve();
    });
    const prompt = target.querySelector('.jp-InputPrompt');
    watch.observe(prompt, { childList: true, characterData: true, subtree: true });
  });
  // JupyterLab keeps those cells in the page that are near its visible part.
  const until = (found) => new Promise((resolve) => {
    const look = () => (found() ? resolve() : requestAnimationFrame(look));
    look();
  });
  const notebook = cell.closest('.jp-Notebook');
  const outer = notebook.querySelector('.jp-WindowedPanel-outer') ?? notebook;
  const number = (each) => Number(each.dataset.windowedListIndex);
  const place = outer.scrollTop;
  outer.scrollTop = 0;
  await until(() => [...notebook.querySelectorAll('.jp-Cell')].some((each) => !number(each)));
  const code = [...notebook.querySelectorAll('.jp-CodeCell')];
  const setup = code.sort((a, b) => number(a) - number(b))[0];
  const begun = begins(setup);
  press(setup);
  await begun;
  outer.scrollTop = place;
  await until(() => cell.isConnected);
  if (setup !== cell) press(cell);
}

function bringBackButton() {
  const button = document.createElement('button');
  button.type = 'button';
  button.className = 'labkit-bring-back';
  button.textContent = 'Bring it back';
  button.title = 'Run the setup cell at the top, then this one';
  button.addEventListener('click', () => bringBack(button.closest('.jp-Cell')));
  return button;
}
