// Larger type in the notebook around this place, while the kernel says so.

function render({ model, el }) {
  const words = element('p', { className: 'labkit-projector-words' });
  words.setAttribute('role', 'status');
  el.append(words);
  const show = () => {
    setText(words, model.get('words'));
    el.closest('.jp-Notebook')?.classList.toggle('labkit-projector', model.get('on'));
  };
  model.on('change:on', show);
  model.on('change:words', show);
  // It is made before it has its place in the page.
  const placed = new ResizeObserver(show);
  placed.observe(el);
  show();
  return () => {
    placed.disconnect();
    model.off('change:on', show);
    model.off('change:words', show);
  };
}

export default { render };
