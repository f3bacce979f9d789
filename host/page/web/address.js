// The state of the page in its address: its view, its rig, and the graphs that are shown.
//
// `#view=study&rig=servo-c&graphs=position,velocity`: behind the #, so the browser keeps it to itself.

/** The state in the address; fields that it lacks are undefined. */
export function readAddress() {
  const said = new URLSearchParams(location.hash.slice(1));
  const graphs = said.get('graphs')?.split(',').filter(Boolean);
  return { view: said.get('view') ?? undefined, rig: said.get('rig') ?? undefined, graphs };
}

/** Puts another state into the address; `isStep`: Back returns to the present one. */
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
