// Times of the page, for measurements.

const CHANGE = 'change to picture';

/** Number of times that are kept: a page may stay open for a day. */
const MAX = 500;

/** A change that was made at this time is a picture now. */
export function measureChange(since) {
  if (performance.getEntriesByName(CHANGE).length >= MAX) performance.clearMeasures(CHANGE);
  performance.measure(CHANGE, { start: since });
}
