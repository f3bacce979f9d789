// One graph: a few channels of the same unit over time, of several runs.

import { placeOf, scaleOf, ticks, tickText } from './scale.js';

/** The graphs: a title, a unit, their curves, and their part of the height. Optional ones are there if a run has their curves. */
export const PANELS = [
  { id: 'position', unit: 'mm', curves: ['setpoint', 'position'], height: 1.5 },
  { id: 'pressures', unit: 'kPa', curves: ['pressure 1', 'pressure 2'], height: 1 },
  { id: 'spool', unit: 'mm', curves: ['wanted spool', 'spool'], height: 1 },
  { id: 'error', unit: 'counts', curves: ['error'], height: 1 },
  { id: 'command', unit: 'counts', curves: ['command'], height: 1 },
  { id: 'velocity', unit: 'mm/s', curves: ['velocity'], height: 1 },
  { id: 'acceleration', unit: 'm/s2', curves: ['acceleration'], height: 1 },
  { id: 'flows', unit: 'g/s', curves: ['flow 1', 'flow 2'], height: 1 },
  { id: 'temperatures', unit: 'K', curves: ['temperature 1', 'temperature 2'], height: 1 },
  { id: 'forces', unit: 'N', curves: ['piston force', 'friction'], height: 1 },
  { id: 'receiver', unit: 'kPa', curves: ['receiver pressure'], height: 1, optional: true },
  { id: 'reference', unit: 'mm', curves: ['reference', 'estimated'], height: 1, optional: true },
  { id: 'reference speed', unit: 'mm/s', curves: ['reference speed', 'estimated speed'], height: 1, optional: true },
  { id: 'law forces', unit: 'N', curves: ['wanted force', 'measured force', 'opposing force', 'standing force'], height: 2, optional: true },
  { id: 'learned mass', unit: 'kg', curves: ['learned mass'], height: 1, optional: true },
  { id: 'learned friction', unit: "of the file's", curves: ['learned friction'], height: 1, optional: true },
  { id: 'learned lag', unit: 'ms', curves: ['learned lag'], height: 1, optional: true },
  { id: 'phase', unit: '', curves: ['phase', 'looseness'], height: 1, optional: true },
];

/** Whether a graph has anything to draw. */
export function isThere(panel, runs) {
  return !panel.optional || runs.some((run) => panel.curves.some((name) => run.curves.has(name)));
}

/** Channels that hold their value until the next sample. */
const STEPS = new Set(['setpoint', 'command', 'phase', 'looseness']);

/** Draws a graph into a rectangle. `view` has `from` and `to` in s, `colours` by channel. */
export function drawPanel(context, panel, box, runs, view) {
  const x = scaleOf(view.from, view.to, box.left, box.right);
  const [low, high] = extent(panel, runs, view);
  const y = scaleOf(low, high, box.bottom, box.top);
  drawGrid(context, panel, box, view, { low, high, y });
  context.save();
  context.beginPath();
  context.rect(box.left, box.top - 2, box.right - box.left, box.bottom - box.top + 4);
  context.clip();
  for (const run of runs) {
    for (const name of panel.curves) drawCurve(context, run, name, x, y, view);
  }
  context.restore();
  return { panel, box, x, y };
}

/** The smallest and the largest value that is in view, with some air around them. */
function extent(panel, runs, view) {
  let [low, high] = [Infinity, -Infinity];
  const include = (values, first, end) => {
    for (let k = first; k < end; k += 1) {
      if (values[k] < low) low = values[k];
      if (values[k] > high) high = values[k];
    }
  };
  for (const run of runs) {
    const [first, end] = inView(run.time, view);
    for (const name of panel.curves) {
      if (run.curves.has(name)) include(run.curves.get(name), first, end);
      const band = run.band?.get(name);
      if (band) [band.low, band.high].forEach((edge) => include(edge, first, Math.min(end, edge.length)));
    }
  }
  if (low > high) return [-1, 1];
  const air = 0.06 * (high - low) || Math.abs(high) * 0.05 || 1;
  return [low - air, high + air];
}

/** The samples that are in view, and one on each side. */
function inView(time, view) {
  return [Math.max(placeOf(time, view.from) - 1, 0), Math.min(placeOf(time, view.to) + 2, time.length)];
}

