// The spectrum of a channel: of the run, and of the records over it.

import { told } from './dialog.js';
import { tableOf } from './figures.js';
import { saveButton } from './save-picture.js';
import { scaleOf, ticks, tickText } from './scale.js';
import { html, svg } from './svg.js';

const CHANNELS = ['position', 'velocity', 'acceleration', 'pressure 1', 'pressure 2', 'spool', 'command', 'error'];
const [WIDTH, HEIGHT] = [720, 240];
const BOX = { left: 64, right: WIDTH - 12, top: 8, bottom: HEIGHT - 34 };
/** Amplitudes below the highest one by this factor are not drawn. */
const DECADES = 5;

/** Shows spectra in a dialog. `ask(channel, record)` gives one: of the run if there is no record. */
export function showSpectra(ask, records, interval) {
  const choice = html('select', { id: 'spectrum-channel' }, ...CHANNELS.map((name) => html('option', {}, name)));
  const result = html('div', { class: 'spectra', 'aria-live': 'polite' });
  const show = async () => {
    const channel = choice.value;
    try {
      const spectra = await Promise.all([null, ...records].map((record) => ask(channel, record)));
      if (choice.value === channel) result.replaceChildren(...content(spectra));
    } catch (error) {
      result.replaceChildren(html('p', { class: 'problem' }, error.message));
    }
  };
  choice.addEventListener('change', show);
  show();
  const about = html('p', {}, `${interval}. Hann window, the mean removed: a sine shows its amplitude, up to 15 % less between two frequencies. `
    + 'The simulation is one run, without its perturbed runs.');
  return told('Spectrum', [html('p', {}, html('label', { for: 'spectrum-channel' }, 'Channel '), choice), result, about]);
}

function content(spectra) {
  const tables = spectra.map(({ head }) => tableOf(head.peaks, false));
  const resolution = spectra.map(({ head }) => `${head.name}: ${head.samples} samples, one frequency per ${head.resolution_hz.toFixed(3)} Hz`);
  const drawn = picture(spectra);
  return [drawn, saveButton(drawn, drawn.getAttribute('aria-label')), html('p', { class: 'remark' }, `${resolution.join('; ')}.`), html('div', { class: 'peaks' }, ...tables)];
}

/** Amplitude on a logarithmic scale over frequency. */
function picture(spectra) {
  const highest = Math.max(...spectra.flatMap(({ columns }) => columns[0].values.reduce((most, value) => Math.max(most, value), 0)));
  const end = Math.max(...spectra.map(({ time }) => time.at(-1)));
  const top = highest > 0 ? Math.ceil(Math.log10(highest)) : 0;
  const x = scaleOf(0, end, BOX.left, BOX.right);
  const y = scaleOf(top - DECADES, top, BOX.bottom, BOX.top);
  const { name, unit } = spectra[0].columns[0];
  const curves = spectra.map(({ time, columns }, place) => svg('path', {
    class: place === 0 ? 'curve' : 'curve recorded', d: path(time, columns[0].values, x, y, top - DECADES),
  }));
  const label = `Amplitude of ${name}, ${unit}, over frequency, Hz`;
  return svg('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: 'img', 'aria-label': label },
    ...grid(x, y, end, top), ...curves, ...spectra.map(({ head }, place) => nameOf(head.name, place)),
    svg('text', { x: BOX.right, y: HEIGHT - 4, 'text-anchor': 'end' }, 'frequency, Hz'),
    svg('text', { x: 4, y: HEIGHT - 4 }, `amplitude, ${unit}`));
}

/** The name of a curve, beside a piece of it. */
function nameOf(name, place) {
  const y = BOX.top + 12 + 16 * place;
  return svg('g', {}, svg('path', { class: place === 0 ? 'curve' : 'curve recorded', d: `M${BOX.right - 210} ${y - 4}h24` }),
    svg('text', { class: 'name', x: BOX.right - 180, y }, name));
}

function path(frequencies, amplitudes, x, y, lowest) {
  const log = (amplitude) => Math.max(Math.log10(amplitude), lowest);
  // The first frequency is the mean, which is removed.
  const points = Array.from(amplitudes.subarray(1), (amplitude, k) => `${x(frequencies[k + 1]).toFixed(1)} ${y(log(amplitude)).toFixed(1)}`);
  return `M${points.join('L')}`;
}

function grid(x, y, end, top) {
  const frequencies = ticks(0, end, 8);
  const step = frequencies[1] - frequencies[0];
  const upright = frequencies.flatMap((at) => [
    svg('path', { class: 'grid', d: `M${x(at)} ${BOX.top}V${BOX.bottom}` }),
    svg('text', { x: x(at), y: BOX.bottom + 14, 'text-anchor': 'middle' }, tickText(at, step)),
  ]);
  const level = Array.from({ length: DECADES + 1 }, (_, k) => top - DECADES + k).flatMap((decade) => [
    svg('path', { class: 'grid', d: `M${BOX.left} ${y(decade)}H${BOX.right}` }),
    svg('text', { x: BOX.left - 6, y: y(decade) + 4, 'text-anchor': 'end' }, `1e${decade}`),
  ]);
  return [...upright, ...level];
}
