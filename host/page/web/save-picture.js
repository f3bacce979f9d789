// A button that saves a drawing of the page.

import { offer, toFile } from './export.js';
import { standalone, withHead } from './paper.js';
import { html } from './svg.js';

/** Saves an SVG element with a title, in the colours of paper. */
export function saveButton(drawing, title) {
  const button = html('button', { type: 'button', class: 'save-picture', title: 'Save the picture', 'aria-label': `SVG: ${title}` }, 'SVG');
  button.addEventListener('click', () => offer(`${title.replace(/[^\w-]+/g, '-')}.svg`, toFile(withHead(standalone(drawing), title))));
  return button;
}
