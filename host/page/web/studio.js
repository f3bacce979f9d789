// The page: the user's choices and changes, and the parts that receive them.

import { Commission } from './commission.js';
import { componentOf } from './components.js';
import { isAsking } from './dialog.js';
import { askForOther, showDifferences } from './difference.js';
import { copyFrom } from './export.js';
import { Figures } from './figures.js';
import { measureHeader } from './header.js';
import { History, settingOf } from './history.js';
import { Inspector } from './inspector.js';
import { measureChange } from './measures.js';
import { Opening } from './opening.js';
import { describePictures } from './paper.js';
import { Picture } from './picture.js';
import { Player } from './player.js';
import { Plot } from './plot.js';
import { Records } from './records.js';
import { Runs } from './runs.js';
import { save } from './save.js';
import { placeOf } from './scale.js';
import { Refused, get, lines, post, postForColumns, study } from './server.js';
import { Simulation } from './simulation.js';
import { showSpectra } from './spectrum.js';
import { StateLine } from './state-line.js';
import { Study } from './study.js';
import { html, say } from './svg.js';
import { Toolbar } from './toolbar.js';
import { choose, offerViews, showAddressed } from './views.js';

const part = (id) => document.getElementById(id);

const stateLine = new StateLine(part('state'));

/** Most ghosts: more of them would be no picture. */
const MAX_GHOSTS = 6;

class Studio {
  #keys;
  #rig = { name: '', text: '' };
  #history = new History();
  #state = { used: new Set(), values: {}, fileValues: {}, problems: [], changed: new Set(), rig: '' };
  #chosen = 'controller';
  #run = null;
  /** The run of the last change that is done: no movement of a slider is about to replace it. */
  #kept = null;
  #ghosts = [];
  #runs = new Runs(part('runs'));
  #figures = new Figures(part('verdict'), part('figures'));
  /** The origins of the rig's values: how many are given, computed, typical, and so on. */
  #origins = '';
  /** The last action. */
  #news = '';
  /** The port of the rig, if there is one. */
  #port = null;

