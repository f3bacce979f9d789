// Other tabs of this browser that have the same rig file.

const CHANNEL = 'pneudrive-studio';

/** Tells the other tabs which rig this one has; `told(count)` hears how many of them have it, too. */
export class OtherTabs {
  #channel = new BroadcastChannel(CHANNEL);
  #id = crypto.getRandomValues(new Uint32Array(2)).join('-');
  #name = null;
  #others = new Set();
  #told;

  constructor(told) {
    this.#told = told;
    this.#channel.addEventListener('message', ({ data }) => this.#hear(data));
    addEventListener('pagehide', () => this.#say('leaves'));
    addEventListener('pageshow', ({ persisted }) => { if (persisted) this.has(this.#name); });
  }

  /** This tab has a rig now; null: one that is no file. */
  has(name) {
    if (this.#name !== name) this.#say('leaves');
    this.#name = name;
    this.#others.clear();
    this.#say('has');
    this.#told(0);
  }

  #say(what) {
    if (this.#name !== null) this.#channel.postMessage({ what, id: this.#id, name: this.#name });
  }

  #hear({ what, id, name }) {
    if (name !== this.#name) return;
    if (what === 'leaves') this.#others.delete(id);
    else this.#others.add(id);
    // Who comes later learns of those that are there.
    if (what === 'has') this.#say('has too');
    this.#told(this.#others.size);
  }
}
