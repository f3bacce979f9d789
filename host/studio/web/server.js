// Requests to the server. Each shows the token that came with the address.

const STORED = 'pneudrive-token';

/** Takes the token out of the address, where it would stay in the history of the browser. */
function token() {
  const given = new URLSearchParams(location.hash.slice(1)).get('token');
  if (given) {
    sessionStorage.setItem(STORED, given);
    history.replaceState(null, '', location.pathname);
  }
  return sessionStorage.getItem(STORED) ?? '';
}

const AUTHORIZATION = `Bearer ${token()}`;

/** A request that was refused: why, and what is wrong with the rig if that is why. */
export class Refused extends Error {
  constructor(status, { error, problems }) {
    super(error ?? `the server answers ${status}`);
    this.status = status;
    this.problems = problems ?? [];
  }
}

async function ask(path, options) {
  const headers = { Authorization: AUTHORIZATION, 'Content-Type': 'application/json' };
  const answer = await fetch(path, { ...options, headers });
  if (answer.ok) return answer;
  throw new Refused(answer.status, await answer.json().catch(() => ({})));
}

export async function get(path) {
  return (await ask(path)).json();
}

export async function post(path, body, signal) {
  const answer = await ask(path, { method: 'POST', body: JSON.stringify(body), signal });
  return answer.status === 202 ? null : answer.json();
}

/** Posts, and takes lines of JSON as they come. */
export async function* lines(path, signal) {
  const answer = await ask(path, { method: 'POST', body: '{}', signal });
  const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
  let heard = '';
  for (let { done, value } = await reader.read(); !done; { done, value } = await reader.read()) {
    const parts = (heard + value).split('\n');
    heard = parts.pop();
    for (const part of parts) yield JSON.parse(part);
  }
}

/** Posts, and takes numbers over time: `{ head, time, columns: [{ name, unit, values }] }`. */
export async function postForColumns(path, body, signal) {
  const answer = await ask(path, { method: 'POST', body: JSON.stringify(body), signal });
  return columnsOf(await answer.arrayBuffer());
}

/** Takes the bytes apart that `columns.rs` describes. */
function columnsOf(buffer) {
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
