// The view of studies: a task, its progress, and its result.

import { showNothing, showReport } from './exhibit.js';
import { copyFrom, offer } from './export.js';
import { IdentifyForm } from './identify-form.js';
import { about } from './numbers.js';
import { parallelOf } from './parallel.js';
import { SweepForm } from './sweep-form.js';
import { TuneForm } from './tune-form.js';
import { html } from './svg.js';

const TASKS = {
  sweep: { title: 'Sweep', form: SweepForm, take: 'Use the best point', about: 'Varies keys and collects figures of the moves.' },
  tune: { title: 'Tune', form: TuneForm, take: 'Use these gains', about: 'Finds gains for a step over a spread of rigs.' },
  identify: { title: 'Identify', form: IdentifyForm, take: 'Use these values', about: 'Finds values of the rig from its records.' },
};

/** A pause of this length ends typing, ms. */
const PAUSE = 150;

/**
 * The panel of studies. `callbacks.rig()`, `callbacks.state()` and `callbacks.records()` are those of the page, and
 * `callbacks.port()` is the port of the rig. The panel calls `callbacks.take(settings)` with values to be taken over, and
 * `callbacks.open()` to have the user choose a file.
 */
export class Study {
  #exhibit;
  #server;
  #callbacks;
  #task = 'sweep';
  #forms = {};
  #parts = {};
  #end = null;
  #pause = 0;
  #asked = 0;
  #plan = {};
  /** Whether the problem that is shown is that of the plan: the next plan takes no other back. */
  #isOfPlan = false;
  /** What was found last: its button, the words beside it, what it takes over, and the rig it is of. */
  #offered = null;

  constructor(element, exhibit, server, callbacks) {
    this.#exhibit = exhibit;
    this.#server = server;
    this.#callbacks = callbacks;
    this.#build(element);
    showNothing(exhibit, 'The results of a study appear here: figures with their ranges, and graphs.');
  }