function drawGrid(context, panel, box, view, { low, high, y }) {
  const { colours } = view;
  context.font = '11px system-ui, sans-serif';
  context.lineWidth = 1;
  const values = ticks(low, high, Math.max(2, Math.round((box.bottom - box.top) / 32)));
  const step = values[1] - values[0];
  context.textAlign = 'right';
  context.textBaseline = 'middle';
  for (const value of values) {
    const at = Math.round(y(value)) + 0.5;
    line(context, colours.grid, [box.left, at], [box.right, at]);
    context.fillStyle = colours.muted;
    context.fillText(tickText(value, step), box.left - 6, at);
  }
  for (const time of view.ticks) {
    const at = Math.round(scaleOf(view.from, view.to, box.left, box.right)(time)) + 0.5;
    line(context, colours.grid, [at, box.top], [at, box.bottom]);
  }
}

function line(context, colour, from, to) {
  context.strokeStyle = colour;
  context.beginPath();
  context.moveTo(...from);
  context.lineTo(...to);
  context.stroke();
}

function drawCurve(context, run, name, x, y, view) {
  const values = run.curves.get(name);
  if (!values) return;
  const colour = view.colours[name] ?? view.colours.text;
  const band = run.band?.get(name);
  if (band) fillBand(context, run.time, band, x, y, view, colour);
  context.strokeStyle = colour;
  context.globalAlpha = run.isGhost ? 0.38 : 1;
  context.lineWidth = run.isGhost ? 1 : 1.5;
  context.lineJoin = 'round';
  context.setLineDash(run.isRecord ? [5, 3] : []);
  context.beginPath();
  trace(context, run.time, values, inView(run.time, view), x, y, STEPS.has(name));
  context.stroke();
  context.setLineDash([]);
  context.globalAlpha = 1;
}

/** Samples in a pixel, above which only their least and their most are drawn. */
const DENSE = 2;

/** The path of a curve. Where many samples fall on a pixel, their least and their most give the same picture. */
function trace(context, time, values, [first, end], x, y, isStepped) {
  const isDense = end - first > DENSE * Math.abs(x(time[end - 1]) - x(time[first]));
  if (isDense) {
    byPixel(time, values, values, first, end, x, (at, low, high, isBehindGap) => {
      if (isBehindGap) context.moveTo(at, y(low));
      context.lineTo(at, y(low));
      context.lineTo(at, y(high));
    });
    return;
  }
  for (let k = first; k < end; k += 1) {
    // What is missing is left open.
    if (Number.isNaN(values[k])) continue;
    const at = x(time[k]);
    const isBehindGap = k > first && Number.isNaN(values[k - 1]);
    if (isBehindGap) context.moveTo(at, y(values[k]));
    else if (isStepped && k > first) context.lineTo(at, y(values[k - 1]));
    context.lineTo(at, y(values[k]));
  }
}

/** The least of `lows` and the most of `highs` of all samples on each pixel, and whether some are missing before it. */
function byPixel(time, lows, highs, first, end, x, take) {
  let pixel = NaN;
  let isBehindGap = false;
  let [low, high] = [Infinity, -Infinity];
  const give = () => {
    if (!(low <= high)) return;
    take(pixel, low, high, isBehindGap);
    [low, high, isBehindGap] = [Infinity, -Infinity, false];
  };
  for (let k = first; k < end; k += 1) {
    const at = Math.round(x(time[k]));
    const isMissing = Number.isNaN(lows[k]);
    if (at !== pixel || isMissing) give();
    pixel = at;
    if (isMissing) isBehindGap = true;
    if (lows[k] < low) low = lows[k];
    if (highs[k] > high) high = highs[k];
  }
  give();
}

/** The area that a run and its members cover. */
function fillBand(context, time, { low, high }, x, y, view, colour) {
  const [first, end] = inView(time, view);
  const upper = [];
  const lower = [];
  byPixel(time, low, high, first, Math.min(end, low.length), x, (at, least, most) => {
    lower.push([at, y(least)]);
    upper.push([at, y(most)]);
  });
  context.fillStyle = colour;
  context.globalAlpha = 0.22;
  context.beginPath();
  [...upper, ...lower.reverse()].forEach((point) => context.lineTo(...point));
  context.fill();
  context.globalAlpha = 1;
}
