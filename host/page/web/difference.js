// Two rigs, key by key.

import { asked } from './dialog.js';
import { html } from './svg.js';

/**
 * Asks for the rig to compare with; resolves to its name, to '' for the file as it was opened, or to null. `chooseRun` is called
 * where the folder of a run is to be laid over the run of the page instead.
 */
export function askForOther(opened, names, chooseRun) {
  const options = names.filter((name) => name !== opened).map((name) => html('option', { value: name }, name));
  const choice = html('select', { id: 'other-rig' }, html('option', { value: '' }, `${opened} as it was opened`), ...options);
  const folder = html('button', { type: 'button', title: 'As simulate --out writes it; or drop it on the page' }, 'Run folder…');
  folder.addEventListener('click', () => {
    folder.closest('dialog').dispatchEvent(new Event('cancel'));
    chooseRun();
  });
  const content = [html('label', { for: 'other-rig' }, 'Compare this rig, key by key, with'), choice,
    html('p', {}, 'Or lay a simulated run over its curves: ', folder)];
  return asked('Compare', content, 'Compare', () => choice.value);
}

/** Shows where the rig of the page differs from another; resolves to true if the other's run is to lie under the curves. */
export function showDifferences({ names, differences }) {
  const content = differences.length ? [tableOf(names, differences)]
    : [html('p', {}, `${names[0]} and ${names[1]} have the same value in every key that their models use.`)];
  return asked(`${names[0]} and ${names[1]}`, content, `Show the run of ${names[1]}`, () => true, 'Close');
}

function tableOf(names, differences) {
  const head = ['Key', ...names, 'Unit', 'Difference'].map((name) => html('th', { scope: 'col' }, name));
  const rows = differences.map(({ key, unit, texts, percent }) => html('tr', {},
    html('th', { scope: 'row' }, key),
    ...texts.map((text) => html('td', { class: text === null ? 'absent' : null }, text ?? 'not used')),
    html('td', {}, unit),
    html('td', {}, percent === null ? '' : `${percent >= 0 ? '+' : ''}${percent.toFixed(3)} %`)));
  return html('table', { class: 'differences' }, html('thead', {}, html('tr', {}, ...head)), html('tbody', {}, ...rows));
}