  /** Gets the forms ready. */
  async begin(keys) {
    const choices = await this.#server.get('/api/choices');
    const callbacks = { ...this.#callbacks, changed: () => this.#changed() };
    for (const [name, { form: Form }] of Object.entries(TASKS)) this.#forms[name] = new Form(keys, choices, callbacks);
    this.#choose('sweep');
  }

  /** Another rig is opened: what was chosen for the one before says nothing of it. */
  opened() {
    for (const form of Object.values(this.#forms)) form.opened?.();
  }

  /** The page has another rig, other values or other records. */
  show() {
    this.#weigh();
    const form = this.#forms[this.#task];
    if (!form || this.#parts.panel.hidden) return;
    form.show();
    this.#changed();
  }

  /** Finds the values of the rig from one record of the page; while another study is at work, that is shown. */
  identify(record) {
    if (this.#end) return;
    this.#choose('identify');
    this.#forms.identify.useOnly(record);
    this.#start();
  }

  #build(element) {
    const tasks = Object.entries(TASKS).map(([name, { title }]) => {
      const button = html('button', { type: 'button', 'data-task': name, 'aria-pressed': 'false' }, title);
      button.addEventListener('click', () => this.#choose(name));
      return button;
    });
    const start = html('button', { type: 'button', class: 'main', id: 'study-start' }, 'Start');
    start.addEventListener('click', () => (this.#end ? this.#end.abort() : this.#start()));
    const command = html('input', { id: 'study-command', readonly: true, spellcheck: 'false' });
    const copy = html('button', { type: 'button' }, 'Copy');
    copy.addEventListener('click', () => copyFrom(command, copy));
    const file = html('button', { type: 'button', hidden: true }, 'Save sweep.toml');
    file.addEventListener('click', () => offer(this.#plan.file.name, new Blob([this.#plan.file.text], { type: 'application/toml' })));
    const bar = html('progress', { max: 1, 'aria-label': 'Progress' });
    this.#parts = {
      panel: element, tasks, start, command, copy, file, bar,
      about: html('p', { class: 'remark' }), form: html('div', {}), size: html('small', { id: 'study-size' }),
      at: html('p', { id: 'study-at', role: 'status' }), problem: html('p', { class: 'problem', role: 'alert' }),
    };
    bar.hidden = true;
    this.#parts.excitation = html('p', { id: 'study-excitation', role: 'status' });
    element.replaceChildren(html('h2', {}, 'Study'), html('p', { class: 'row', role: 'group', 'aria-label': 'Task' }, ...tasks),
      this.#parts.about, this.#parts.form, html('p', { class: 'row' }, start, this.#parts.size), bar, this.#parts.at, this.#parts.problem, this.#parts.excitation,
      html('label', { for: 'study-command' }, 'Equivalent command'), html('p', { class: 'row' }, command, copy), html('p', {}, file));
  }

  #choose(name) {
    const { tasks, form, about: words, file, at, command, size, problem } = this.#parts;
    // The plan is that of another task.
    if (name !== this.#task) [this.#plan, command.value, size.textContent, problem.textContent, file.disabled] = [{}, '', '', '', true];
    this.#task = name;
    at.textContent = '';
    this.#parts.excitation.replaceChildren();
    for (const button of tasks) button.setAttribute('aria-pressed', String(button.dataset.task === name));
    words.textContent = TASKS[name].about;
    file.hidden = name !== 'sweep';
    form.replaceChildren(this.#forms[name].element);
    this.show();
  }

  /** The request for the present form. */
  #body() {
    return { study: this.#task, ...this.#callbacks.rig(), ...this.#forms[this.#task].body() };
  }

  #changed() {
    clearTimeout(this.#pause);
    // An answer that is on its way is of what was asked for before.
    this.#asked += 1;
    this.#pause = setTimeout(() => this.#ask(), PAUSE);
  }

  /** Asks what the study would be; an answer counts as long as nothing has changed since. */
  async #ask() {
    const number = this.#asked;
    const { command, size, problem, start } = this.#parts;
    try {
      const plan = await this.#server.post('/api/plan', this.#body());
      if (number !== this.#asked) return;
      this.#planned(plan);
      if (this.#isOfPlan) problem.textContent = '';
      start.disabled = false;
    } catch (error) {
      if (number !== this.#asked) return;
      [command.value, size.textContent, problem.textContent] = ['', '', reasonOf(error)];
      this.#isOfPlan = true;
      start.disabled = !this.#end;
    }
  }

  #planned(plan) {
    const { command, size, file } = this.#parts;
    this.#plan = plan;
    file.disabled = !plan.file;
    command.value = plan.command;
    size.textContent = plan.size;
    this.#forms[this.#task].planned?.(plan);
  }

  /** What is to be started, and its plan: what stands below the form may be that of what was typed before. */
  async #settle(signal) {
    clearTimeout(this.#pause);
    this.#asked += 1;
    for (;;) {
      const body = this.#body();
      const plan = await this.#server.post('/api/plan', body);
      signal.throwIfAborted();
      this.#planned(plan);
      // The plan tells which unknowns there are.
      if (JSON.stringify(this.#body().fit) === JSON.stringify(body.fit)) return { body, command: plan.command };
    }
  }

  async #start() {
    const task = this.#task;
    this.#end = new AbortController();
    const { signal } = this.#end;
    this.#working('Cancel', 'beginning…');
    try {
      const { body, command } = await this.#settle(signal);
      const begun = performance.now();
      const progress = new Progress(begun);
      const found = await this.#server.study(body, signal, (at) => this.#tell(progress.heard(at)));
      this.#working('Start', `done in ${((performance.now() - begun) / 1e3).toFixed(1)} s`);
      this.#found(task, command, body, found);
    } catch (error) {
      this.#working('Start', signal.aborted ? 'cancelled: nothing has changed' : '');
      if (!signal.aborted) [this.#parts.problem.textContent, this.#isOfPlan] = [reasonOf(error), false];
      if (!signal.aborted) this.#offerPlan();
    }
    this.#end = null;
  }

  /** An identification without an answer needs other records: those of a plan, which moves the drive so that its values show. */
  #offerPlan() {
    if (!this.#plan.excitation) return;
    const command = html('input', { id: 'study-plan', readonly: true, value: this.#plan.excitation.replace('PORT', this.#callbacks.port() ?? 'PORT') });
    const copy = html('button', { type: 'button' }, 'Copy');
    copy.addEventListener('click', () => copyFrom(command, copy));
    const label = html('label', { for: 'study-plan' }, 'These records do not determine the values. The tests of a plan do: release the drive, then run');
    this.#parts.excitation.replaceChildren(label, command, ' ', copy);
  }

  #working(button, words) {
    const { start, bar, at, problem, tasks, excitation } = this.#parts;
    excitation.replaceChildren();
    const isAtWork = button === 'Cancel';
    [start.textContent, at.textContent, problem.textContent, bar.hidden] = [button, words, '', !isAtWork];
    bar.removeAttribute('value');
    for (const one of tasks) one.disabled = isAtWork;
  }

  #tell({ share, words }) {
    const { bar, at } = this.#parts;
    if (share === null) bar.removeAttribute('value');
    else bar.value = share;
    at.textContent = words;
  }

  #found(task, command, { name, text }, { page, settings, result }) {
    const take = html('button', { type: 'button', class: 'main', id: 'study-take' }, TASKS[task].take);
    take.addEventListener('click', () => {
      if (this.#weigh()) this.#callbacks.take(settings);
    });
    this.#offered = { take, what: html('small', {}), settings, rig: { name, text } };
    this.#weigh();
    if (task === 'identify' && settings.length === 0) this.#offerPlan();
    // A single key has a graph of its own.
    const hasMany = task === 'sweep' && result.rows.length > 1 && Object.keys(result.rows[0].levels).length > 1;
    showReport(this.#exhibit, page, command, [take, this.#offered.what], hasMany ? [parallelOf(result)] : []);
  }

  /** Whether what was found can be taken over: by the rig it was found for, and by no other. */
  #weigh() {
    if (!this.#offered) return false;
    const { take, what, settings, rig } = this.#offered;
    const { name, text } = this.#callbacks.rig();
    const isSame = name === rig.name && text === rig.text;
    take.disabled = !isSame || settings.length === 0;
    const words = isSame ? settings.join(', ') || 'nothing to take over' : 'found for another rig';
    if (what.textContent !== words) what.textContent = words;
    return !take.disabled;
  }
}

/** Why a study cannot run. */
function reasonOf({ status, message }) {
  const tooLong = 'the rig and its records are longer than the 2 MiB that the studio takes; `pneudrive identify` takes longer ones';
  return status === 413 ? tooLong : message;
}

/** The progress in words. */
class Progress {
  #begun;
  #what = '';
  #since = 0;
  #expected = '';

  constructor(begun) {
    this.#begun = begun;
  }

  heard({ what, done, all }) {
    const now = performance.now();
    if (what === 'taste') {
      this.#expected = ` (in all ${about((now - this.#begun) / 1e3 * all / done)} or less, estimated from ${done} runs)`;
      return { share: null, words: `expected${this.#expected}` };
    }
    if (what !== this.#what) [this.#what, this.#since] = [what, now];
    if (!all) return { share: null, words: `${what}; ${((now - this.#begun) / 1e3).toFixed(0)} s so far, and how long it takes cannot be foretold` };
    const left = done > 0 && !this.#expected ? `, ${about((now - this.#since) / 1e3 / done * (all - done))} left` : '';
    return { share: done / all, words: `${done} of ${all} ${what}${left}${this.#expected}` };
  }
}
