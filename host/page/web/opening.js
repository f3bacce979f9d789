// What the page opens: rigs of the list, files and folders, and the rig of its address with the changes that are in no file yet.

import { readAddress } from './address.js';
import { editsOf, rigWithEdits } from './edits.js';
import { History } from './history.js';
import { chosenFiles, chosenFolder, dropped } from './incoming.js';
import { Memory } from './memory.js';
import { RigList } from './rig-list.js';
import { get } from './server.js';

const part = (id) => document.getElementById(id);

/**
 * `started` is the rig that the studio was started with. `callbacks.open(rig, news, history)` takes a rig, `callbacks.lay(content)` a record or
 * a run folder, `callbacks.went(address)` what the address says of view and graphs, `callbacks.failed(error)` why something cannot be opened.
 */
export class Opening {
  #rigs;
  #started;
  #callbacks;
  #memory;
  #rig = null;

  constructor({ builtin, opened: started }, callbacks) {
    this.#rigs = new RigList(part('rigs'), builtin);
    this.#started = started;
    this.#callbacks = callbacks;
    this.#memory = new Memory({ went: (address) => this.#went(address), others: (count) => { part('others').hidden = count === 0; } });
    this.#listen();
  }

  /** The rigs that come with the program. */
  get names() {
    return this.#rigs.names;
  }

  /** Begins with what the address says. */
  async begin() {
    const address = readAddress();
    this.#callbacks.went(address);
    await this.#openAgain(await this.#rigOf(address.rig));
  }

  /** A rig is open, with its changes. */
  opened(rig, history) {
    this.#rig = rig;
    this.#rigs.show(rig.name);
    this.#memory.opened(rig, history, this.#rigs.isFile(rig.name));
  }

  /** Its changes are others. */
  changed() {
    this.#memory.changed();
  }

  /** A rig by its name: as the studio has it, else as it was when it was changed on a page. */
  async #rigOf(name) {
    if (name === undefined) return this.#started;
    try {
      return { ...await get(`/api/rigs/${encodeURIComponent(name.split(/[\\/]/).at(-1))}`), name };
    } catch {
      return rigWithEdits(name) ?? this.#started;
    }
  }

  /** Opens a rig with the changes that were made to it before. */
  #openAgain(rig) {
    const edits = editsOf(rig);
    const count = Object.keys(edits?.settings ?? {}).length;
    const are = count === 1 ? 'is' : 'are';
    const news = count ? `${count} ${count === 1 ? 'change' : 'changes'} ${are} back that ${are} in no file yet` : '';
    return this.#callbacks.open(rig, news, History.from(edits));
  }

  /** Back and Forward. */
  async #went(address) {
    this.#callbacks.went(address);
    if (address.rig === undefined || address.rig === this.#rig.name) return;
    await this.#openAgain(await this.#rigOf(address.rig));
  }

  #listen() {
    part('rigs').addEventListener('change', () => this.#openChosen(part('rigs').value));
    part('open').addEventListener('click', () => part('file').click());
    part('file').addEventListener('change', ({ target }) => this.#takeIn(chosenFiles(target.files), target));
    part('folder').addEventListener('change', ({ target }) => this.#takeIn(chosenFolder(target.files).then((run) => [run]), target));
    document.addEventListener('dragover', (event) => event.preventDefault());
    document.addEventListener('drop', (event) => {
      event.preventDefault();
      this.#takeIn(dropped(event.dataTransfer));
    });
  }

  /** Opens a rig of the list, unless another one has been chosen or opened meanwhile. */
  async #openChosen(name) {
    const before = this.#rig;
    try {
      const rig = await get(`/api/rigs/${name}`);
      if (part('rigs').value === name && this.#rig === before) await this.#callbacks.open(rig);
    } catch (error) {
      if (part('rigs').value === name) this.#callbacks.failed(error);
    }
  }

  /** Opens a rig file, and lays records and run folders over the run; `chosen` may be chosen again. */
  async #takeIn(incoming, chosen = null) {
    try {
      for (const content of await incoming) {
        const isRig = content.text !== undefined && content.name.endsWith('.toml');
        await (isRig ? this.#callbacks.open(content) : this.#callbacks.lay(content));
      }
    } catch (error) {
      this.#callbacks.failed(error);
    }
    if (chosen) chosen.value = '';
  }
}
