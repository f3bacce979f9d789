// The parameters of the drive, beside those of the rig that was designed.

import { html } from './svg.js';

/** The table. `callbacks.ask(question, more)` asks the server, `callbacks.rig()` is the rig of the page. */
export class Parameters {
  #callbacks;
  #parts = {};
  #rows = new Map();
  #isThere = false;
  /** How many readings have been asked for; only the newest counts. */
  #asked = 0;
  /** The rig that the drive was compared with, as text, and what was found; null before the first reading. */
  #compared = null;

  constructor(callbacks) {
    this.#callbacks = callbacks;
  }

  /** Builds its part of the panel. */
  show() {
    const button = (name, text, act, kind = null) => {
      this.#parts[name] = html('button', { type: 'button', class: kind, disabled: true }, text);
      this.#parts[name].addEventListener('click', () => this.#done(act));
      return this.#parts[name];
    };
    this.#parts.state = html('p', { role: 'status' }, 'Take command to read them.');
    this.#parts.problem = html('p', { class: 'problem', role: 'alert' });
    this.#parts.only = html('input', { type: 'checkbox', id: 'only-differing' });
    this.#parts.only.addEventListener('change', () => this.#filter());
    this.#parts.rows = html('div', {});
    this.element = html('details', { class: 'parameters' }, html('summary', {}, 'Parameters of the drive'), this.#parts.state,
      html('p', { class: 'row' }, button('send', 'Send', () => this.#send(), 'main'), button('save', 'Save on the drive', () => this.#save()),
        button('read', 'Read again', () => this.#read())),
      html('p', { class: 'row' }, this.#parts.only, html('label', { for: 'only-differing' }, 'only what differs or is edited'),
        button('design', 'Take over the design', () => this.#takeDesign())),
      this.#parts.problem, this.#parts.rows);
    this.element.addEventListener('toggle', () => { if (this.element.open && this.#isThere && !this.#rows.size) this.#done(() => this.#read()); });
    return this.element;
  }

  /** Whether there is a drive to ask; without one, its parameters are unknown. */
  enable(isThere) {
    if (isThere === this.#isThere) return;
    this.#isThere = isThere;
    if (!isThere) {
      this.#asked += 1;
      this.#compared = null;
      this.#rows.clear();
      this.#parts.rows.replaceChildren();
      this.#parts.state.textContent = 'Take command to read them.';
    }
    this.#count();
    if (isThere && this.element.open) this.#done(() => this.#read());
  }

  /** The rig of the page may be another: says so if the comparison is of the one before. */
  designChanged() {
    if (this.#compared) this.#tell();
  }

  /** Does something, and tells why it could not be done: each problem at its field, the others below the buttons. */
  async #done(act) {
    this.#parts.problem.textContent = '';
    for (const row of this.#rows.values()) row.complain('');
    try {
      await act();
    } catch (error) {
      const here = (error.problems ?? []).filter(({ key }) => this.#rows.has(key));
      for (const { key, message } of here) this.#rows.get(key).complain(message);
      this.#parts.problem.textContent = here.length ? 'Nothing was changed; see below.' : error.message;
    }
    this.#count();
  }

  async #read() {
    this.#asked += 1;
    const number = this.#asked;
    const design = this.#callbacks.rig();
    const { rig, saved, parameters } = await this.#callbacks.ask('parameters', { rig: design });
    if (number !== this.#asked) return;
    const edits = new Map([...this.#rows].filter(([, row]) => row.isEdited).map(([path, row]) => [path, row.text]));
    this.#rows = new Map(parameters.map((parameter) => [parameter.path, new Row(parameter, rig, () => this.#count())]));
    for (const [path, text] of edits) this.#rows.get(path)?.put(text);
    const groups = Map.groupBy(parameters, ({ table }) => table);
    this.#parts.rows.replaceChildren(...[...groups].map(([table, ofTable]) => html('section', {}, html('h3', {}, table),
      ...ofTable.map(({ path }) => this.#rows.get(path).element))));
    const differing = parameters.filter(({ differs }) => differs).length;
    const kept = saved ? 'All are saved on the drive.' : 'Not saved: a reset of the drive restores the saved ones.';
    this.#compared = { design: JSON.stringify(design), figures: `${differing} of ${parameters.length} differ from ${rig}`, saved, kept };
    this.#tell();
    this.#filter();
  }

  /** Whether the rig of the page is no longer the one that the drive was compared with. */
  get #isStale() {
    return this.#compared?.design !== JSON.stringify(this.#callbacks.rig());
  }

  #tell() {
    const { figures, saved, kept } = this.#compared;
    const isStale = this.#isStale;
    const text = `${figures}${isStale ? ' as it was before: the rig of the page has changed; read again' : ''}. ${kept}`;
    if (this.#parts.state.textContent !== text) this.#parts.state.textContent = text;
    this.#parts.state.classList.toggle('unsaved', isStale || !saved);
  }

  async #send() {
    const edited = [...this.#rows].filter(([, row]) => row.isEdited);
    await this.#callbacks.ask('change', { values: edited.map(([path, row]) => [path, row.text]) });
    for (const [, row] of edited) row.sent();
    await this.#read();
  }

  async #save() {
    await this.#callbacks.ask('save');
    await this.#read();
  }

  /** Edits all that differs from the rig as it is now; it is not sent yet. */
  async #takeDesign() {
    await this.#read();
    if (this.#isThere && this.#isStale) throw new Error('the rig of the page has changed meanwhile: take its design over again');
    for (const row of this.#rows.values()) row.takeDesign();
  }

  #count() {
    const edited = [...this.#rows.values()].filter((row) => row.isEdited).length;
    this.#parts.send.textContent = edited ? `Send ${edited} ${edited === 1 ? 'change' : 'changes'}` : 'Send';
    this.#parts.send.disabled = !this.#isThere || edited === 0;
    for (const name of ['save', 'read', 'design']) this.#parts[name].disabled = !this.#isThere || this.#rows.size === 0;
    this.#filter();
  }

  #filter() {
    for (const row of this.#rows.values()) row.element.hidden = this.#parts.only.checked && !row.differs && !row.isEdited;
  }
}

/** One parameter: its name, its value on the drive, the designed one, and what is wrong with an edit. */
class Row {
  #parameter;
  #input;
  #mark = html('span', { class: 'origin' });
  #problem;
  #edited;

  constructor(parameter, rig, edited) {
    this.#parameter = parameter;
    this.#edited = edited;
    const { path, name, unit, range, meaning, words, value, designed, differs } = parameter;
    const id = `drive-${path.replace('.', '-')}`;
    const facts = { id, 'aria-describedby': `${id}-help ${id}-problem`, disabled: value === null };
    this.#input = words.length ? html('select', facts, ...words.map((word) => html('option', { value: word }, word)))
      : html('input', { ...facts, type: 'text', autocomplete: 'off', spellcheck: 'false', placeholder: value === null ? 'not in its firmware' : null });
    this.#problem = html('p', { class: 'problem', id: `${id}-problem`, role: 'alert' });
    const design = html('small', { class: 'design' }, differs ? `${rig}: ${designed} ${unit}`.trim() : '');
    const help = html('p', { class: 'help', id: `${id}-help` }, meaning, html('br'), html('code', {}, path), ` · ${range}`);
    this.element = html('div', { class: 'field parameter', 'data-parameter': path }, html('label', { for: id }, name),
      this.#input, html('span', { class: 'unit' }, unit), this.#mark, design, this.#problem, help);
    this.#input.value = value ?? '';
    this.#input.addEventListener('input', () => this.#change());
    this.#show();
  }

  get text() {
    return this.#input.value.trim();
  }

  get isEdited() {
    return this.#parameter.value !== null && this.text !== this.#parameter.value;
  }

  get differs() {
    return this.#parameter.differs;
  }

  put(text) {
    this.#input.value = text;
    this.#show();
  }

  takeDesign() {
    if (this.differs) this.put(this.#parameter.designed);
    this.#edited();
  }

  /** The drive has taken the value. */
  sent() {
    this.#parameter.value = this.text;
  }

  /** Shows what is wrong; nothing for an empty message. */
  complain(message) {
    this.#problem.textContent = message;
    this.element.classList.toggle('wrong', message !== '');
    this.#input.setAttribute('aria-invalid', String(message !== ''));
  }

  #change() {
    this.complain('');
    this.#show();
    this.#edited();
  }

  #show() {
    const mark = this.isEdited ? 'edited' : (this.differs ? 'differs' : '');
    this.#mark.textContent = mark;
    this.#mark.title = this.isEdited ? `${this.#parameter.value} on the drive` : '';
    this.#mark.className = `origin ${mark}`;
  }
}
