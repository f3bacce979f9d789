// How long the page takes, for measurements.

const CHANGE = 'change to picture';

/** A page that stands open for a day keeps no more than the last ones. */
const MAX = 500;

/** A change that was made at this time is a picture now. */
export function measureChange(since) {
  if (performance.getEntriesByName(CHANGE).length >= MAX) performance.clearMeasures(CHANGE);
  performance.measure(CHANGE, { start: since });
}
