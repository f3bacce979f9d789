// What was changed on the page: settings by the path of their key, with undo.

/** A slider that is dragged makes many changes and one step of the history. */
export class History {
  #past = [];
  #future = [];
  #kept = {};
  settings = {};

  /** One that was told before, or an empty one. */
  static from(told) {
    const made = new History();
    if (told) [made.#past, made.#future, made.#kept, made.settings] = [told.past, told.future, told.settings, told.settings];
    return made;
  }

  /** Everything of it, to be kept elsewhere; null if nothing was changed. */
  get told() {
    if (Object.keys(this.settings).length === 0 && !this.canUndo && this.#future.length === 0) return null;
    const isKept = JSON.stringify(this.settings) === JSON.stringify(this.#kept);
    return { past: isKept ? this.#past : [...this.#past, this.#kept], future: this.#future, settings: this.settings };
  }

  /**
   * The same steps as changes to a file that holds the present settings. `before(path)` is the setting of a key in the old
   * file, null where it had none: undo goes back no further than that.
   */
  rebased(before) {
    const saved = Object.keys(this.settings);
    const step = (settings) => {
      const back = saved.filter((path) => !(path in settings)).map((path) => [path, before(path)]);
      if (back.some(([, setting]) => setting === null)) return null;
      const others = Object.entries(settings).filter(([path, setting]) => setting !== this.settings[path]);
      return Object.fromEntries([...others, ...back]);
    };
    const past = this.#past.map(step);
    const made = new History();
    made.#past = past.slice(past.lastIndexOf(null) + 1);
    return made;
  }

  /** Gives a key a value, as it was typed; null: the value of the file. The step ends with `keep`. */
  set(path, text) {
    const { [path]: _, ...others } = this.settings;
    this.settings = text === null ? others : { ...others, [path]: text };
  }

  /** Ends a step; returns whether anything changed in it. */
  keep() {
    if (JSON.stringify(this.settings) === JSON.stringify(this.#kept)) return false;
    this.#past.push(this.#kept);
    this.#future = [];
    this.#kept = this.settings;
    return true;
  }

  undo() {
    this.#go(this.#past, this.#future);
  }

  redo() {
    this.#go(this.#future, this.#past);
  }

  get canUndo() {
    return this.#past.length > 0;
  }

  get canRedo() {
    return this.#future.length > 0;
  }

  /** Whether these are the settings of the last step that has ended. */
  isKept(settings) {
    return JSON.stringify(settings) === JSON.stringify(Object.values(this.#kept));
  }

  #go(from, to) {
    if (from.length === 0) return;
    to.push(this.#kept);
    this.#kept = from.pop();
    this.settings = this.#kept;
  }
}

/** A change as `--set` takes it. A number with a unit of its own goes to the key without its unit. */
export function settingOf(key, text) {
  const hasUnit = key.unit && ['number', 'integer'].includes(key.kind.type) && Number.isNaN(Number(text)) && /\d/.test(text);
  const isWord = key.kind.type === 'text' && !text.startsWith('"');
  return `${hasUnit ? key.stem : key.path}=${isWord ? JSON.stringify(text) : text}`;
}
