// The newest picture of a camera.

function render({ model, el }) {
  el.classList.add('labkit-live', 'labkit-image');
  el.setAttribute('role', 'group');
  const title = element('span', { className: 'labkit-image-topic' });
  const about = element('span', { className: 'labkit-image-about' });
  const picture = element('img', { alt: '', hidden: true });
  let [words, rate] = ['', ''];
  // For those who look on from outside, such as tests.
  picture.addEventListener('load', () => {
    el.dataset.pictures = Number(el.dataset.pictures ?? 0) + 1;
  });
  const { note, end } = follow(model, el, (news, buffers) => {
    if (news.topic) {
      setText(title, news.topic);
      el.setAttribute('aria-label', `Pictures of ${news.topic}`);
    }
    if (news.about !== undefined) words = news.about;
    if (news.rate !== undefined) ({ rate } = news);
    setText(about, [words, rate && `${rate} a second`].filter(Boolean).join(', '));
    if (news.text) picture.alt = news.text;
    if (buffers?.length) showJpeg(picture, buffers[0]);
  });
  el.append(element('div', { className: 'labkit-image-head' }, title, about), picture, note);
  return () => {
    end();
    showJpeg(picture, null);
  };
}

export default { render };
