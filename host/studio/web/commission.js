// A rig at a port, moved from the page.
//
// While the page reads the stream of looks, it commands the drive. It must be heard now and then, and a jog button must be
// confirmed while it is held; else the server disarms the drive.

import { html } from './svg.js';

/** How often the page is heard, ms. */
const ALIVE = 400;

/** How often a held button is confirmed, ms. */
const HELD = 100;

/** Looks that are kept: a minute of them. */
const MOST_LOOKS = 1200;

const CHANNELS = {
  setpoint: (look) => look.setpoint,
  position: (look) => look.position,
  'pressure 1': (look) => look.pressures[0],
  'pressure 2': (look) => look.pressures[1],
  spool: (look) => look.spool,
  error: (look) => look.error,
  command: (look) => look.command,
};

/** The panel of the drive. `told.rig()` is the rig of the page, `told.seen(run, look)` hears of every look. */
export class Commission {
  #element;
  #server;
  #told;
  #parts = {};
  #number = null;
  #end = null;
  #orders = Promise.resolve();
  #alive = 0;
  #held = 0;
  #looks = [];
  #begun = null;

  constructor(element, server, told) {
    this.#element = element;
    this.#server = server;
    this.#told = told;
  }

  /** Builds the panel. */
  show({ port, jog_mm_per_s: jog, go_mm_per_s: go }) {
    const button = (name, text, act, kind = null) => {
      const made = html('button', { type: 'button', class: kind, disabled: true }, text);
      made.addEventListener('click', act);
      this.#parts[name] = made;
      return made;
    };
    const link = html('button', { type: 'button', class: 'main' }, 'Take command');
    link.addEventListener('click', () => (this.#end ? this.leave() : this.#take()));
    this.#parts.link = link;
    this.#parts.mode = html('strong', { class: 'mode' }, 'not connected');
    this.#parts.why = html('span', {});
    this.#parts.message = html('p', { class: 'problem', role: 'alert' });
    this.#parts.mm = html('input', { type: 'text', id: 'go-mm', inputmode: 'decimal', size: 8 });
    const go_there = () => this.#order('go', { mm: Number(this.#parts.mm.value || NaN), rig: this.#told.rig() });
    this.#parts.mm.addEventListener('keydown', (event) => { if (event.key === 'Enter') go_there(); });
    this.#element.replaceChildren(
      html('h2', {}, 'Commission'), html('p', {}, `Rig at ${port} `, link),
      html('p', { role: 'status' }, this.#parts.mode, ' ', this.#parts.why), this.#parts.message,
      html('p', { class: 'row' }, button('arm', 'Arm', () => this.#order('arm')), button('disarm', 'Disarm', () => this.#order('disarm'))),
      html('p', { class: 'row' }, this.#jog('retract', '◀ Retract'), this.#jog('extend', 'Extend ▶'), html('small', {}, `while held, ${jog} mm/s`)),
      html('p', { class: 'row' }, html('label', { for: 'go-mm' }, 'Go to'), this.#parts.mm, 'mm', button('go', 'Go', go_there), html('small', {}, `${go} mm/s`)),
      html('p', { class: 'row' }, button('home', 'Home', () => this.#order('home')), button('run', 'Run the test of this page', () => this.#run())),
      html('p', { class: 'remark' }, 'Esc and the red button stop the drive. It is disarmed when this page is closed, hidden or cut off. This is not a safety function: a machine with people near it needs a hardware emergency stop.'),
    );
  }

  get commands() {
    return this.#number !== null;
  }

  /** Stops the drive at once, whoever commands it. */
  stop() {
    this.#release();
    this.#server.post('/api/order', { order: 'stop' }).catch((error) => this.#tell(error.message));
  }

  /** Gives the drive up; it is disarmed. */
  leave() {
    this.#end?.abort();
  }

  async #take() {
    this.#end = new AbortController();
    this.#parts.link.textContent = 'Leave';
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
    [this.#number, this.#end] = [null, null];
    this.#parts.link.textContent = 'Take command';
    this.#parts.mode.textContent = 'not connected';
    this.#parts.why.textContent = '';
    this.#enable(null);
    this.#told.ended();
  }

  #heard(line) {
    if (line.number) {
      this.#number = line.number;
      this.#looks = [];
      this.#alive = setInterval(() => { if (!document.hidden) this.#order('alive'); }, ALIVE);
      return;
    }
    this.#parts.mode.textContent = line.mode;
    this.#parts.mode.className = `mode ${line.mode}`;
    this.#parts.why.textContent = line.fault || (line.referenced ? '' : 'the axis is not referenced: home it first');
    if (line.message) this.#tell(line.message);
    this.#enable(line);
    if (line.look > 0) this.#keep(line);
  }

  #keep(look) {
    const before = this.#looks.at(-1);
    if (before?.look === look.look) return;
    const now = performance.now() / 1e3;
    if (look.run_s !== null) this.#beginsAt(now - look.run_s, before);
    this.#looks = [...this.#looks.slice(1 - MOST_LOOKS), { ...look, at: now }];
    const origin = this.#looks[0].at;
    const curves = new Map(Object.entries(CHANNELS).map(([name, of]) => [name, this.#looks.map((one) => of(one) ?? NaN)]));
    const run = { label: 'live', time: this.#looks.map((one) => one.at - origin), curves };
    this.#told.seen(run, this.#begun === null ? null : this.#begun - origin);
  }

  /** When the test that runs has begun. A look that comes late tells too late a time, so the earliest counts. */
  #beginsAt(time, before) {
    const isSame = this.#begun !== null && (before?.run_s ?? null) !== null;
    this.#begun = isSame ? Math.min(this.#begun, time) : time;
  }

  /** Buttons that do something now. */
  #enable(look) {
    const isThere = look !== null && look.mode !== 'connecting';
    const { arm, disarm, retract, extend, go, home, run } = this.#parts;
    arm.disabled = !isThere || look.is_enabled;
    disarm.disabled = !isThere || !look.is_enabled;
    const canMove = isThere && look.mode !== 'fault';
    for (const button of [retract, extend, go, run]) button.disabled = !canMove || !look.referenced;
    home.disabled = !canMove;
  }

  /** One order after the other: a button that was let go must not be overtaken by its last confirmation. */
  #order(order, more = {}) {
    const send = () => this.#server.post('/api/order', { number: this.#number, order, ...more });
    this.#orders = this.#orders.then(send).catch((error) => { if (this.commands) this.#tell(error.message); });
  }

  #run() {
    this.#begun = null;
    this.#order('run', { rig: this.#told.rig() });
  }

  /** A button that moves the drive while it is held, by pointer or by keyboard. */
  #jog(order, text) {
    const button = html('button', { type: 'button', class: 'jog', disabled: true }, text);
    const hold = () => {
      if (this.#held || button.disabled) return;
      const confirm = () => this.#order(order, { rig: this.#told.rig() });
      confirm();
      this.#held = setInterval(confirm, HELD);
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
