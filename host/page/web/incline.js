// How the axis stands in space. The drawing of the drive lies, as a diagram does; this small one stands as the axis does.

import { place, say, svg } from './svg.js';

/** Its position and size in the picture. */
const AT = 'translate(890 144)';

/** Travel of the piston in the picture. */
const REACH = 34;

/** A cylinder and its load at the angle of the load. */
export class Incline {
  #moved = svg('g', {}, svg('rect', { x: -40, y: -3, width: 44, height: 6, class: 'rod' }), svg('rect', { x: -40, y: -9, width: 5, height: 18, class: 'piston' }),
    svg('rect', { x: 4, y: -11, width: 12, height: 22, class: 'load' }));
  #axis = svg('g', {}, svg('rect', { x: -42, y: -9, width: 42, height: 18, class: 'barrel' }), this.#moved);
  #words = svg('text', { x: 890, y: 86, class: 'small' });
  element = svg('g', { id: 'incline', hidden: true }, this.#words, svg('g', { transform: AT }, this.#axis));

  /** Takes the angle at which extension goes uphill; an axis that lies is drawn as it is. */
  describe(degrees) {
    this.element.toggleAttribute('hidden', degrees === 0);
    place(this.#axis, { transform: `rotate(${-degrees})` });
    say(this.#words, Math.abs(degrees) === 90 ? `extends ${degrees > 0 ? 'up' : 'down'}` : `${Math.abs(degrees)}° ${degrees > 0 ? 'uphill' : 'downhill'}`);
  }

  /** Takes the place of the piston, of its stroke. */
  moveTo(share) {
    place(this.#moved, { transform: `translate(${REACH * share} 0)` });
  }
}
