// A drawing surface like a canvas's, which keeps what is drawn as SVG.

import { svg } from './svg.js';

/** Takes the calls that the graphs make of a canvas's context. */
export class VectorContext {
  #root;
  #path = '';
  #clip = null;
  #clips = 0;
  #dash = [];
  #saved = [];
  font = '11px system-ui, sans-serif';
  fillStyle = '#000';
  strokeStyle = '#000';
  lineWidth = 1;
  lineJoin = 'round';
  globalAlpha = 1;
  textAlign = 'left';
  textBaseline = 'alphabetic';

  /** A surface of this size, pixels, on a ground of this colour. */
  constructor(width, height, ground) {
    this.#root = svg('svg', { viewBox: `0 0 ${width} ${height}`, width, height });
    this.#root.append(svg('rect', { width, height, fill: ground }));
  }

  /** The picture as SVG. */
  get element() {
    return this.#root;
  }

  beginPath() {
    this.#path = '';
  }

  moveTo(x, y) {
    this.#path += `M${short(x)} ${short(y)}`;
  }

  lineTo(x, y) {
    this.#path += `${this.#path ? 'L' : 'M'}${short(x)} ${short(y)}`;
  }

  rect(x, y, width, height) {
    this.#path += `M${short(x)} ${short(y)}h${short(width)}v${short(height)}h${short(-width)}z`;
  }

  /** A whole circle: the graphs draw no other arcs. */
  arc(x, y, radius) {
    this.#path += `M${short(x - radius)} ${short(y)}a${radius} ${radius} 0 1 0 ${2 * radius} 0a${radius} ${radius} 0 1 0 ${-2 * radius} 0z`;
  }

  clip() {
    this.#clips += 1;
    this.#clip = `part-${this.#clips}`;
    this.#root.append(svg('clipPath', { id: this.#clip }, svg('path', { d: this.#path })));
  }

  save() {
    this.#saved.push(this.#clip);
  }

  restore() {
    this.#clip = this.#saved.pop() ?? null;
  }

  setLineDash(dash) {
    this.#dash = dash;
  }

  stroke() {
    this.#add('path', {
      d: this.#path, fill: 'none', stroke: this.strokeStyle, 'stroke-width': this.lineWidth,
      'stroke-linejoin': this.lineJoin, 'stroke-dasharray': this.#dash.join(' ') || null,
    });
  }

  fill() {
    this.#add('path', { d: this.#path, fill: this.fillStyle });
  }

  fillRect(x, y, width, height) {
    this.#add('rect', { x: short(x), y: short(y), width: short(width), height: short(height), fill: this.fillStyle });
  }

  fillText(text, x, y) {
    const [size, family] = this.font.split(/px (.*)/);
    this.#add('text', {
      x: short(x), y: short(y), fill: this.fillStyle, 'font-size': size, 'font-family': family,
      'text-anchor': { left: 'start', center: 'middle', right: 'end' }[this.textAlign],
      'dominant-baseline': this.textBaseline === 'middle' ? 'central' : null,
    }, text);
  }

  #add(name, attributes, ...children) {
    const common = { opacity: this.globalAlpha < 1 ? this.globalAlpha : null, 'clip-path': this.#clip && `url(#${this.#clip})` };
    this.#root.append(svg(name, { ...attributes, ...common }, ...children));
  }
}

/** Two decimals: a hundredth of a pixel. */
function short(number) {
  return Number(number.toFixed(2));
}
