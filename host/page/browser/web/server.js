// The requests of the page, answered in its own workers: the designer is here, as WebAssembly, and there is no server.

import { Refused, columnsOf } from './answer.js';
import { offer } from './export.js';

export { Refused };

const compiled = fetch(new URL('designer.wasm', import.meta.url)).then(async (answer) => {
  if (!answer.ok) throw new Error(`designer.wasm is not beside the page (${answer.status})`);
  return WebAssembly.compile(await answer.arrayBuffer());
});

/** A worker that answers one kind of request. A request that is called off ends it; the next one starts another. */
class Desk {
  #worker = null;
  #waiting = new Map();
  #last = 0;

  async ask(request, body, signal, told) {
    const module = await compiled;
    signal?.throwIfAborted();
    this.#worker ??= this.#begin(module);
    this.#last += 1;
    const number = this.#last;
    return new Promise((resolve, reject) => {
      this.#waiting.set(number, { resolve, reject, told });
      signal?.addEventListener('abort', () => this.#end(signal.reason), { once: true });
      this.#worker.postMessage({ number, request, body });
    });
  }

  #begin(module) {
    const worker = new Worker(new URL('worker.js', import.meta.url), { type: 'module' });
    worker.onmessage = ({ data }) => this.#answered(data);
    worker.onerror = ({ message }) => this.#end(new Error(message));
    worker.postMessage({ module });
    return worker;
  }

  #answered({ number, status, bytes, failure, at }) {
    const asked = this.#waiting.get(number);
    if (at) return asked?.told(at);
    this.#waiting.delete(number);
    if (failure) {
      asked?.reject(new Refused(500, { error: `the designer failed: ${failure}` }));
      return this.#end(new Error(failure));
    }
    if (status === 200) return asked?.resolve(bytes);
    return asked?.reject(new Refused(status, toJson(bytes)));
  }

  #end(reason) {
    this.#worker?.terminate();
    this.#worker = null;
    for (const { reject } of this.#waiting.values()) reject(reason);
    this.#waiting.clear();
  }
}

const desks = new Map();

/** The bytes of an answer; `told` hears how far a study is. */
export function ask(path, body, signal, told) {
  const request = path.replace('/api/', '');
  if (!desks.has(request)) desks.set(request, new Desk());
  return desks.get(request).ask(request, body, signal, told);
}

const toJson = (buffer) => JSON.parse(new TextDecoder().decode(buffer));

export async function get(path) {
  const [, , request, name] = path.split('/');
  return toJson(await (name === undefined ? ask(path) : ask('/api/rig', decodeURIComponent(name))));
}

export async function post(path, body, signal) {
  if (path === '/api/save') return save(body);
  return toJson(await ask(path, body, signal));
}

/** Gives the rig file to the reader, whose browser keeps it where it keeps downloads. */
async function save(body) {
  const written = toJson(await ask('/api/written', body));
  offer(written.name, new Blob([written.text], { type: 'application/toml' }));
  return written;
}

/** There is no drive behind a page without a server. */
export async function* lines(path) {
  throw new Refused(404, { error: `${path} needs \`pneudrive studio --port\`` });
}

/** Asks for long work; `told` hears how far it is. */
export async function study(body, signal, told) {
  return toJson(await ask('/api/study', body, signal, told));
}

/** Posts, and takes numbers over time: `{ head, time, columns: [{ name, unit, values }] }`. */
export async function postForColumns(path, body, signal) {
  return columnsOf(await ask(path, body, signal));
}
