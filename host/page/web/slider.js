// The range of a slider, and the values of its positions.
//
// The range of a key is all that can be simulated, which is far more than one wants to drag through. A slider goes from a
// quarter of the file's value to four times it, in equal ratios, within the range of the key; from the low to the high of
// a value of which the file says these, if that is more.

const STEPS = 400;

/** A slider for a number of a key around the value that the file has; null where there is nothing to drag. */
export function sliderFor(kind, value, stated) {
  if (!['number', 'integer'].includes(kind.type) || !Number.isFinite(value) || value === 0) return null;
  const size = Math.abs(value);
  const spread = [size / 4, size * 4, ...(stated ?? []).map(Math.abs).filter((end) => end > 0)];
  const ends = [Math.min(...spread), Math.max(...spread)].map((end) => Math.sign(value) * end);
  const [low, high] = ends.map((end) => Math.min(Math.max(end, kind.min), kind.max));
  if (low === high || low * high <= 0) return null;
  const ratio = high / low;
  const rounded = kind.type === 'integer' ? Math.round : (number) => Number(number.toPrecision(3));
  const within = (number) => Math.min(Math.max(number, kind.min), kind.max);
  return {
    steps: STEPS,
    /** The value at a position, 0 to STEPS. */
    valueAt: (step) => within(rounded(low * ratio ** (step / STEPS))),
    /** The position of a value. */
    stepOf: (number) => {
      const share = number / low > 0 ? Math.log(number / low) / Math.log(ratio) : 0;
      return Math.round(STEPS * Math.min(Math.max(share, 0), 1));
    },
  };
}
