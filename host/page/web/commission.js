// A rig at a port, moved from the page.
//
// While the page reads the stream of looks, it commands the drive. It must be heard now and then, and a jog button must be
// confirmed while it is held; else the server disarms the drive.

import { BringUp } from './bring-up.js';
import { asked } from './dialog.js';
import { offer } from './export.js';
import { Orders } from './orders.js';
import { Parameters } from './parameters.js';
import { Readouts } from './readouts.js';
import { Scope } from './scope.js';
import { html } from './svg.js';

/** Interval of the page's signs of life, ms: a moving drive is disarmed after 300 ms without one. */
const ALIVE = 100;

/** Interval in which a held button is confirmed, ms. */
const HELD = 100;

/** Rates of a jog, mm/s, and lengths of a step, mm. */
const RATES = [1, 2, 5, 10, 20, 50];
const STEPS = [0.05, 0.1, 0.5, 1, 5, 10, 50];

/** Orders that leave the message of the server unchanged. */
const QUIET = ['alive', 'retract', 'extend'];

/**
 * The panel of the drive, and its figures in large letters.
 *
 * `callbacks.rig()` is the rig of the page, `callbacks.stroke()` its stroke, mm, and `callbacks.hasRecord(name)` says whether a
 * record lies on the page. The panel calls
 * - `callbacks.seen(run, begun, cursor)` with the run for the graphs, and `callbacks.ended()` when they are free,
 * - `callbacks.alarm(text)` with a warning for every view, or '',
 * - `callbacks.recorded({ name, text })` with a record,
 * - `callbacks.identify(name)` to have the values of the rig found from that record.
 */
export class Commission {
  #element;
  #server;
  #callbacks;
  #parts = {};
  #ask;
  #number = null;
  #end = null;
  #orders;
  #alive = 0;
  #held = 0;
  #isRecording = false;
  /** The name of the record that was taken last. */
  #recorded = null;
  /** The last message of the server; null when the next one counts, whatever it is. */
  #said = null;
  /** Whether what is told stays when the server takes its message back: letting a button go is no answer to it. */
  #stays = false;
  /** The last look at the drive. */
  #look = {};
  #readouts;
  #scope;
  #parameters;
  #bringUp;

