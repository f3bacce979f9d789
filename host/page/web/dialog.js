// A question to the user: a few lines and buttons over the page.

import { html } from './svg.js';

/**
 * Asks; resolves to what `take` makes of the form if the user agrees, else to null.
 *
 * Every question has an element of its own: the close event of one question comes later than the buttons of the
 * next, and an agreement to the next must not be taken for one to this.
 */
export function asked(title, content, agree, take = () => true, decline = 'Cancel') {
  const cancel = html('button', { type: 'button', hidden: decline === '' }, decline);
  const form = html('form', { method: 'dialog' }, html('h2', { id: 'dialog-title' }, title), ...content,
    html('p', { class: 'buttons' }, cancel, html('button', { class: 'main' }, agree)), ...stopOf());
  const dialog = html('dialog', { id: 'dialog', 'aria-labelledby': 'dialog-title' }, form);
  document.body.append(dialog);
  dialog.showModal();
  return new Promise((resolve) => {
    const answer = (value) => {
      dialog.close();
      dialog.remove();
      resolve(value);
    };
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      answer(take(form));
    });
    cancel.addEventListener('click', () => answer(null));
    dialog.addEventListener('cancel', () => answer(null));
  });
}

/** The page behind a question takes no clicks, and a drive must be stopped in any case. */
function stopOf() {
  const stop = document.getElementById('stop');
  if (stop.hidden) return [];
  const button = html('button', { type: 'button', class: 'stop', title: stop.title }, stop.textContent);
  button.addEventListener('click', () => stop.click());
  return [button];
}

/** Shows a message: a text, or elements. */
export function told(title, content) {
  return asked(title, typeof content === 'string' ? [html('p', {}, content)] : content, 'OK', () => true, '');
}

/** Whether a question is open. */
export function isAsking() {
  return document.getElementById('dialog') !== null;
}
