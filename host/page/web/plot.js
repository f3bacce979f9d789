// Graphs one below the other, with one axis of time, one cursor and one zoom.
//
// The curves lie on one canvas and the cursor on another, so that a cursor that moves draws no curve again.

import { PANELS, drawPanel, isThere } from './panel.js';
import { inColoursOfPaper, onPrint, toPng } from './paper.js';
import { placeOf, scaleOf, ticks, tickText } from './scale.js';
import { html } from './svg.js';
import { VectorContext } from './vector.js';

const LEFT = 56;
const LEGEND = 168;
const BOTTOM = 22;
const GAP = 10;

/** A graph is no lower than this, pixels: below it, its legend and its ticks do not fit. */
const LEAST = 140;

/** The graphs. `callbacks.cursor(time)` hears where the cursor stands, s. */
export class Plot {
  #element;
  #callbacks;
  #curves = html('canvas', { 'aria-hidden': 'true' });
  #marks = html('canvas', { 'aria-hidden': 'true' });
  #runs = [];
  #shown = new Set(['position', 'pressures', 'spool']);
  #view = null;
  #drawn = [];
  #cursor = 0;
  #drag = null;
  #frame = 0;
  #after = [];
  /** The size of the element, pixels, and the colours: asked for once, as every question makes the browser lay out the page. */
  #size = null;
  #palette = null;
  /** Drawing times of the newest frames, ms. */
  drawing = [];