  constructor(element, readouts, server, callbacks) {
    this.#element = element;
    this.#readouts = new Readouts(readouts);
    this.#server = server;
    this.#callbacks = callbacks;
    const ask = (question, more) => server.post('/api/ask', { number: this.#number, ask: question, ...more });
    this.#scope = new Scope(callbacks);
    this.#parameters = new Parameters({ ask, rig: callbacks.rig });
    this.#bringUp = new BringUp({ ask, order: (...order) => this.#order(...order) });
    this.#ask = ask;
    this.#orders = new Orders(server.post, { stopped: (problem) => this.#stopped(problem) });
  }

  /** Builds the panel. */
  show({ port, jog_mm_per_s: jog, go_mm_per_s: go }) {
    const button = (name, text, act, kind = null) => {
      const made = html('button', { type: 'button', class: kind, disabled: true }, text);
      made.addEventListener('click', act);
      this.#parts[name] = made;
      return made;
    };
    const choice = (name, label, values, first, unit) => {
      this.#parts[name] = html('select', { id: `jog-${name}` }, ...values.map((value) => html('option', { value, selected: value === first }, String(value))));
      return [html('label', { for: `jog-${name}` }, label), this.#parts[name], unit];
    };
    const link = html('button', { type: 'button', class: 'main' }, 'Take command');
    link.addEventListener('click', () => (this.#end ? this.leave() : this.#take()));
    this.#parts.link = link;
    this.#parts.mode = html('strong', { class: 'mode' }, 'not connected');
    this.#parts.why = html('span', {});
    this.#parts.message = html('p', { class: 'problem', role: 'alert' });
    this.#parts.mm = html('input', { type: 'text', id: 'go-mm', inputmode: 'decimal', size: 8 });
    const go_there = () => this.#go(Number(this.#parts.mm.value || NaN));
    this.#parts.mm.addEventListener('keydown', (event) => { if (event.key === 'Enter') go_there(); });
    this.#element.replaceChildren(
      html('h2', {}, 'Commission'), html('p', {}, `Rig at ${port} `, link),
      html('p', { role: 'status' }, this.#parts.mode, ' ', this.#parts.why), this.#parts.message,
      html('p', { class: 'row' }, button('arm', 'Arm', () => this.#order('arm')), button('disarm', 'Disarm', () => this.#order('disarm'))),
      html('p', { class: 'row' }, this.#jog('retract', '◀ Retract'), this.#jog('extend', 'Extend ▶'), ...choice('rate', 'while held, at', RATES, jog, 'mm/s')),
      html('p', { class: 'row' }, button('back', '◀ Step', () => this.#step(-1)), button('on', 'Step ▶', () => this.#step(1)), ...choice('step', 'by', STEPS, 1, 'mm')),
      html('p', { class: 'row' }, html('label', { for: 'go-mm' }, 'Go to'), this.#parts.mm, 'mm', button('go', 'Go', go_there), html('small', {}, `${go} mm/s`)),
      html('p', { class: 'row' }, button('home', 'Home', () => this.#order('home')), button('run', 'Run the test of this page', () => this.#run()),
        button('record', 'Record', () => this.#record()), button('identify', 'Identify', () => this.#callbacks.identify(this.#recorded))),
      html('p', { class: 'remark' }, 'Esc and the red button stop the drive. It is disarmed when this page is closed, hidden or cut off. This is not a safety function: a machine with people near it needs a hardware emergency stop.'),
      this.#scope.show(), this.#parameters.show(), this.#bringUp.show(),
    );
  }

  /** The rig of the page may have changed. */
  designChanged() {
    this.#parameters.designChanged();
  }

  /** The records of the page may have changed. */
  recordsChanged() {
    if (this.#parts.identify) this.#parts.identify.disabled = this.#recorded === null || !this.#callbacks.hasRecord(this.#recorded);
  }

  get commands() {
    return this.#number !== null;
  }

  /** Whether the graphs follow the rig. */
  get follows() {
    return this.commands && this.#scope.isOn;
  }

  /** Stops the drive at once, whoever commands it. */
  stop() {
    this.#orders.stop();
    this.#release();
  }

  /** A drive that was not stopped is told of in every view, until it is stopped or is seen at rest. */
  #stopped(problem) {
    this.#callbacks.alarm(problem && `NOT STOPPED: ${problem}`);
  }

  /** Gives up the command of the drive, which is disarmed. */
  leave() {
    this.#end?.abort();
  }

  async #take() {
    this.#end = new AbortController();
    this.#parts.link.textContent = 'Leave';
    [this.#said, this.#stays] = [null, false];
    this.#tell('');
    try {
      for await (const line of this.#server.lines('/api/drive', this.#end.signal)) this.#heard(line);
    } catch (error) {
      if (!this.#end.signal.aborted) this.#tell(error.message);
    }
    this.#ended();
  }

  #ended() {
    clearInterval(this.#alive);
    this.#release();
    // What the page does not read any more must not hold the command.
    this.#end.abort();
    [this.#number, this.#end] = [null, null];
    this.#parts.link.textContent = 'Take command';
    this.#parts.mode.textContent = 'not connected';
    this.#parts.why.textContent = '';
    this.#enable(null);
    this.#look = {};
    this.#readouts.show();
    this.#bringUp.ended();
    this.#callbacks.ended();
  }

  #heard(line) {
    if (line.number) {
      this.#number = line.number;
      this.#scope.begin();
      this.#alive = setInterval(() => { if (!document.hidden) this.#order('alive'); }, ALIVE);
      return;
    }
    if (line.bring_up) this.#bringUp.heard(line.bring_up);
    if (['disarmed', 'fault'].includes(line.mode)) this.#stopped('');
    this.#parts.mode.textContent = line.mode;
    this.#parts.mode.className = `mode ${line.mode}`;
    this.#parts.why.textContent = line.fault || (line.referenced ? '' : 'the axis is not referenced: home it first');
    this.#look = line;
    this.#readouts.show(line);
    this.#hear(line.message);
    this.#enable(line);
    this.#scope.heard(line);
  }

  /** Shows a message of the server once: the page may have shown another message since. */
  #hear(message) {
    if (message === this.#said) return;
    this.#said = message;
    if (message || !this.#stays) this.#tell(message);
  }

  /** Enables the buttons that have an effect now. */
  #enable(look) {
    const isThere = look !== null && look.mode !== 'connecting';
    const { arm, disarm, retract, extend, back, on, go, home, run, record } = this.#parts;
    const isFree = isThere && !this.#bringUp.isOn && !this.#isRecording;
    arm.disabled = !isFree || look.is_enabled;
    disarm.disabled = !isThere || !look.is_enabled;
    const canMove = isFree && look.mode !== 'fault';
    for (const button of [retract, extend, go, run]) button.disabled = !canMove || !look.referenced;
    for (const button of [back, on]) button.disabled = go.disabled || ['homing', 'running', 'approaching'].includes(look.mode);
    home.disabled = !canMove;
    record.disabled = !isFree || ['homing', 'running', 'approaching'].includes(look.mode);
    if (look?.mode === 'approaching') run.disabled = true;
    this.#parameters.enable(isThere);
    this.#bringUp.enable(isFree && !look.is_enabled);
  }

  async #order(order, more = {}, isWanted = () => true) {
    if (order !== 'alive') this.#stays = order === 'release';
    try {
      const isSent = await this.#orders.give(this.#number, order, more, isWanted);
      // The same refusal may follow again.
      if (isSent && !QUIET.includes(order)) this.#said = null;
    } catch (error) {
      if (this.commands) this.#tell(error.message);
    }
  }

  /** Takes the record of the last test: as a file, and over the run of the page. */
  async #record() {
    this.#isRecording = true;
    this.#tell('');
    try {
      const record = await this.#ask('record');
      offer(record.name, new Blob([record.text], { type: 'text/plain' }));
      this.#scope.turn(false);
      this.#recorded = record.name;
      await this.#callbacks.recorded(record);
      if (!this.#scope.isOfPage) this.#tell('The last run was not the test of this page, so the simulation below its record is that of another move.');
    } catch (error) {
      this.#tell(error.message);
    }
    this.#isRecording = false;
  }

  /** Runs the test; where the drive stands elsewhere than it starts, the page asks before it goes there. */
  async #run() {
    const rig = this.#callbacks.rig();
    this.#tell('');
    try {
      const approach = await this.#ask('approach', { rig });
      const yes = !approach || await asked('Go to the start of the test?', [html('p', {}, approach.text)], 'Go there and run', () => true);
      if (!yes || !this.commands) return;
      this.#scope.turn(true);
      this.#order('run', { rig, from_mm: approach?.from_mm });
    } catch (error) {
      this.#tell(error.message);
    }
  }

  /** Goes to a position, mm; a position out of reach is not sent. */
  #go(mm) {
    const [least, most] = this.#reach;
    if (!Number.isFinite(mm)) this.#tell('give the place in mm; nothing was sent');
    else if (mm < least || mm > most) this.#tell(`${mm} mm is out of reach: the drive goes from ${least.toFixed(1)} to ${most.toFixed(1)} mm; nothing was sent`);
    else this.#order('go', { mm, rig: this.#callbacks.rig() });
  }

  /** The soft limits of the drive within the stroke, mm. */
  get #reach() {
    const [least, most] = this.#look.limits_mm ?? [null, null];
    const stroke = this.#callbacks.stroke() ?? Infinity;
    return [Math.max(least ?? 0, 0), Math.min(most ?? stroke, stroke)];
  }

  /** Moves a step on from the setpoint, or from the position where there is no setpoint. */
  #step(sign) {
    const from = this.#look.setpoint ?? this.#look.position;
    this.#go(Number((from + sign * Number(this.#parts.step.value)).toFixed(3)));
  }

  /** A button that moves the drive while it is held, by pointer or by keyboard. */
  #jog(order, text) {
    const button = html('button', { type: 'button', class: 'jog', disabled: true }, text);
    const hold = () => {
      if (this.#held || button.disabled) return;
      // Takes back what was told of the order before.
      this.#order('release');
      this.#tell('');
      const confirm = () => this.#order(order, { rig: this.#callbacks.rig(), mm_per_s: Number(this.#parts.rate.value) }, () => this.#held === held);
      const held = setInterval(() => {
        // Whoever holds it does not see the drive any more.
        if (document.hidden) return this.#release();
        confirm();
      }, HELD);
      this.#held = held;
      confirm();
    };
    const release = () => this.#release();
    button.addEventListener('pointerdown', hold);
    for (const end of ['pointerup', 'pointerleave', 'pointercancel', 'blur']) button.addEventListener(end, release);
    button.addEventListener('keydown', (event) => { if (event.key === ' ' || event.key === 'Enter') hold(); });
    button.addEventListener('keyup', release);
    this.#parts[order] = button;
    return button;
  }

  #release() {
    if (!this.#held) return;
    clearInterval(this.#held);
    this.#held = 0;
    this.#order('release');
  }

  #tell(message) {
    this.#parts.message.textContent = message;
  }
}
