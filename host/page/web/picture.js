// The drive as its components. Spool, chambers and piston stand as they do at the cursor.

import { COMPONENTS } from './components.js';
import { Incline } from './incline.js';
import { placeOf } from './scale.js';
import { place, say, svg } from './svg.js';

const BARREL = { left: 440, right: 706, top: 78, bottom: 150 };
const PISTON = 14;
const LOAD = { width: 72, reach: 26 };
const VALVE = { left: 452, right: 694, top: 226, bottom: 272 };
/** Ports of the valve: chamber 1, chamber 2, supply, and the exhausts beside them. */
const PORT = { one: 508, two: 638, supply: 573, exhausts: [470, 676] };
const LAND = 30;
/** How far the spool moves in the picture at full travel. */
const SPOOL_REACH = 22;
const WANTED = { left: 34, right: 206, top: 214, bottom: 296 };

/** The picture. `callbacks.chosen(id)` hears which component was chosen. */
export class Picture {
  #element;
  #parts = {};
  #groups = {};
  #rig = null;
  #run = null;
  #incline = new Incline();

  constructor(element, callbacks) {
    this.#element = element;
    element.setAttribute('viewBox', '0 0 960 332');
    element.append(...this.#lines(), ...this.#components(callbacks), this.#incline.element);
  }

  /** Shows which component was chosen, and which have problems. */
  mark(chosen, wrong) {
    for (const [id, group] of Object.entries(this.#groups)) {
      group.classList.toggle('chosen', id === chosen);
      group.classList.toggle('wrong', wrong.has(id));
      group.setAttribute('aria-pressed', String(id === chosen));
    }
  }

  /** Shows the models and sizes of a rig; `values` by path. */
  describe(values) {
    const number = (path) => values[path]?.number;
    const text = (path) => values[path]?.text ?? '';
    this.#rig = {
      stroke: 1e3 * number('actuator.stroke_m'),
      travel: number('valve.spool_travel_mm') ?? number('operator.saturation_mm') ?? 1,
      supply: number('supply.pressure_pa') / 1e3,
      exhaust: number('exhaust.pressure_pa') / 1e3,
    };
    this.#incline.describe(number('load.incline_deg') ?? 0);
    const words = {
      controller: `${text('controller.law')}, ${text('controller.loop')} loop`,
      period: `every ${round(1e3 * number('controller.period_s'))} ms`,
      operator: text('operator.model'),
      valve: text('valve.model'),
      tubing: text('tubing.model'),
      cylinder: `${round(1e3 * number('actuator.bore_m'))} mm bore, ${round(this.#rig.stroke)} mm stroke${cushioned(text('actuator.cushion'))}`,
      load: `${round(number('load.mass_kg'))} kg`,
      supply: `${round(this.#rig.supply)} kPa${receiver(text('supply.model'), number('supply.receiver_volume_m3'))}`,
      exhaust: `exhaust ${round(this.#rig.exhaust)} kPa`,
      sensing: text('encoder.model') === 'potentiometer' ? 'potentiometer' : `${round(1e3 * number('encoder.mm_per_count'))} µm a count`,
      faults: shortened(text('name')),
    };
    for (const [id, word] of Object.entries(words)) say(this.#parts[`${id}-text`], word);
    this.#parts['rod-left'].toggleAttribute('hidden', text('actuator.model') !== 'symmetric');
  }

  /** Takes away the words and the run of a rig. */
  forget() {
    [this.#rig, this.#run] = [null, null];
    for (const [id, shown] of Object.entries(this.#parts)) if (id.endsWith('-text')) say(shown, '');
    for (const outlined of [this.#parts.wanted, this.#parts.moved]) place(outlined, { d: '' });
  }

  /** Takes the run that the picture shows. */
  follow(run) {
    this.#run = run;
    const x = (time) => WANTED.left + ((WANTED.right - WANTED.left) * time) / (run.time.at(-1) || 1);
    const wanted = run.curves.get('setpoint') ?? run.curves.get('command');
    place(this.#parts.wanted, { d: outline(run.time, wanted, x, WANTED, true) });
    place(this.#parts.moved, { d: outline(run.time, run.curves.get('position'), x, WANTED, false, wanted) });
    this.#parts.x = x;
  }

  /** Moves everything to its position at a time, s. */
  moveTo(time) {
    if (!this.#run || !this.#rig) return;
    const k = Math.min(placeOf(this.#run.time, time), this.#run.time.length - 1);
    const at = (name) => finiteOr(0, this.#run.curves.get(name)?.[k]);
    const x = this.#movePiston(at('position'));
    const pressure = (chamber) => finiteOr(undefined, this.#run.curves.get(`pressure ${chamber}`)?.[k]);
    this.#colour('chamber-1', pressure(1), BARREL.left, x - BARREL.left);
    this.#colour('chamber-2', pressure(2), x + PISTON, BARREL.right - x - PISTON);
    this.#moveSpool(at('spool'));
    this.#showFlow('flow-1', at('flow 1'));
    this.#showFlow('flow-2', at('flow 2'));
    say(this.#parts['command-text'], `${at('command').toFixed(0)} counts`);
    const now = this.#parts.x(time);
    place(this.#parts.now, { x1: now, x2: now });
    this.#moveTarget(finiteOr(undefined, this.#run.curves.get('setpoint')?.[k]));
  }

  #pistonAt(mm) {
    const share = Math.min(Math.max(mm / this.#rig.stroke, -0.02), 1.02);
    return BARREL.left + 8 + share * (BARREL.right - BARREL.left - PISTON - 16);
  }

  #movePiston(mm) {
    const x = this.#pistonAt(mm);
    const end = x + PISTON + (BARREL.right - BARREL.left) - LOAD.reach;
    this.#incline.moveTo(Math.min(Math.max(mm / this.#rig.stroke, 0), 1));
    place(this.#parts.piston, { x });
    place(this.#parts.rod, { x: x + PISTON, width: end - x - PISTON });
    place(this.#parts['rod-left'], { x: x - 150, width: 150 });
    place(this.#parts.load, { transform: `translate(${end - 706} 0)` });
    say(this.#parts['position-text'], `${mm.toFixed(2)} mm`);
    place(this.#parts['position-text'], { x: x + PISTON / 2 });
    return x;
  }

  #moveTarget(mm) {
    this.#parts.target.toggleAttribute('hidden', mm === undefined);
    if (mm === undefined) return;
    place(this.#parts.target, { transform: `translate(${this.#pistonAt(mm) + PISTON / 2} ${BARREL.bottom + 3})` });
  }

  /** A chamber whose pressure is not known is grey and has no figure. */
  #colour(id, kpa, x, width) {
    const { supply, exhaust } = this.#rig;
    const isKnown = kpa !== undefined;
    const share = isKnown ? Math.min(Math.max((kpa - exhaust) / (supply - exhaust), 0), 1) : 0;
    const colour = isKnown ? pressureColour(share) : NOT_KNOWN;
    place(this.#parts[id], { x, width: Math.max(width, 0), fill: colour });
    place(this.#parts[`${id}-tube`], { stroke: colour });
    const text = this.#parts[`${id}-text`];
    say(text, isKnown ? `${kpa.toFixed(0)} kPa` : '');
    place(text, { x: x + width / 2, visibility: width > 62 ? 'visible' : 'hidden' });
    text.style.fill = share > 0.72 ? '#ffffff' : '#14202c';
  }

  /** A spool that moves towards its operator opens chamber 1 to the supply, and chamber 2 to its exhaust. */
  #moveSpool(mm) {
    const share = Math.min(Math.max(mm / this.#rig.travel, -1.2), 1.2);
    place(this.#parts.spool, { transform: `translate(${-SPOOL_REACH * share} 0)` });
    say(this.#parts['spool-text'], `${mm.toFixed(3)} mm`);
  }

  /** An arrow in the direction of the air, the stronger the more of it. */
  #showFlow(id, grams) {
    const strength = Math.min(Math.abs(grams) / 5, 1);
    const part = this.#parts[id];
    place(part, { opacity: Math.abs(grams) < 0.02 ? 0 : 0.35 + 0.65 * strength });
    part.classList.toggle('out', grams < 0);
  }

  /** What connects the components. */
  #lines() {
    const line = (d) => svg('path', { d, class: 'signal' });
    return [
      line('M120 200 V168'), line('M220 112 H330 V249 H380'), line('M780 36 H120 V54'),
      svg('path', { d: `M${PORT.supply} 292 V${VALVE.bottom}`, class: 'pipe' }),
      ...PORT.exhausts.map((x) => svg('path', { d: `M${x} ${VALVE.bottom} v12 m-6 0 h12 l-6 9 z`, class: 'pipe' })),
    ];
  }

  #components(callbacks) {
    const drawn = {
      test: this.#wanted(), controller: this.#controller(), tubing: this.#tubing(), cylinder: this.#cylinder(),
      load: this.#load(), operator: this.#operator(), valve: this.#valve(), air: this.#air(), sensing: this.#sensing(),
      faults: this.#faults(),
    };
    return COMPONENTS.map(({ id, title }) => {
      const group = svg('g', { class: 'component', tabindex: 0, role: 'button', 'data-id': id },
        svg('title', {}, title), ...drawn[id]);
      group.addEventListener('click', () => callbacks.chosen(id));
      group.addEventListener('keydown', (event) => {
        if (event.key === 'Enter' || event.key === ' ') {
          event.preventDefault();
          callbacks.chosen(id);
        }
      });
      this.#groups[id] = group;
      return group;
    });
  }

  /** An element that moves or changes, under a name. */
  #part(name, element) {
    this.#parts[name] = element;
    return element;
  }

  #text(name, x, y, kind = 'small') {
    return this.#part(`${name}-text`, svg('text', { x, y, class: kind }));
  }

  #wanted() {
    const { left, right, top, bottom } = WANTED;
    return [
      box(20, 200, 200, 112), svg('text', { x: 120, y: 326, class: 'title' }, 'Test move'),
      this.#part('now', svg('line', { x1: left, x2: left, y1: top - 6, y2: bottom + 6, class: 'now' })),
      this.#part('moved', svg('path', { class: 'moved' })), this.#part('wanted', svg('path', { class: 'wanted' })),
      svg('path', { d: `M${left} ${bottom + 6} H${right}`, class: 'axis' }),
    ];
  }

  #controller() {
    return [
      box(20, 54, 200, 114), svg('text', { x: 120, y: 82, class: 'title' }, 'Controller'),
      this.#text('controller', 120, 106), this.#text('period', 120, 124), this.#text('command', 120, 150, 'value'),
    ];
  }

  #operator() {
    return [
      box(372, 226, 80, 46), svg('text', { x: 400, y: 290, class: 'title' }, 'Operator'), this.#text('operator', 400, 306),
      svg('path', { d: 'M384 260 L400 238 M398 260 L414 238 M412 260 L428 238', class: 'coil' }),
    ];
  }

  #valve() {
    const land = (x) => svg('rect', { x: x - LAND / 2, y: 234, width: LAND, height: 30, class: 'land' });
    const lands = [land(PORT.one), land(PORT.two)];
    const rod = svg('rect', { x: 456, y: 246, width: 232, height: 6, class: 'spool-rod' });
    return [
      box(VALVE.left, VALVE.top, VALVE.right - VALVE.left, VALVE.bottom - VALVE.top, 'body'),
      this.#part('spool', svg('g', {}, rod, ...lands)),
      svg('text', { x: 706, y: 244, class: 'title start' }, 'Valve'), this.#text('valve', 706, 260, 'small start'),
      this.#text('spool', 706, 276, 'value start'),
    ];
  }

  #tubing() {
    const tube = (name, x, to) => {
      const d = `M${x} ${VALVE.top} V188 H${to} V${BARREL.bottom}`;
      return [
        svg('path', { d, class: 'tube-wall' }), this.#part(name, svg('path', { d, class: 'tube' })),
      ];
    };
    const arrow = (name, x) => this.#part(name, svg('g', { class: 'flow' }, svg('path', { d: `M${x - 7} 212 l7 -12 l7 12 z`, class: 'in' }),
      svg('path', { d: `M${x - 7} 200 l7 12 l7 -12 z`, class: 'back' })));
    return [
      ...tube('chamber-1-tube', PORT.one, 456), ...tube('chamber-2-tube', PORT.two, 690),
      arrow('flow-1', PORT.one), arrow('flow-2', PORT.two),
      svg('text', { x: 573, y: 186, class: 'title' }, 'Tubes'), this.#text('tubing', 573, 202),
    ];
  }

  #cylinder() {
    const { left, right, top, bottom } = BARREL;
    const chamber = (name) => this.#part(name, svg('rect', { y: top, height: bottom - top }));
    return [
      chamber('chamber-1'), chamber('chamber-2'),
      svg('rect', { x: left, y: top, width: right - left, height: bottom - top, class: 'barrel' }),
      this.#part('rod-left', svg('rect', { y: 108, height: 12, class: 'rod', hidden: true })),
      this.#part('rod', svg('rect', { y: 108, height: 12, class: 'rod' })),
      this.#part('piston', svg('rect', { y: top, width: PISTON, height: bottom - top, class: 'piston' })),
      this.#text('chamber-1', 0, 104, 'pressure'), this.#text('chamber-2', 0, 104, 'pressure'),
      this.#text('position', 0, 70, 'value'),
      this.#part('target', svg('path', { d: 'M0 0 l6 10 h-12 z', class: 'target' })),
      svg('text', { x: left, y: 53, class: 'title start' }, 'Cylinder'), this.#text('cylinder', left + 62, 53, 'small start'),
    ];
  }

  #load() {
    const body = svg('rect', { x: 706, y: 82, width: LOAD.width, height: 64, class: 'load' });
    return [this.#part('load', svg('g', {}, body, svg('text', { x: 742, y: 110, class: 'title' }, 'Load'), this.#text('load', 742, 128)))];
  }

  #air() {
    return [
      svg('circle', { cx: PORT.supply, cy: 306, r: 14, class: 'supply' }),
      svg('path', { d: `M${PORT.supply - 6} 311 l6 -11 l6 11 z`, class: 'supply-mark' }),
      svg('text', { x: PORT.supply + 22, y: 302, class: 'title start' }, 'Air supply'),
      this.#text('supply', PORT.supply + 22, 318, 'small start'), this.#text('exhaust', 706, 318, 'small start'),
    ];
  }

  #sensing() {
    return [
      box(780, 14, 160, 44), svg('text', { x: 860, y: 33, class: 'title' }, 'Encoder, sensors'), this.#text('sensing', 860, 49),
    ];
  }

  #faults() {
    return [
      box(800, 226, 140, 46), svg('text', { x: 870, y: 246, class: 'title' }, 'Name and faults'), this.#text('faults', 870, 262),
    ];
  }
}

function box(x, y, width, height, kind = 'box') {
  return svg('rect', { x, y, width, height, rx: 6, class: kind });
}

/** A name, shortened to fit its box. */
function shortened(name) {
  return name.length > 20 ? `${name.slice(0, 19)}…` : name;
}

/** A number of the rig; a rig may lack it. */
function finiteOr(other, number) {
  return Number.isFinite(number) ? number : other;
}

/** A number with three digits, as it is spoken. */
function round(number) {
  return Number.isFinite(number) ? String(Number(number.toPrecision(3))) : '–';
}

/** The colour of air of unknown pressure. */
const NOT_KNOWN = '#c8ced6';

/** What the ends of the cylinder have. */
function cushioned(cushion) {
  return cushion === 'adjustable' ? ', cushioned' : '';
}

/** What is between the supply and the valve, by its volume in m3. */
function receiver(model, volume) {
  const words = { receiver: 'receiver of', regulator: 'regulator with' }[model];
  return words ? `, ${words} ${round(1e3 * volume)} l` : '';
}

/** The colours from the exhaust's pressure to the supply's. */
function pressureColour(share) {
  const [low, high] = [[219, 231, 244], [24, 84, 152]];
  return `rgb(${low.map((part, k) => Math.round(part + (high[k] - part) * share)).join(' ')})`;
}

/** A small curve, on the scale of `by` where that is another one in the same unit. */
function outline(time, values, x, { top, bottom }, isStepped, by = values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of by) {
    if (!Number.isFinite(value)) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high) return '';
  const y = (value) => bottom - ((bottom - top) * (Math.min(Math.max(value, low - 0.1 * (high - low)), high + 0.1 * (high - low)) - low)) / (high - low || 1);
  const every = Math.max(1, Math.floor(time.length / 300));
  const points = [];
  for (let k = 0; k < time.length; k += isStepped ? 1 : every) {
    const isSame = isStepped && k > 0 && k < time.length - 1 && values[k] === values[k - 1];
    if (isSame || !Number.isFinite(values[k])) continue;
    if (isStepped && points.length > 0) points.push(`H${x(time[k]).toFixed(1)}`);
    points.push(`${points.length ? 'L' : 'M'}${x(time[k]).toFixed(1)} ${y(values[k]).toFixed(1)}`);
  }
  return points.join(' ');
}