  constructor(keys, rigs) {
    this.#keys = keys;
    describePictures({ version: rigs.version });
    this.opening = new Opening(rigs, {
      open: (...rig) => this.open(...rig),
      lay: (content) => this.records.lay(content),
      went: (address) => this.#went(address),
      failed: (error) => this.#failed(error),
    });
    const changes = { changed: (...change) => this.#change(...change), chosen: (id) => this.#choose(id) };
    this.inspector = new Inspector(part('inspector'), keys, changes);
    this.picture = new Picture(part('picture'), changes);
    this.plot = new Plot(part('plot'), { cursor: (time) => this.#moveTo(time) });
    this.simulation = new Simulation({
      check: (found, rig) => this.#checked(found, rig),
      run: (result, rig, since) => this.#simulated(result, rig, since),
      ensemble: (result) => this.#judged(result),
      failed: (error) => this.#failed(error),
    });
    this.commission = new Commission(part('commission'), part('readouts'), { post, lines }, {
      rig: () => this.#asked(),
      stroke: () => 1e3 * this.#state.values['actuator.stroke_m']?.number || undefined,
      seen: (...seen) => this.#followRig(...seen),
      recorded: (record) => this.records.lay(record),
      hasRecord: (name) => this.records.all.some((record) => record.name === name),
      identify: (name) => this.#identify(name),
      ended: () => this.#leaveRig(),
      alarm: (text) => stateLine.alarm(text),
    });
    this.records = new Records((record, align) => postForColumns('/api/compare', { ...this.#asked(), record, align }), {
      changed: () => this.#recordsChanged(),
      failed: (error) => this.#failed(error),
    });
    this.toolbar = new Toolbar(part('channels'), this.plot, this.records, {
      run: () => this.#run,
      name: () => this.#state.rig,
      title: () => this.#run?.label === 'as in the file' ? 'One test' : `One test, ${this.#run?.label ?? ''}`,
      picture: () => part('picture'),
      described: () => this.#described(),
      spectrum: () => this.#showSpectra(),
    });
    this.study = new Study(part('study'), part('exhibit'), { get, post, study }, {
      rig: () => this.#asked(),
      state: () => this.#state,
      records: () => this.records.all.map(({ content }) => content).filter(({ text }) => text !== undefined),
      port: () => this.#port,
      open: () => part('file').click(),
      take: (settings) => this.#take(settings),
    });
    new Player(part('play'), this.plot, () => this.#run?.time.at(-1) ?? 0);
    this.#listen();
  }

  /** Shows the view and the graphs of the address. */
  #went({ view, graphs }) {
    showAddressed(view);
    if (graphs) this.toolbar.showOnly(graphs);
    this.study.show();
  }

  /** Begins with a rig and the changes to it; `news` is told until something is changed. */
  async open(rig, news = '', history = new History()) {
    this.simulation.giveUp();
    this.#rig = rig;
    this.#news = news;
    this.#history = history;
    this.opening.opened(rig, history);
    describePictures({ rig: rig.name.split(/[\\/]/).at(-1) });
    this.#ghosts = [];
    this.records.clear();
    this.#run = null;
    this.#kept = null;
    this.study.opened();
    const found = await post('/api/check', { ...rig, settings: [] });
    if (this.#rig !== rig) return;
    if (!found.values) this.#showNoRun();
    this.#state.fileValues = found.values ?? {};
    this.#state.rig = rig.name;
    this.plot.zoom();
    this.#simulate();
  }

  /** Removes everything that belongs to the former rig: the new one has no run yet. */
  #showNoRun() {
    this.#origins = '';
    part('command').value = '';
    this.#state = { ...this.#state, values: {}, used: new Set() };
    this.#figures.clear();
    if (!this.commission.follows) {
      this.plot.show([]);
      say(part('readout'), '');
      this.picture.forget();
    }
    this.#show();
  }

  /** The rig as the server takes it. */
  #asked() {
    const settings = Object.values(this.#history.settings);
    return { ...this.#rig, settings };
  }

  #simulate(since) {
    part('undo').disabled = !this.#history.canUndo;
    part('redo').disabled = !this.#history.canRedo;
    this.opening.changed();
    this.simulation.ask(this.#asked(), since);
  }

  #change(key, text, isDone) {
    const since = performance.now();
    this.#news = '';
    this.#history.set(key.path, text === null ? null : settingOf(key, text));
    if (isDone && this.#history.keep()) this.#leaveGhost();
    this.#simulate(since);
  }

  /** Takes over what a study has found: one change, which undo takes back. */
  #take(settings) {
    this.#news = `${settings.length} ${settings.length === 1 ? 'value is' : 'values are'} taken over; Undo takes them back`;
    for (const setting of settings) this.#history.set(setting.slice(0, setting.indexOf('=')), setting);
    if (this.#history.keep()) this.#leaveGhost();
    this.#simulate();
    choose('design');
  }

  /** The run before a change stays as a ghost, once the change is done. */
  #leaveGhost() {
    if (this.#kept) this.#ghosts = [...this.#ghosts, { ...this.#kept, band: undefined, isGhost: true }].slice(-MAX_GHOSTS);
    this.#kept = null;
    this.#show();
  }

  #checked(found, { settings }) {
    this.#state.problems = found.problems;
    // The rig that was checked may be one of a moment ago.
    this.#state.changed = new Set(settings.map((setting) => setting.slice(0, setting.indexOf('='))));
    if (found.values) {
      this.#state = { ...this.#state, values: found.values, used: new Set(found.used) };
      this.picture.describe(found.values);
      this.picture.moveTo(this.plot.cursor);
      part('command').value = found.command;
      this.#origins = found.origins;
      stateLine.show(this.#news || found.origins, found.problems.length > 0);
    } else {
      const count = found.problems.length;
      const shown = this.#run ? 'the curves are those of the last valid rig' : 'there is no run';
      stateLine.show(`${count} ${count === 1 ? 'problem' : 'problems'}: ${shown}`, true);
    }
    this.#inspect();
    this.study.show();
    this.commission.designChanged();
  }

  #inspect() {
    this.inspector.show(this.#chosen, this.#state);
    const wrong = new Set(this.#state.problems.map((problem) => componentOf(problem.key)?.id));
    this.picture.mark(this.#chosen, wrong);
  }

  #choose(id) {
    this.#chosen = id;
    this.#inspect();
  }

  #simulated({ head, time, columns }, rig, since) {
    const curves = new Map(columns.map((column) => [column.name, column.values]));
    const units = new Map(columns.map((column) => [column.name, column.unit]));
    this.#run = { label: rig.settings.join(', ') || 'as in the file', head, time, curves, units };
    if (this.#history.isKept(rig.settings)) this.#kept = this.#run;
    if (!this.commission.follows) this.picture.follow(this.#run);
    this.#show(() => measureChange(since));
    this.#figures.showAlone(head);
    this.records.outdate();
    this.#moveTo(this.plot.cursor);
  }

  #judged({ head, time, columns }) {
    const band = new Map();
    for (let k = 0; k + 1 < columns.length; k += 2) {
      band.set(columns[k].name, { low: columns[k].values, high: columns[k + 1].values });
    }
    // The run itself, which may be the kept one.
    this.#run.band = time.length ? band : undefined;
    this.#show();
    this.#figures.showJudged(head, this.#run.head.fault);
    this.records.compareAgain();
  }

  #show(drawn) {
    // While a rig is followed, its curves are on the graphs.
    if (this.#run && !this.commission?.follows) this.plot.show([...this.records.runs, ...this.#ghosts, this.#run], drawn);
    const ghosts = this.#ghosts.map((one) => ({ kind: 'ghost', label: one.label, dismiss: () => this.#dismiss(one) }));
    const records = this.records.all.map((one) => ({ kind: 'record', label: one.name, dismiss: () => this.records.dismiss(one) }));
    this.#runs.show(this.#run?.label ?? null, [...records, ...ghosts.reverse()]);
    this.toolbar.update();
  }

  #dismiss(ghost) {
    this.#ghosts = this.#ghosts.filter((other) => other !== ghost);
    this.#show();
  }

  /** Offers to commission the rig at a port. */
  offer(port) {
    offerViews(Boolean(port.port), () => this.study.show());
    if (!port.port) return;
    this.#port = port.port;
    this.commission.show(port);
    part('stop').hidden = false;
    part('stop').addEventListener('click', () => this.commission.stop());
    document.addEventListener('keydown', ({ key }) => { if (key === 'Escape') this.commission.stop(); });
  }

  /** Shows the rig at the port, over the simulation of its test since that has begun; what is held has its own time only. */
  #followRig(live, begun, cursor) {
    const times = this.#run && begun !== null ? this.#run.time.map((time) => time + begun) : [];
    const time = live.isHeld ? times.slice(0, placeOf(times, live.time.at(-1))) : times;
    const simulated = time.length ? [{ ...this.#run, band: undefined, isGhost: true, time }] : [];
    this.plot.show([...simulated, live]);
    this.picture.follow(live);
    this.plot.moveTo(cursor);
  }

  /** Gives the graphs back to the runs of the page. */
  #leaveRig() {
    if (this.#run) this.picture.follow(this.#run);
    this.#show();
  }

  #moveTo(time) {
    this.picture.moveTo(time);
    say(part('instant'), `${time.toFixed(3)} s`);
    say(part('readout'), this.plot.readout());
  }

  #failed(error) {
    const text = error instanceof Refused ? error.message : 'the studio does not answer; start it again and reload this page';
    stateLine.show(text, true);
    if (!this.#run) this.#showNoRun();
  }

  #travel(through) {
    through();
    this.#simulate();
  }

  #save() {
    const before = (path) => {
      const value = this.#state.fileValues[path];
      return value ? settingOf(this.#keys.find((key) => key.path === path), value.text) : null;
    };
    return save(this.#asked(), (saved) => this.open(saved, `${saved.name} is saved`, this.#history.rebased(before)));
  }

  #recordsChanged() {
    this.#show();
    this.#figures.showRecords(this.records.all);
    this.study?.show();
    this.commission.recordsChanged();
  }

  /** Hands the record of the rig to the study that finds the rig's values from it. */
  #identify(name) {
    choose('study');
    this.study.identify(name);
  }

  /** What a report says beside its graphs. */
  #described() {
    const command = part('command').value;
    return { title: `${this.#state.rig}: one test`, origins: this.#origins, figures: this.#figures.copies(), command };
  }

  #showSpectra() {
    const { from, to } = this.plot.view;
    const ask = (channel, record) => postForColumns('/api/spectrum', { ...this.#asked(), channel, record, from_s: from, to_s: to });
    const records = this.records.all.map(({ content }) => content);
    return showSpectra(ask, records, `From ${from.toFixed(4)} s to ${to.toFixed(4)} s, the visible part`);
  }

  /** Compares the rig with another, key by key. */
  async #compareWith() {
    const name = await askForOther(this.#rig.name, this.opening.names, () => part('folder').click());
    if (name === null) return;
    try {
      const other = name === '' ? this.#rig : await get(`/api/rigs/${name}`);
      const shown = await post('/api/difference', { ...this.#asked(), other });
      if (await showDifferences(shown)) this.#leaveOther(other, await postForColumns('/api/run', { ...other, settings: [] }));
    } catch (error) {
      this.#failed(error);
    }
  }

  /** The run of another rig lies under this one's as a ghost. */
  #leaveOther({ name }, { time, columns }) {
    const curves = new Map(columns.map((column) => [column.name, column.values]));
    this.#ghosts = [...this.#ghosts, { label: name, time, curves, isGhost: true }];
    this.#show();
  }

  #listen() {
    part('undo').addEventListener('click', () => this.#travel(() => this.#history.undo()));
    part('redo').addEventListener('click', () => this.#travel(() => this.#history.redo()));
    part('save').addEventListener('click', () => this.#save());
    part('copy').addEventListener('click', () => copyFrom(part('command'), part('copy')));
    part('compare').addEventListener('click', () => this.#compareWith());
    document.addEventListener('keydown', (event) => this.#key(event));
  }

  #key(event) {
    const { key, shiftKey } = event;
    if (!(event.ctrlKey || event.metaKey) || isAsking()) return;
    const isTyping = event.target.matches('input[type=text], input[type=search]');
    const actions = { s: () => this.#save() };
    if (!isTyping) actions[shiftKey ? 'Z' : 'z'] = () => this.#travel(() => (shiftKey ? this.#history.redo() : this.#history.undo()));
    if (!(key in actions)) return;
    event.preventDefault();
    actions[key]();
  }
}

async function begin() {
  measureHeader(document.querySelector('header'));
  const [keys, rigs, port] = await Promise.all([get('/api/keys'), get('/api/rigs'), get('/api/port')]);
  const studio = new Studio(keys, rigs);
  // For measurements.
  window.studio = studio;
  studio.offer(port);
  await studio.study.begin(keys);
  await studio.opening.begin();
}

begin().catch((error) => stateLine.show(error.message, true));
