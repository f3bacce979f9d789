// Answers to requests.

/** A request that was refused: the reason, and the problems of the rig if they are the reason. */
export class Refused extends Error {
  constructor(status, { error, problems }) {
    super(error ?? `the request was answered with ${status}`);
    this.status = status;
    this.problems = problems ?? [];
  }
}

/** Splits the bytes that `columns.rs` describes into columns. */
export function columnsOf(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  let place = 4 + length;
  const time = new Float64Array(buffer, place, head.rows);
  place += time.byteLength;
  const columns = head.columns.map((column) => {
    const values = new Float32Array(buffer, place, head.rows);
    place += values.byteLength;
    return { ...column, values };
  });
  return { head, time, columns };
}
