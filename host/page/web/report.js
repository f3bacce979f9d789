// A printable page of what is shown: figures first, then the graphs.

import { html } from './svg.js';

/**
 * An HTML file that needs nothing beside it.
 *
 * `title` and `origins` are texts, `figures` elements, `graphs` an SVG element, `command` the line that makes the
 * same run, `style` the text of a style sheet.
 */
export function toReport({ title, origins, figures, graphs, command, style }) {
  const page = document.implementation.createHTMLDocument(title);
  page.documentElement.lang = 'en';
  page.head.prepend(html('meta', { charset: 'utf-8' }));
  page.body.append(
    html('h1', {}, title),
    html('p', { class: 'origins' }, `Values of the rig: ${origins}.`),
    html('section', {}, ...figures),
    html('figure', {}, graphs),
    html('p', { class: 'command' }, 'Equivalent command: ', html('code', {}, command)),
  );
  // The policy of this page forbids style within a page, so it comes in as text.
  const [before, after] = page.documentElement.outerHTML.split('</head>');
  return new Blob(['<!doctype html>\n', before, '<style>\n', style, '</style>\n</head>', after], { type: 'text/html' });
}
