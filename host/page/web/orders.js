// The orders of the page to the drive, one after the other; only a stop waits for nothing.

/** Orders that confirm what the one before has said: of each kind, one at a time waits or is on its way. */
const CONFIRMATIONS = ['alive', 'extend', 'retract'];

/** How long the server may take to answer a stop, ms. */
const PATIENCE = 3000;

/** Orders, sent with `post(path, body, signal)`. `callbacks.stopped(problem)` hears of every stop; the problem of a sound one is ''. */
export class Orders {
  #post;
  #callbacks;
  #queue = Promise.resolve();
  /** How many orders wait or are on their way. */
  #pending = 0;
  /** The confirmations that wait or are on their way. */
  #out = new Set();
  /** How often the drive was stopped. */
  #stops = 0;

  constructor(post, callbacks) {
    this.#post = post;
    this.#callbacks = callbacks;
  }

  /**
   * Gives an order of the page that commands with this number, behind those before it: a button that was let go must not be
   * overtaken by its last confirmation. It is dropped if the drive is stopped before its turn comes, or if it `isWanted` no more.
   * Resolves to whether it was sent.
   */
  give(number, order, more = {}, isWanted = () => true) {
    const isConfirmation = CONFIRMATIONS.includes(order);
    if (isConfirmation && this.#out.has(order)) return Promise.resolve(false);
    if (isConfirmation) this.#out.add(order);
    const stops = this.#stops;
    return this.#behind(async () => {
      try {
        if (stops !== this.#stops || !isWanted()) return false;
        await this.#post('/api/order', { number, order, ...more });
        return true;
      } finally {
        this.#out.delete(order);
      }
    });
  }

  /** Stops the drive at once, and again behind an order that is on its way and may come later. */
  stop() {
    this.#stops += 1;
    const isAlone = this.#pending === 0;
    const first = this.#stop();
    return isAlone ? first : this.#behind(() => this.#stop());
  }

  #behind(send) {
    this.#pending += 1;
    const sent = this.#queue.then(send).finally(() => { this.#pending -= 1; });
    this.#queue = sent.catch(() => {});
    return sent;
  }

  async #stop() {
    try {
      await this.#post('/api/order', { order: 'stop' }, AbortSignal.timeout(PATIENCE));
      this.#callbacks.stopped('');
    } catch (error) {
      this.#callbacks.stopped(error.name === 'TimeoutError' ? `the studio has not answered for ${PATIENCE / 1e3} s` : error.message);
    }
  }
}
