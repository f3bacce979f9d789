// Pictures for paper: in the light colours, with title, rig, date and version.

import { html, svg } from './svg.js';

/** The text on every picture that says where it is from. */
const origin = { rig: '', version: '' };

/** Tells the pictures of another rig, or of the version of the program. */
export function describePictures(changes) {
  Object.assign(origin, changes);
}

/** Does something while the page has its light colours. */
export function inColoursOfPaper(work) {
  const { dataset } = document.documentElement;
  const before = dataset.scheme;
  dataset.scheme = 'light';
  try {
    return work();
  } finally {
    if (before === undefined) delete dataset.scheme;
    else dataset.scheme = before;
  }
}

/** The page is light as long as it is printed; `redraw()` draws what is on canvases. */
export function onPrint(redraw) {
  addEventListener('beforeprint', () => {
    document.documentElement.dataset.scheme = 'light';
    redraw();
  });
  addEventListener('afterprint', () => {
    delete document.documentElement.dataset.scheme;
    redraw();
  });
}

/** Height of the lines above a picture, pixels. */
export const HEAD = 46;

/** The lines above a picture: what it shows, and where it is from. */
export function headOf(title) {
  const date = new Date().toISOString().slice(0, 10);
  return [title, [origin.rig, date, `pneudrive ${origin.version}`].join(' · ')];
}

/** What a style sheet says of a drawing. */
const STYLE = ['fill', 'fill-opacity', 'stroke', 'stroke-width', 'stroke-dasharray', 'stroke-opacity', 'paint-order', 'opacity', 'font-size',
  'font-family', 'font-weight', 'text-anchor', 'dominant-baseline', 'display', 'visibility'];

/** An SVG element of the page as one that needs no style sheet. */
export function standalone(element) {
  const copy = element.cloneNode(true);
  const all = (root) => [root, ...root.querySelectorAll('*')];
  const copies = all(copy);
  inColoursOfPaper(() => all(element).forEach((one, k) => {
    const style = getComputedStyle(one);
    for (const name of STYLE) copies[k].setAttribute(name, style.getPropertyValue(name));
  }));
  for (const one of copies) for (const name of ['class', 'tabindex', 'role', 'id']) one.removeAttribute(name);
  return copy;
}

/** A drawing with its head, on a white ground. */
export function withHead(drawing, title) {
  const { x, y, width, height } = drawing.viewBox.baseVal;
  const [first, second] = headOf(title);
  const text = (at, size, weight, words) => svg('text', { x: x + 8, y: y - HEAD + at, fill: '#17222d', stroke: 'none', 'font-size': size, 'font-family': 'sans-serif', 'font-weight': weight }, words);
  const whole = svg('svg', { viewBox: `${x} ${y - HEAD} ${width} ${height + HEAD}`, width, height: height + HEAD },
    svg('rect', { x, y: y - HEAD, width, height: height + HEAD, fill: '#ffffff' }), text(18, 15, 650, first), text(36, 11, 400, second));
  for (const [name, size] of Object.entries({ x, y, width, height })) drawing.setAttribute(name, size);
  whole.append(drawing);
  return whole;
}

/** Pictures one below the other with their head, as PNG; `parts` are `{ width, height, draw(context) }`. */
export function toPng(parts, title, { ground, text }, scale = devicePixelRatio) {
  const canvas = html('canvas');
  const width = Math.max(...parts.map((part) => part.width));
  const height = HEAD + parts.reduce((sum, part) => sum + part.height, 0);
  [canvas.width, canvas.height] = [width * scale, height * scale];
  const context = canvas.getContext('2d');
  context.scale(scale, scale);
  [context.fillStyle] = [ground];
  context.fillRect(0, 0, width, height);
  context.fillStyle = text;
  headOf(title).forEach((line, k) => {
    context.font = k === 0 ? '650 15px system-ui, sans-serif' : '11px system-ui, sans-serif';
    context.fillText(line, 8, k === 0 ? 18 : 36);
  });
  context.translate(0, HEAD);
  for (const part of parts) {
    context.save();
    part.draw(context);
    context.restore();
    context.translate(0, part.height);
  }
  return new Promise((resolve) => { canvas.toBlob(resolve, 'image/png'); });
}
