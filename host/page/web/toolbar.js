// The buttons above the graphs: which of them are shown, how records lie over the run, and what is taken away.

import { writeAddress } from './address.js';
import { offer, toCsv, toFile } from './export.js';
import { PANELS, isThere } from './panel.js';
import { standalone, withHead } from './paper.js';
import { ALIGNMENTS } from './records.js';
import { toReport } from './report.js';
import { html } from './svg.js';

export class Toolbar {
  #plot;
  #callbacks;
  #records;
  #align;
  #toggles = [];
  /** The buttons of graphs that not every run has. */
  #optional = [];
  /** The buttons that need a run. */
  #ofRun;

  /** `callbacks` has `run()`, `name()`, `title()` and `picture()` for pictures, `described()` for a report, and `spectrum()`. */
  constructor(element, plot, records, callbacks) {
    this.#plot = plot;
    this.#records = records;
    this.#callbacks = callbacks;
    this.#align = this.#alignment();
    const [csv, report] = this.#ofRun = [
      button('CSV', 'The curves of this run as a table', () => this.#offer('csv', toCsv(callbacks.run()))),
      button('Report', 'Figures and graphs as a page to print', () => this.#report()),
    ];
    element.append(...PANELS.map((panel) => this.#toggle(panel)), this.#align,
      button('full range', 'Show all samples of the runs', () => plot.zoom(), 'plain'),
      button('Spectrum…', 'The frequency content of a channel over the visible part', () => callbacks.spectrum()),
      csv,
      button('PNG', 'The graphs as a picture', async () => this.#offer('png', await plot.toPng(callbacks.title()))),
      button('SVG', 'The graphs as a drawing, in the colours of paper', () => this.#offer('svg', toFile(withHead(plot.toSvg(), callbacks.title())))),
      button('Drive', 'A drawing of the drive at the cursor', () => this.#offer('drive.svg', toFile(withHead(standalone(callbacks.picture()), callbacks.title())))),
      report);
    this.update();
  }

  /** Shows what depends on the run and the records. */
  update() {
    this.#align.hidden = this.#records.all.length === 0;
    const run = this.#callbacks.run();
    for (const { panel, toggle } of this.#optional) toggle.hidden = run === null || !isThere(panel, [run]);
    for (const one of this.#ofRun) one.disabled = run === null;
  }

  /** Shows these graphs and no others. */
  showOnly(graphs) {
    for (const { id } of this.#toggles) if (this.#plot.isShown(id) !== graphs.includes(id)) this.#plot.toggle(id);
    this.#mark();
  }

  #mark() {
    for (const { id, toggle } of this.#toggles) toggle.setAttribute('aria-pressed', String(this.#plot.isShown(id)));
  }

  #toggle(panel) {
    const { id } = panel;
    const toggle = button(id, `The graph of ${id}`, () => {
      this.#plot.toggle(id);
      this.#mark();
      writeAddress({ graphs: this.#plot.shown });
    });
    this.#toggles.push({ id, toggle });
    toggle.setAttribute('aria-pressed', String(this.#plot.isShown(id)));
    if (panel.optional) this.#optional.push({ panel, toggle });
    return toggle;
  }

  #alignment() {
    const choice = html('select', { id: 'align', 'aria-label': 'Alignment of the records', hidden: true },
      ...ALIGNMENTS.map(([value, text]) => html('option', { value }, `records ${text}`)));
    choice.addEventListener('change', () => { this.#records.align = choice.value; });
    return choice;
  }

  #offer(kind, content) {
    offer(`${this.#callbacks.name().replace(/\.toml$/, '')}.${kind}`, content);
  }

  async #report() {
    const style = await (await fetch('report.css')).text();
    this.#offer('html', toReport({ ...this.#callbacks.described(), graphs: this.#plot.toSvg(), style }));
  }
}

function button(label, title, clicked, kind) {
  const made = html('button', { type: 'button', title, class: kind }, label);
  made.addEventListener('click', clicked);
  return made;
}
