// Puts a button on the code that it stands behind, which copies it. It needs no kernel; where a
// page lets no script of an output run, there is no button.
(() => {
  const place = document.currentScript.parentElement;
  const code = place.querySelector('pre');
  const button = document.createElement('button');
  const told = document.createElement('span');
  const say = (words) => {
    told.textContent = words;
    setTimeout(() => told.replaceChildren(), 4000);
  };
  button.type = 'button';
  button.textContent = 'Copy';
  button.style.cssText = 'font:inherit;padding:0 0.8em;border-radius:4px;cursor:pointer;'
    + 'color:inherit;background:var(--jp-layout-color1, transparent);'
    + 'border:1px solid var(--jp-border-color1, currentcolor)';
  told.setAttribute('role', 'status');
  told.style.marginLeft = '0.8em';
  button.addEventListener('click', async () => {
    try {
      await navigator.clipboard.writeText(code.textContent);
      say('Copied.');
    } catch {
      // Without https a page may not write there.
      getSelection().selectAllChildren(code);
      say('Selected: press Ctrl+C.');
    }
  });
  // JupyterLab would take Enter for the cell.
  place.setAttribute('data-lm-suppress-shortcuts', 'true');
  const row = document.createElement('div');
  row.style.marginTop = '0.5em';
  row.append(button, told);
  place.append(row);
})();
