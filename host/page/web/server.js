// Requests to the server. Each shows the token that came with the address.

import { Refused, columnsOf } from './answer.js';

export { Refused };

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
export async function* lines(path, signal, body = {}) {
  const answer = await ask(path, { method: 'POST', body: JSON.stringify(body), signal });
  const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
  let heard = '';
  for (let { done, value } = await reader.read(); !done; { done, value } = await reader.read()) {
    const parts = (heard + value).split('\n');
    heard = parts.pop();
    for (const part of parts) yield JSON.parse(part);
  }
}

/** Asks for long work; `told` hears how far it is. */
export async function study(body, signal, told) {
  for await (const { at, found, refused, status } of lines('/api/study', signal, body)) {
    if (found) return found;
    if (refused) throw new Refused(status, refused);
    told(at);
  }
  throw new Error('the studio has ended before the study');
}

/** Posts, and takes numbers over time: `{ head, time, columns: [{ name, unit, values }] }`. */
export async function postForColumns(path, body, signal) {
  const answer = await ask(path, { method: 'POST', body: JSON.stringify(body), signal });
  return columnsOf(await answer.arrayBuffer());
}
