// What the drive does, in a sentence; what that rests on, behind a click; and the figures of the moves.

import { html } from './svg.js';

/** The elements of the figures: `verdict`, whose summary is the sentence, and `table`. */
export class Figures {
  #verdict;
  #table;

  constructor(verdict, table) {
    [this.#verdict, this.#table] = [verdict, table];
    this.clear();
  }

  /** Takes away what is of the rig before. */
  clear() {
    this.#verdict.replaceChildren();
    this.#table.replaceChildren();
  }

  /** Shows figures that rest on one run, while its members are computed. */
  showAlone({ verdict, figures, fault }) {
    this.#tell('pending', 'One run', verdict, fault, ['The perturbed runs of this run are being computed.']);
    this.#table.replaceChildren(tableOf(figures, true));
  }

  /** Shows figures with their ranges over the run and its members, and whether the run has converged. */
  showJudged({ verdict, figures, notes, converged, remarks }, fault) {
    const [run, convergence, ...others] = notes;
    const doubt = converged ? '' : convergence.split(': ')[0];
    this.#tell(converged ? 'converged' : 'unconverged', doubt, verdict, fault, [convergence, ...others, run].map((note) => `${note}.`), remarks);
    this.#table.replaceChildren(tableOf(figures, false));
  }

  /** Shows the figures of the records themselves below those of the run, and how far the run is from each record. */
  showRecords(records) {
    this.#table.querySelectorAll('table.recorded, table.deviation').forEach((table) => table.remove());
    const shown = (kind, table) => {
      const made = tableOf(table, false);
      made.className = kind;
      return made;
    };
    for (const { figures, deviation } of records) this.#table.append(shown('recorded', figures), shown('deviation', deviation));
  }

  /** Copies for a report, with what the figures rest on. */
  copies() {
    const copy = this.#verdict.cloneNode(true);
    copy.open = true;
    return [copy, ...[...this.#table.children].map((element) => element.cloneNode(true))];
  }

  /** First what makes the figures doubtful, then what the drive does. */
  #tell(kind, doubt, verdict, fault, basis, remarks = []) {
    const trip = fault ? `tripped at ${fault.at_s.toFixed(4)} s: ${fault.name}, ${fault.meaning}` : '';
    const first = [doubt, trip].filter(Boolean).map((text) => html('strong', {}, `${sentence(text)}. `));
    const isUnsound = kind === 'unconverged' || trip !== '';
    this.#verdict.className = `verdict ${kind}${isUnsound ? ' doubtful' : ''}`;
    this.#verdict.replaceChildren(html('summary', {}, ...first, html('span', { class: 'says' }, `${sentence(verdict)}.`)),
      ...[...basis, ...remarks].map((text) => html('p', { class: 'remark' }, sentence(text))));
  }
}

/** The text with a capital. */
function sentence(text) {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** A table as the answers have it. */
export function tableOf({ heading, columns, rows }, isPending) {
  const head = html('tr', {}, ...columns.map((name) => html('th', { scope: 'col' }, ...withUnit(name))));
  const body = rows.map(([first, ...cells]) => html('tr', { class: first.startsWith(' ') ? 'end' : 'move' },
    html('th', { scope: 'row' }, first.trim()), ...cells.map((cell) => html('td', {}, cell))));
  return html('table', { class: isPending ? 'pending' : null }, html('caption', {}, heading),
    html('thead', {}, head), html('tbody', {}, ...body));
}

/** The unit of a heading stands below it. */
function withUnit(name) {
  const at = name.lastIndexOf(', ');
  return at < 0 ? [name] : [name.slice(0, at), html('small', {}, name.slice(at + 2))];
}