  constructor(element, callbacks) {
    this.#element = element;
    this.#callbacks = callbacks;
    element.append(this.#curves, this.#marks);
    new ResizeObserver(([{ contentRect: { width, height } }]) => {
      this.#size = { width: Math.round(width), height: Math.round(height) };
      this.#redraw();
    }).observe(element);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
      this.#palette = null;
      this.#redraw();
    });
    onPrint(() => {
      this.#palette = null;
      this.#draw();
      this.#drawMarks();
    });
    this.#listen();
  }

  /** Shows runs, the newest last: `{ label, time, curves, band, isGhost }`. `drawn` is called once they are, if it is given. */
  show(runs, drawn = null) {
    this.#runs = runs;
    if (drawn) this.#after.push(drawn);
    this.#redraw();
  }

  /** The run whose values are shown at the cursor. */
  get #run() {
    return this.#runs.at(-1);
  }

  isShown(id) {
    return this.#shown.has(id);
  }

  /** Which graphs are shown, of all that there may be. */
  get shown() {
    return PANELS.map(({ id }) => id).filter((id) => this.#shown.has(id));
  }

  /** Shows a graph or hides it. */
  toggle(id) {
    if (!this.#shown.delete(id)) this.#shown.add(id);
    this.#redraw();
  }

  get cursor() {
    return this.#cursor;
  }

  /** Puts the cursor to a time, s. */
  moveTo(time) {
    this.#cursor = Math.min(Math.max(time, 0), this.#end);
    this.#drawMarks();
    this.#callbacks.cursor(this.#cursor);
  }

  get #end() {
    return Math.max(...this.#runs.map((run) => run.time.at(-1) ?? 0), 1e-3);
  }

  /** The visible time range, s. */
  get view() {
    return { from: 0, to: this.#end, ...this.#view };
  }

  /** Shows a time range, s; without one, the whole time. */
  zoom(from = 0, to = this.#end) {
    const isAll = from <= 0 && to >= this.#end;
    this.#view = isAll || to - from < 1e-4 ? null : { from: Math.max(from, 0), to: Math.min(to, this.#end) };
    this.#redraw();
  }

  #redraw() {
    if (this.#frame) return;
    this.#frame = requestAnimationFrame(() => {
      this.#frame = 0;
      const begun = performance.now();
      this.#draw();
      this.#drawMarks();
      this.drawing = [...this.drawing.slice(-199), performance.now() - begun];
      this.#after.splice(0).forEach((drawn) => drawn());
    });
  }

  #draw() {
    this.#makeRoom();
    this.#size ??= { width: this.#element.clientWidth, height: this.#element.clientHeight };
    this.#palette ??= colours(this.#element);
    // A view that is hidden has no size, and nothing is drawn in it.
    if (!this.#isVisible) return;
    this.#drawn = this.#drawPanels(fitted(this.#curves, this.#size), this.#size, this.#palette);
  }

  get #isVisible() {
    return this.#size !== null && this.#size.width > 0 && this.#size.height > 0;
  }

  get #panels() {
    return PANELS.filter((panel) => this.#shown.has(panel.id) && isThere(panel, this.#runs));
  }

  /** Makes room for the graphs that are shown: the page scrolls. */
  #makeRoom() {
    const least = `${BOTTOM + this.#panels.reduce((sum, panel) => sum + LEAST * panel.height, 0)}px`;
    if (this.#element.style.minHeight !== least) this.#element.style.minHeight = least;
  }

  /** Draws all graphs that are shown; tells where they are. */
  #drawPanels(context, { width, height }, palette) {
    const panels = this.#panels;
    const view = { ...this.view, colours: palette };
    view.ticks = ticks(view.from, view.to, (width - LEFT - LEGEND) / 90);
    const share = (height - BOTTOM) / panels.reduce((sum, panel) => sum + panel.height, 0);
    let top = 0;
    const drawn = panels.map((panel) => {
      const box = { left: LEFT, right: width - LEGEND, top: top + GAP, bottom: top + panel.height * share };
      top = box.bottom;
      return drawPanel(context, panel, box, this.#runs, view);
    });
    if (drawn.length) drawTime(context, view, drawn[0], height);
    return drawn;
  }

  /** The cursor, and the values at it. */
  #drawMarks() {
    if (!this.#isVisible || this.#palette === null) return;
    const context = fitted(this.#marks, this.#size);
    if (!this.#run) return;
    for (const drawn of this.#drawn) this.#drawLegend(context, this.#palette, drawn);
    this.#drawSelection(context, this.#palette);
  }

  #drawLegend(context, palette, { panel, box, x, y }) {
    const { time, curves } = this.#run;
    const k = Math.min(placeOf(time, this.#cursor), time.length - 1);
    const at = x(this.#cursor);
    if (at >= box.left && at <= box.right) {
      context.fillStyle = palette.text;
      context.fillRect(Math.round(at), box.top, 1, box.bottom - box.top);
    }
    context.font = '12px system-ui, sans-serif';
    context.textBaseline = 'middle';
    context.textAlign = 'left';
    context.fillStyle = palette.muted;
    context.fillText([panel.id, panel.unit].filter(Boolean).join(', '), box.right + 10, box.top + 6);
    const names = panel.curves.filter((name) => curves.has(name));
    names.forEach((name, row) => {
      const value = curves.get(name)[k];
      const line = box.top + 22 + 15 * row;
      context.fillStyle = palette[name] ?? palette.text;
      context.fillRect(box.right + 10, line - 1, 12, 3);
      context.fillStyle = palette.text;
      context.textAlign = 'left';
      context.fillText(name, box.right + 28, line);
      context.textAlign = 'right';
      context.fillText(valueText(value, panel.unit), box.right + LEGEND - 4, line);
      if (at < box.left || at > box.right || !Number.isFinite(value)) return;
      context.beginPath();
      context.arc(at, y(value), 3, 0, 2 * Math.PI);
      context.fillStyle = palette[name] ?? palette.text;
      context.fill();
    });
  }

  #drawSelection(context, palette) {
    if (!this.#drag || Math.abs(this.#drag.to - this.#drag.from) < 4) return;
    context.globalAlpha = 0.15;
    context.fillStyle = palette.text;
    const { from, to } = this.#drag;
    context.fillRect(Math.min(from, to), 0, Math.abs(to - from), this.#size.height);
    context.globalAlpha = 1;
  }

  /** The graphs as a picture under a title, with the ground of the page. */
  toPng(title) {
    const style = getComputedStyle(this.#element);
    const [ground, text] = ['--surface', '--text'].map((name) => style.getPropertyValue(name));
    const { width, height } = this.#size;
    const draw = (context) => { for (const layer of [this.#curves, this.#marks]) context.drawImage(layer, 0, 0, width, height); };
    return toPng([{ width, height, draw }], title, { ground, text });
  }

  /** The graphs as an SVG element, in the colours of paper. */
  toSvg() {
    const { clientWidth: width, clientHeight: height } = this.#element;
    return inColoursOfPaper(() => {
      const ground = getComputedStyle(this.#element).getPropertyValue('--surface').trim();
      const context = new VectorContext(width, height, ground);
      const palette = colours(this.#element);
      const panels = this.#drawPanels(context, { width, height }, palette);
      if (this.#run) for (const drawn of panels) this.#drawLegend(context, palette, drawn);
      return context.element;
    });
  }

  /** The values at the cursor as text, for users who do not see the graphs. */
  readout() {
    if (!this.#run) return '';
    const { time, curves } = this.#run;
    const k = Math.min(placeOf(time, this.#cursor), time.length - 1);
    const values = this.#drawn.flatMap(({ panel }) => panel.curves.filter((name) => curves.has(name))
      .map((name) => `${name} ${valueText(curves.get(name)[k], panel.unit)} ${panel.unit}`));
    return `at ${this.#cursor.toFixed(4)} s: ${values.join(', ')}`;
  }

  #timeAt(event) {
    const box = this.#drawn[0]?.box;
    if (!box) return 0;
    const pixel = event.clientX - this.#element.getBoundingClientRect().left;
    const { from, to } = this.view;
    return scaleOf(from, to, box.left, box.right).back(Math.min(Math.max(pixel, box.left), box.right));
  }

  #listen() {
    const element = this.#element;
    const pixel = (event) => event.clientX - element.getBoundingClientRect().left;
    element.addEventListener('pointerdown', (event) => {
      this.#drag = { from: pixel(event), to: pixel(event), time: this.#timeAt(event) };
      element.setPointerCapture(event.pointerId);
    });
    element.addEventListener('pointermove', (event) => {
      if (this.#drag) this.#drag.to = pixel(event);
      this.moveTo(this.#timeAt(event));
    });
    element.addEventListener('pointerup', (event) => this.#endDrag(this.#timeAt(event)));
    element.addEventListener('pointercancel', () => { this.#drag = null; });
    element.addEventListener('dblclick', () => this.zoom());
    element.addEventListener('wheel', (event) => {
      // Without Control the wheel moves the page, which is longer than the window.
      if (!event.ctrlKey) return;
      event.preventDefault();
      this.#zoomBy(1.2 ** Math.sign(event.deltaY), this.#timeAt(event));
    }, { passive: false });
    element.addEventListener('keydown', (event) => this.#key(event));
  }

  #endDrag(time) {
    const drag = this.#drag;
    this.#drag = null;
    if (drag && Math.abs(drag.to - drag.from) > 4) this.zoom(Math.min(drag.time, time), Math.max(drag.time, time));
    this.#drawMarks();
  }

  #zoomBy(factor, around) {
    const { from, to } = this.view;
    this.zoom(around - (around - from) * factor, around + (to - around) * factor);
  }

  #key(event) {
    const { from, to } = this.view;
    const step = (to - from) / (event.shiftKey ? 1000 : 100);
    const keys = {
      ArrowLeft: () => this.moveTo(this.#cursor - step),
      ArrowRight: () => this.moveTo(this.#cursor + step),
      Home: () => this.moveTo(from),
      End: () => this.moveTo(to),
      '+': () => this.#zoomBy(1 / 1.5, this.#cursor),
      '-': () => this.#zoomBy(1.5, this.#cursor),
      0: () => this.zoom(),
    };
    if (!(event.key in keys) || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    keys[event.key]();
  }
}

/** The axis of time, below the lowest graph. */
function drawTime(context, view, { x, box }, height) {
  const step = view.ticks[1] - view.ticks[0];
  context.fillStyle = view.colours.muted;
  context.textAlign = 'center';
  context.textBaseline = 'alphabetic';
  for (const time of view.ticks) context.fillText(`${tickText(time, step)}`, x(time), height - 6);
  context.textAlign = 'left';
  context.fillText('time, s', box.right + 8, height - 6);
}

/** The context of a canvas of this size, cleared, in pixels of the page. */
function fitted(canvas, { width, height }) {
  const scale = devicePixelRatio;
  const [wide, tall] = [Math.round(width * scale), Math.round(height * scale)];
  if (canvas.width !== wide || canvas.height !== tall) [canvas.width, canvas.height] = [wide, tall];
  const context = canvas.getContext('2d');
  context.setTransform(scale, 0, 0, scale, 0, 0);
  context.clearRect(0, 0, width, height);
  return context;
}

/** Colours of channels, from the style sheet: `--curve-pressure-1`. */
function colours(element) {
  const style = getComputedStyle(element);
  const of = (name) => style.getPropertyValue(name).trim();
  const names = PANELS.flatMap((panel) => panel.curves);
  const channels = names.map((name) => [name, of(`--curve-${name.replaceAll(' ', '-')}`)]);
  return { text: of('--text'), muted: of('--muted'), grid: of('--grid'), ...Object.fromEntries(channels) };
}

/** Decimals by unit: the resolution of the controller. */
const DECIMALS = { mm: 3, kPa: 1, 'mm/s': 1, counts: 0, K: 1, 'g/s': 3, N: 1, 'm/s2': 2, "of the file's": 3 };

/** A value with the decimals of its unit. */
export function valueText(value, unit) {
  return Number.isFinite(value) ? value.toFixed(DECIMALS[unit] ?? 3) : '–';
}
