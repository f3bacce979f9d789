// The live scope: which samples of the last minute are on the graphs.

import { offer, toCsv } from './export.js';
import { CHANNELS, Recent } from './recent.js';
import { html } from './svg.js';
import { crossing } from './trigger.js';

/** How long the graphs may be, s. */
const WINDOWS = [0.5, 1, 2, 5, 10, 30, 60];

/** The scope. `callbacks.seen(run, begun, cursor)` hears what is to be on the graphs, `callbacks.ended()` that they are free. */
export class Scope {
  #callbacks;
  #recent = new Recent();
  #parts = {};
  #isOn = true;
  #isPaused = false;
  /** What is on the graphs, or was last. */
  #run = null;
  #begun = null;
  /** Crossings up to here have been looked for, s. */
  #searched = 0;
  /** A crossing whose samples have not all come, s. */
  #crossed = null;
  /** Whether the graphs hold the samples around a crossing. */
  #isHeld = false;

  constructor(callbacks) {
    this.#callbacks = callbacks;
  }

  /** Builds its part of the panel. */
  show() {
    const choice = (name, label, options) => {
      const select = html('select', { id: `scope-${name}` }, ...options.map(([value, text]) => html('option', { value }, text)));
      select.addEventListener('change', () => this.#set());
      this.#parts[name] = select;
      return label ? [html('label', { for: `scope-${name}` }, label), select] : [select];
    };
    const number = (name, label, unit, value) => {
      const input = html('input', { type: 'text', id: `scope-${name}`, inputmode: 'decimal', size: 6, value });
      input.addEventListener('change', () => this.#set());
      this.#parts[name] = input;
      return [html('label', { for: `scope-${name}` }, label), input, unit];
    };
    const button = (name, text, act) => {
      this.#parts[name] = html('button', { type: 'button' }, text);
      this.#parts[name].addEventListener('click', act);
      return this.#parts[name];
    };
    this.#parts.unit = html('span', {}, 'mm');
    this.#parts.state = html('p', { class: 'remark', role: 'status' });
    this.#parts.problem = html('p', { class: 'problem', role: 'alert' });
    const windows = WINDOWS.map((seconds) => [seconds, `${seconds} s`]);
    const element = html('details', { class: 'scope', open: true }, html('summary', {}, 'Scope'),
      html('p', { class: 'row' }, ...choice('window', 'Show', windows), button('pause', 'Pause', () => this.#pause()),
        button('on', 'Show live', () => this.turn(true)), button('csv', 'CSV', () => this.#offer())),
      html('p', { class: 'row' }, ...choice('trigger', 'Trigger', [['off', 'off'], ['normal', 'each time'], ['single', 'once']]),
        ...choice('channel', 'when', [...CHANNELS.keys()].map((name) => [name, name])),
        ...choice('slope', '', [['rising', 'rises through'], ['falling', 'falls through']])),
      html('p', { class: 'row' }, ...number('level', 'Level', this.#parts.unit, '0'), ...number('before', 'before it', '% of the time', '20'),
        button('again', 'Wait for the next', () => this.#set())),
      this.#parts.problem, this.#parts.state);
    this.#parts.channel.value = 'position';
    this.#parts.slope.setAttribute('aria-label', 'slope');
    this.#parts.window.value = '60';
    this.#parts.on.hidden = true;
    this.#set();
    return element;
  }

  /** Whether the graphs are the scope's. */
  get isOn() {
    return this.#isOn;
  }

  /** Whether the last test was that of the page, as it was then. */
  get isOfPage() {
    return this.#begun !== null;
  }

  /** Takes the graphs, or leaves them to the runs of the page. */
  turn(isOn) {
    this.#isOn = isOn;
    this.#isPaused = false;
    this.#parts.on.hidden = isOn;
    this.#parts.pause.textContent = 'Pause';
    if (!isOn) this.#callbacks.ended();
    else if (this.#isHeld) this.#tell();
    this.#draw();
  }

  /** Begins anew, with a page that has just taken command. */
  begin() {
    this.#recent.clear();
    this.#run = null;
    this.#set();
    this.turn(true);
  }

  /** Takes a line of the server. */
  heard({ look, samples, run_began_s: begun, stream_hz: rate }) {
    if (look === 0) return;
    this.#begun = begun;
    if (samples) this.#recent.add(samples);
    if (samples) this.#watch();
    this.#draw();
    const streamed = rate === null ? 'the firmware has no streams: 20 looks a second' : `${rate.toFixed(0)} samples a second while a test runs, 20 looks between`;
    this.#say('state', `${this.#what()} ${streamed}. What is missing is left open.`);
  }

  #what() {
    if (!this.#isOn) return 'The graphs show the runs of the page.';
    if (this.#isPaused) return 'Paused.';
    if (this.#isHeld) return `The cursor is at the crossing${this.#parts.trigger.value === 'single' ? '.' : '; the next one takes its place.'}`;
    return this.#trigger === null ? '' : 'Waiting for a crossing.';
  }

  /** Looks for a crossing, and holds the samples around it once they are there. */
  #watch() {
    const trigger = this.#trigger;
    if (trigger === null || (this.#isHeld && trigger.isSingle)) return;
    if (this.#crossed === null) {
      const [time, values] = this.#recent.since(this.#searched, trigger.channel);
      this.#crossed = crossing(time, values, { ...trigger, after: this.#searched });
      this.#searched = this.#recent.last;
    }
    const until = this.#crossed + trigger.after;
    if (this.#crossed === null || this.#recent.last < until || this.#isPaused) return;
    this.#run = this.#recent.between(this.#crossed - trigger.before, until);
    this.#run.cursor = this.#crossed - this.#run.origin;
    this.#run.isHeld = true;
    [this.#isHeld, this.#searched, this.#crossed] = [true, until, null];
    this.#tell();
  }

  #draw() {
    if (!this.#isOn || this.#isPaused || this.#recent.isEmpty) return;
    if (!this.#isHeld) {
      this.#run = this.#recent.between(this.#recent.last - Number(this.#parts.window.value), this.#recent.last);
      this.#run.cursor = this.#run.time.at(-1);
      this.#tell();
    }
  }

  #tell() {
    if (this.#isOn) this.#callbacks.seen(this.#run, this.#begun === null ? null : this.#begun - this.#run.origin, this.#run.cursor);
  }

  #pause() {
    if (!this.#isOn) return;
    this.#isPaused = !this.#isPaused;
    this.#parts.pause.textContent = this.#isPaused ? 'Go on' : 'Pause';
  }

  #offer() {
    if (this.#run) offer('scope.csv', toCsv(this.#run));
  }

  /** The trigger as it is set; null where there is none. */
  get #trigger() {
    const { trigger, channel, slope, level, before, window } = this.#parts;
    const [height, share] = [level, before].map((field) => (field.value.trim() === '' ? NaN : Number(field.value)));
    if (trigger.value === 'off' || !Number.isFinite(height) || !(share >= 0 && share <= 100)) return null;
    const length = Number(window.value);
    const earlier = (length * share) / 100;
    return { isSingle: trigger.value === 'single', channel: channel.value, isRising: slope.value === 'rising', level: height, before: earlier, after: length - earlier };
  }

  /** Takes the settings: what has been looked for counts no more. */
  #set() {
    const { trigger, channel } = this.#parts;
    const unit = CHANNELS.get(channel.value);
    this.#parts.unit.textContent = unit;
    const isWrong = trigger.value !== 'off' && this.#trigger === null;
    this.#say('problem', isWrong ? `give the level as a number of ${unit}, and what is shown before it as 0 to 100 %` : '');
    for (const name of ['channel', 'slope', 'level', 'before', 'again']) this.#parts[name].disabled = trigger.value === 'off';
    [this.#searched, this.#crossed, this.#isHeld] = [this.#recent.last, null, false];
    this.#draw();
  }

  #say(part, text) {
    if (this.#parts[part].textContent !== text) this.#parts[part].textContent = text;
  }
}
