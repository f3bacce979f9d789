// What the address says of the page: its view, its rig, and the graphs that are shown.
//
// `#view=study&rig=servo-c&graphs=position,velocity`: behind the #, so the browser keeps it to itself.

/** What the address has now; what it does not have is undefined. */
export function readAddress() {
  const said = new URLSearchParams(location.hash.slice(1));
  const graphs = said.get('graphs')?.split(',').filter(Boolean);
  return { view: said.get('view') ?? undefined, rig: said.get('rig') ?? undefined, graphs };
}

/** Puts something else into the address; `isStep`: Back returns to what it has now. */
export function writeAddress(changes, isStep = false) {
  const { view, rig, graphs } = { ...readAddress(), ...changes };
  const said = new URLSearchParams();
  if (view) said.set('view', view);
  if (rig) said.set('rig', rig);
  if (graphs) said.set('graphs', graphs.join(','));
  const hash = `#${decodeURIComponent(said)}`;
  if (hash === decodeURIComponent(location.hash)) return;
  if (isStep) history.pushState(null, '', hash);
  else history.replaceState(null, '', hash);
}
