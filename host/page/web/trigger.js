// Where a channel crosses a level.

/**
 * When a channel first crosses a level after a time: the time of the sample behind the crossing; null if it does not. Samples
 * on both sides of a gap are no crossing, as nobody knows what was between them.
 */
export function crossing(time, values, { after, level, isRising }) {
  const sign = isRising ? 1 : -1;
  for (let k = 1; k < time.length; k += 1) {
    if (time[k] > after && sign * (values[k - 1] - level) < 0 && sign * (values[k] - level) >= 0) return time[k];
  }
  return null;
}
