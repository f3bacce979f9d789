// The changes to each rig that are in no file yet, kept in the browser: a reload, Back and a closed tab lose none.

const PLACE = 'pneudrive-edits ';

/** Changes of more rigs than this are not kept: the oldest go. */
const RIGS = 20;

/** Keeps the changes to a rig; `history` is what `History.told` has, null: there are none. Whether the browser keeps them. */
export function keepEdits({ name, text }, history) {
  try {
    localStorage.removeItem(PLACE + name);
    if (history === null) return true;
    const others = Object.keys(localStorage).filter((place) => place.startsWith(PLACE));
    for (const place of others.sort((a, b) => timeOf(a) - timeOf(b)).slice(0, Math.max(others.length - RIGS + 1, 0))) localStorage.removeItem(place);
    localStorage.setItem(PLACE + name, JSON.stringify({ at: Date.now(), text, history }));
    return true;
  } catch {
    return history === null;
  }
}

function timeOf(place) {
  return read(place)?.at ?? 0;
}

function read(place) {
  try {
    return JSON.parse(localStorage.getItem(place));
  } catch {
    return null;
  }
}

/** The stored changes to a rig; null without any. If its file has changed since, they become one step. */
export function editsOf({ name, text }) {
  const found = read(PLACE + name);
  if (!found || found.text === text) return found?.history ?? null;
  const { settings } = found.history;
  return Object.keys(settings).length ? { past: [{}], future: [], settings } : null;
}

/** The name of a changed rig that the studio does not have; null without one. */
export function rigWithEdits(name) {
  const found = read(PLACE + name);
  return found ? { name, text: found.text } : null;
}
