// A figure of a report: panels over one axis, each on a canvas, with a legend.

import { offer } from './export.js';
import { onPrint, toPng } from './paper.js';
import { scaleOf, ticks, tickText } from './scale.js';
import { html } from './svg.js';

/** Colours of curves that have none of their own, as in the reports. */
const COLOURS = ['#1f77b4', '#ff7f0e', '#2ca02c', '#d62728', '#9467bd', '#8c564b', '#e377c2', '#7f7f7f', '#bcbd22', '#17becf'];

const SIZE = { width: 860, height: 190, left: 64, right: 12, top: 8, bottom: 22 };

/** An element with all panels of a figure. */
export function chartOf(figure) {
  const ends = endsOf(figure.panels.flatMap((panel) => all(panel, 'x')), figure.logarithmic);
  const panels = figure.panels.map((panel) => panelOf(panel, figure, ends));
  const name = figure.heading || figure.panels[0]?.title || 'graph';
  const save = html('button', { type: 'button', class: 'save-picture', title: 'Save the picture', 'aria-label': `PNG: ${name}` }, 'PNG');
  save.addEventListener('click', async () => offer(`${name.replace(/[^\w-]+/g, '-')}.png`, await toPng([...panels.map(partOf), words(figure.across)], name, coloursOf(save), 2)));
  return html('figure', {}, html('figcaption', {}, figure.heading ?? '', save), ...panels, html('p', { class: 'across' }, figure.across));
}

function coloursOf(element) {
  const style = getComputedStyle(element);
  return { ground: style.getPropertyValue('--surface'), text: style.getPropertyValue('--text') };
}

/** A line of text in a picture. */
function words(text, height = 20) {
  return { width: SIZE.width, height, draw: (context) => {
    context.font = '12px system-ui, sans-serif';
    context.fillText(text, SIZE.left, height - 6);
  } };
}

/** A panel as a part of a picture: its title, its canvas, its legend. */
function partOf(panel) {
  const [title, canvas, ...entries] = panel.querySelectorAll('h4, canvas, li');
  const height = 20 + SIZE.height + 20;
  return { width: SIZE.width, height, draw: (context) => {
    words(title.textContent).draw(context);
    context.drawImage(canvas, 0, 20, SIZE.width, SIZE.height);
    let x = SIZE.left;
    for (const entry of entries) {
      context.fillStyle = entry.firstChild.style.color;
      context.fillRect(x, height - 11, 12, 3);
      context.fillStyle = getComputedStyle(entry).color;
      context.fillText(entry.lastChild.textContent, x + 16, height - 6);
      x += 34 + context.measureText(entry.lastChild.textContent).width;
    }
  } };
}

/** Redraws each canvas, in other colours while the page is printed. */
const REDRAW = new WeakMap();

onPrint(() => document.querySelectorAll('figure canvas').forEach((canvas) => REDRAW.get(canvas)?.()));

function all({ curves, bands }, axis) {
  const names = axis === 'x' ? ['x'] : ['low', 'high'];
  return [...curves.map((curve) => curve[axis]), ...bands.flatMap((band) => names.map((name) => band[name]))];
}

