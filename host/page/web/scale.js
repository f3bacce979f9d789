// A scale from values to pixels, with round ticks.

/** Values from `low` to `high` on pixels from `from` to `to`. */
export function scaleOf(low, high, from, to) {
  const factor = (to - from) / (high - low || 1);
  const scale = (value) => from + (value - low) * factor;
  scale.back = (pixel) => low + (pixel - from) / factor;
  return scale;
}

/** Round numbers between two ends, some `count` of them. */
export function ticks(low, high, count) {
  const step = roundStep((high - low) / Math.max(count, 1));
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: Math.max(last - first + 1, 0) }, (_, k) => (first + k) * step);
}

/** The next 1, 2 or 5 times a power of ten. */
function roundStep(step) {
  if (!(step > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(step));
  return [1, 2, 5, 10].map((digit) => digit * power).find((candidate) => candidate >= step * (1 - 1e-9));
}

/** A number with as many decimals as the distance of the ticks needs. */
export function tickText(value, step) {
  const decimals = Math.max(0, -Math.floor(Math.log10(step || 1) + 1e-9));
  return (Math.abs(value) < step * 1e-6 ? 0 : value).toFixed(Math.min(decimals, 9));
}

/** The first place in sorted times that is not before one. */
export function placeOf(times, time) {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < time) low = middle + 1;
    else high = middle;
  }
  return low;
}
