// A question to the user: a few lines and buttons over the page.

import { html } from './svg.js';

/** Asks; resolves to what `take` makes of the form if the user agrees, else to null. */
export function asked(dialog, title, content, agree, take = () => true) {
  const cancel = html('button', { type: 'button' }, 'Cancel');
  const form = html('form', { method: 'dialog' }, html('h2', { id: 'dialog-title' }, title), ...content,
    html('p', { class: 'buttons' }, cancel, html('button', { class: 'main', value: 'agree' }, agree)));
  cancel.addEventListener('click', () => dialog.close(''));
  dialog.replaceChildren(form);
  dialog.returnValue = '';
  dialog.showModal();
  return new Promise((resolve) => {
    dialog.addEventListener('close', () => resolve(dialog.returnValue === 'agree' ? take(form) : null), { once: true });
  });
}

/** Tells something. */
export function told(dialog, title, text) {
  return asked(dialog, title, [html('p', {}, text)], 'OK');
}
