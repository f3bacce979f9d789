// The views of the page: which parts each of them shows.

import { writeAddress } from './address.js';

const VIEWS = {
  design: ['verdict', 'drive', 'inspector', 'figures', 'same'],
  commission: ['readouts', 'verdict', 'drive', 'commission', 'figures', 'same'],
  study: ['exhibit', 'study'],
};

const part = (id) => document.getElementById(id);

/** Shows a view, of which the address tells; Back returns to the one before. */
export function choose(view) {
  writeAddress({ view: view === 'design' ? undefined : view }, true);
  show(view);
}

/** Shows the view of the address. */
export function showAddressed(view = 'design') {
  const isThere = view in VIEWS && !part(`to-${view}`).hidden;
  show(isThere ? view : 'design');
}

function show(view) {
  for (const id of new Set(Object.values(VIEWS).flat())) part(id).hidden = !VIEWS[view].includes(id);
  document.body.dataset.view = view;
  for (const name of Object.keys(VIEWS)) part(`to-${name}`).setAttribute('aria-pressed', String(name === view));
}

/** Offers the views; `chosen(view)` hears which is taken. */
export function offerViews(hasDrive, chosen) {
  part('views').hidden = false;
  part('to-commission').hidden = !hasDrive;
  for (const view of Object.keys(VIEWS)) {
    part(`to-${view}`).addEventListener('click', () => {
      choose(view);
      chosen(view);
    });
  }
}