/** The smallest and the largest number of many lists; null and, on a logarithmic axis, what is not above 0 do not count. */
function endsOf(lists, isLogarithmic) {
  let [low, high] = [Infinity, -Infinity];
  for (const list of lists) {
    for (const value of list) {
      if (value === null || (isLogarithmic && value <= 0)) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (low > high) return isLogarithmic ? [1, 10] : [0, 1];
  if (isLogarithmic) return [low / 1.1, high * 1.1];
  const air = 0.04 * (high - low) || Math.abs(high) * 0.05 || 1;
  return [low - air, high + air];
}

function panelOf(panel, figure, across) {
  const canvas = html('canvas', { width: 2 * SIZE.width, height: 2 * SIZE.height, role: 'img', 'aria-label': `${panel.title}, ${figure.heading}` });
  const inColours = () => ({
    curves: panel.curves.map((curve, k) => ({ ...curve, colour: onGround(curve.colour ?? COLOURS[k % COLOURS.length]) })),
    bands: panel.bands.map((band) => ({ ...band, colour: onGround(band.colour) })),
  });
  const redraw = () => {
    canvas.width = 2 * SIZE.width;
    draw(canvas.getContext('2d'), { ...panel, ...inColours() }, figure, across);
  };
  REDRAW.set(canvas, redraw);
  redraw();
  const { curves: coloured, bands } = inColours();
  return html('div', { class: 'panel' }, html('h4', {}, panel.title), canvas, legend([...bands, ...coloured]));
}

/** A colour of a printed report, lighter where the ground is dark. */
function onGround(colour) {
  const isLight = document.documentElement.dataset.scheme === 'light' || !matchMedia('(prefers-color-scheme: dark)').matches;
  if (isLight) return colour;
  const parts = [1, 3, 5].map((at) => Number.parseInt(colour.slice(at, at + 2), 16));
  return `rgb(${parts.map((part) => Math.round(part + 0.5 * (255 - part))).join(' ')})`;
}

function legend(entries) {
  const names = new Map(entries.filter(({ name }) => name).map((entry) => [`${entry.name} ${entry.colour}`, entry]));
  return html('ul', { class: 'legend' }, ...[...names.values()].map(({ name, colour, look }) => {
    const mark = html('span', { class: 'mark', 'aria-hidden': 'true' }, look === 'points' ? '●' : look.startsWith('dashed') ? '╌' : '━');
    mark.style.color = colour;
    return html('li', {}, mark, ` ${name}`);
  }));
}

/** From numbers to pixels, with ticks. */
function axisOf([low, high], isLogarithmic, from, to, count) {
  if (!isLogarithmic) {
    const values = ticks(low, high, count);
    const step = values[1] - values[0];
    return { at: scaleOf(low, high, from, to), ticks: values.map((value) => [value, tickText(value, step)]) };
  }
  const scale = scaleOf(Math.log10(low), Math.log10(high), from, to);
  const first = Math.ceil(Math.log10(low));
  const powers = Array.from({ length: Math.max(Math.floor(Math.log10(high)) - first + 1, 0) }, (_, k) => 10 ** (first + k));
  return { at: (value) => (value > 0 ? scale(Math.log10(value)) : NaN), ticks: powers.map((value) => [value, String(Number(value.toPrecision(3)))]) };
}

function draw(context, panel, figure, across) {
  context.scale(2, 2);
  const { width, height, left, right, top, bottom } = SIZE;
  const x = axisOf(across, figure.logarithmic, left, width - right, 9);
  const y = axisOf(endsOf(all(panel, 'y'), panel.logarithmic), panel.logarithmic, height - bottom, top, 5);
  drawGrid(context, x, y);
  context.beginPath();
  context.rect(left, top, width - left - right, height - top - bottom);
  context.clip();
  for (const band of panel.bands) fill(context, band, x.at, y.at);
  for (const curve of panel.curves) (curve.look === 'points' ? dots : line)(context, curve, x.at, y.at);
}

function drawGrid(context, x, y) {
  const { width, height, left, right, top, bottom } = SIZE;
  const style = getComputedStyle(document.documentElement);
  context.strokeStyle = style.getPropertyValue('--grid');
  context.fillStyle = style.getPropertyValue('--muted');
  context.font = '11px system-ui, sans-serif';
  context.beginPath();
  [context.textAlign, context.textBaseline] = ['right', 'middle'];
  for (const [value, text] of y.ticks) {
    context.moveTo(left, y.at(value));
    context.lineTo(width - right, y.at(value));
    context.fillText(text, left - 6, y.at(value));
  }
  [context.textAlign, context.textBaseline] = ['center', 'top'];
  for (const [value, text] of x.ticks) {
    context.moveTo(x.at(value), top);
    context.lineTo(x.at(value), height - bottom);
    context.fillText(text, x.at(value), height - bottom + 5);
  }
  context.stroke();
}

/** A curve; a value that is not a number leaves a gap. */
function line(context, { x, y, colour, look }, acrossAt, upAt) {
  context.strokeStyle = colour;
  context.lineWidth = 1.3;
  context.setLineDash(look.startsWith('dashed') ? [5, 4] : []);
  context.beginPath();
  let before = null;
  for (let k = 0; k < x.length; k += 1) {
    const [across, up] = x[k] === null || y[k] === null ? [NaN, NaN] : [acrossAt(x[k]), upAt(y[k])];
    if (Number.isNaN(across + up)) {
      before = null;
      continue;
    }
    if (before === null) context.moveTo(across, up);
    else if (look.endsWith('steps')) context.lineTo(across, before);
    context.lineTo(across, up);
    before = up;
  }
  context.stroke();
  context.setLineDash([]);
}

function dots(context, { x, y, colour }, acrossAt, upAt) {
  context.fillStyle = colour;
  for (let k = 0; k < x.length; k += 1) {
    if (x[k] === null || y[k] === null) continue;
    context.beginPath();
    context.arc(acrossAt(x[k]), upAt(y[k]), x.length > 500 ? 1.2 : 3, 0, 2 * Math.PI);
    context.fill();
  }
}

function fill(context, { x, low, high, colour }, acrossAt, upAt) {
  const points = [...x.map((value, k) => [value, low[k]]), ...x.map((value, k) => [value, high[k]]).reverse()];
  context.fillStyle = colour;
  context.globalAlpha = 0.2;
  context.beginPath();
  for (const [across, up] of points) if (across !== null && up !== null) context.lineTo(acrossAt(across), upAt(up));
  context.fill();
  context.globalAlpha = 1;
}
