// Requests to the server. Each shows the token that came with the address.

import { Refused, columnsOf } from './answer.js';

export { Refused };

const STORED = 'pneudrive-token';

/** Number of connections that a browser opens to one server; further requests wait. */
const CONNECTIONS = 6;

/** Connections for orders to the drive alone, so that a stop never waits: one for the stop, one for the order before it. */
const FOR_ORDERS = 2;

/** Takes the token out of the address, where it would stay in the history of the browser. */
function token() {
  const given = new URLSearchParams(location.hash.slice(1)).get('token');
  if (given) {
    sessionStorage.setItem(STORED, given);
    const others = location.hash.slice(1).split('&').filter((part) => !part.startsWith('token='));
    history.replaceState(null, '', `${location.pathname}${others.length ? `#${others.join('&')}` : ''}`);
  }
  return sessionStorage.getItem(STORED) ?? '';
}

const AUTHORIZATION = `Bearer ${token()}`;

let taken = 0;
const waiting = [];

/** Waits for a connection that is not reserved for orders, until the signal aborts. */
async function takeConnection(signal) {
  signal?.throwIfAborted();
  while (taken >= CONNECTIONS - FOR_ORDERS) await turn(signal);
  taken += 1;
}

function turn(signal) {
  return new Promise((resolve, reject) => {
    const come = () => {
      signal?.removeEventListener('abort', leave);
      resolve();
    };
    const leave = () => {
      waiting.splice(waiting.indexOf(come), 1);
      reject(signal.reason);
    };
    waiting.push(come);
    signal?.addEventListener('abort', leave, { once: true });
  });
}

function leaveConnection() {
  taken -= 1;
  waiting.shift()?.();
}

async function fetched(path, options) {
  const headers = { Authorization: AUTHORIZATION, 'Content-Type': 'application/json' };
  const answer = await fetch(path, { ...options, headers });
  if (answer.ok) return answer;
  throw new Refused(answer.status, await answer.json().catch(() => ({})));
}

/** Sends a request, and reads the answer with `read`. */
async function ask(path, options, read) {
  if (path === '/api/order') return read(await fetched(path, options));
  await takeConnection(options.signal);
  try {
    return await read(await fetched(path, options));
  } finally {
    leaveConnection();
  }
}

const posted = (body, signal) => ({ method: 'POST', body: JSON.stringify(body), signal });

export async function get(path) {
  return ask(path, {}, (answer) => answer.json());
}

export async function post(path, body, signal) {
  return ask(path, posted(body, signal), (answer) => (answer.status === 202 ? null : answer.json()));
}

/** Posts, and takes lines of JSON as they come. */
export async function* lines(path, signal, body = {}) {
  await takeConnection(signal);
  let reader = null;
  try {
    const answer = await fetched(path, posted(body, signal));
    reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
    let heard = '';
    for (let { done, value } = await reader.read(); !done; { done, value } = await reader.read()) {
      const parts = (heard + value).split('\n');
      heard = parts.pop();
      for (const part of parts) yield JSON.parse(part);
    }
  } finally {
    // Whoever leaves before the end leaves the connection open otherwise.
    await reader?.cancel().catch(() => {});
    leaveConnection();
  }
}

/** Requests long work; `callbacks` receives its progress. */
export async function study(body, signal, callbacks) {
  for await (const { at, found, refused, status } of lines('/api/study', signal, body)) {
    if (found) return found;
    if (refused) throw new Refused(status, refused);
    callbacks(at);
  }
  throw new Error('the studio has ended before the study');
}

/** Posts, and takes numbers over time: `{ head, time, columns: [{ name, unit, values }] }`. */
export async function postForColumns(path, body, signal) {
  return columnsOf(await ask(path, posted(body, signal), (answer) => answer.arrayBuffer()));
}
