// What was changed on the page: settings by the path of their key, with undo.

/** A slider that is dragged makes many changes and one step of the history. */
export class History {
  #past = [];
  #future = [];
  #kept = {};
  settings = {};

  /** Gives a key a value, as it is typed; null: that of the file. The step ends with `keep`. */
  set(path, text) {
    const { [path]: _, ...others } = this.settings;
    this.settings = text === null ? others : { ...others, [path]: text };
  }

  /** Ends a step. Whether anything has changed in it. */
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
