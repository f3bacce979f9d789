// The checks of a new board, one after the other, with a hand at the drive: what `device bring-up` does.

import { offer } from './export.js';
import { html } from './svg.js';

/** The checks. `callbacks.ask(question, more)` asks the server, `callbacks.order(order, more)` orders something. */
export class BringUp {
  #callbacks;
  #parts = {};
  #isOn = false;
  #report = null;
  /** The outcome, once the checks are over: the report and the last state of the drive may come in either order. */
  #summary = '';

  constructor(callbacks) {
    this.#callbacks = callbacks;
  }

  /** Builds its part of the panel. */
  show() {
    const button = (name, text, act, kind = null) => {
      this.#parts[name] = html('button', { type: 'button', class: kind }, text);
      this.#parts[name].addEventListener('click', act);
      return this.#parts[name];
    };
    const number = (name, label, value, unit) => {
      this.#parts[name] = html('input', { type: 'text', id: `bring-up-${name}`, inputmode: 'numeric', size: 4, value });
      return html('p', { class: 'row' }, html('label', { for: `bring-up-${name}` }, label), this.#parts[name], unit);
    };
    this.#parts.checks = html('ol', { class: 'checks' });
    this.#parts.now = html('p', { class: 'now', role: 'status' });
    this.#parts.question = html('p', { class: 'question', role: 'alert' });
    this.#parts.problem = html('p', { class: 'problem', role: 'alert' });
    this.#parts.answers = html('p', { class: 'row' }, button('yes', 'Yes', () => this.#answer(true), 'main'), button('no', 'No', () => this.#answer(false)));
    this.#parts.answers.hidden = true;
    const element = html('details', { class: 'bring-up' }, html('summary', {}, 'Bring-up of a new board'),
      html('p', { class: 'remark' }, 'From checks that move nothing to short pulses of the valve. The page asks before the cylinder moves. The test on the drive is replaced, and its parameters stay.'),
      number('wait', 'Time to push the slide by hand', '20', 's'), number('most', 'Largest pulse', '30', '% of the valve'),
      html('p', { class: 'row' }, button('begin', 'Begin', () => this.#begin(), 'main'), button('abort', 'End', () => this.#callbacks.order('abort')),
        button('save', 'Save the report', () => this.#save())),
      this.#parts.problem, this.#parts.checks, this.#parts.now, this.#parts.question, this.#parts.answers);
    this.#parts.save.hidden = true;
    this.enable(false);
    return element;
  }

  get isOn() {
    return this.#isOn;
  }

  /** Whether the checks may begin. */
  enable(mayBegin) {
    this.#parts.begin.disabled = !mayBegin || this.#isOn;
    this.#parts.abort.disabled = !this.#isOn;
  }

  /** Shows the progress. */
  heard({ is_on: isOn, now, question, checks }) {
    this.#isOn = isOn;
    this.#parts.now.textContent = isOn ? now : this.#summary;
    this.#parts.question.textContent = question?.text ?? '';
    this.#parts.answers.hidden = !question;
    if (question && this.#parts.answers.dataset.question !== String(question.number)) {
      this.#parts.answers.dataset.question = question.number;
      this.#parts.answers.scrollIntoView({ block: 'nearest' });
    }
    const shown = this.#parts.checks.children.length;
    if (checks.length < shown) this.#parts.checks.replaceChildren();
    this.#parts.checks.append(...checks.slice(this.#parts.checks.children.length).map(itemOf));
  }

  /** The link has ended. */
  ended() {
    if (this.#isOn) this.heard({ is_on: false, now: '', question: null, checks: [] });
    this.enable(false);
  }

  #answer(yes) {
    this.#parts.answers.hidden = true;
    this.#callbacks.order('answer', { question: Number(this.#parts.answers.dataset.question), yes });
  }

  async #begin() {
    this.#parts.problem.textContent = '';
    this.#summary = '';
    this.#parts.checks.replaceChildren();
    this.#parts.save.hidden = true;
    this.#parts.begin.disabled = true;
    const [wait, most] = [this.#parts.wait, this.#parts.most].map((field) => Number(field.value.trim() || NaN));
    try {
      if (![wait, most].every(Number.isInteger)) throw new Error('give whole numbers of s and of %');
      this.#report = await this.#callbacks.ask('bring-up', { push_wait_s: wait, most_percent: most });
      const { summary, wrong } = this.#report;
      this.#summary = wrong.length ? `${summary}. Each comes with its remedy.` : `${summary}.`;
      this.#parts.now.textContent = this.#summary;
      this.#parts.save.hidden = false;
    } catch (error) {
      this.#parts.problem.textContent = error.message;
    }
  }

  #save() {
    offer('bring-up.md', new Blob([this.#report.text], { type: 'text/markdown' }));
  }
}

/** A finished check. */
function itemOf({ name, saw, must, verdict, advice }) {
  const isWrong = verdict === 'wrong';
  return html('li', { class: verdict.replace(' ', '-') }, html('strong', {}, verdict), ` ${name}: ${saw}`,
    ...(isWrong ? [html('br'), `must be: ${must}`] : []), ...advice.flatMap((line) => [html('br'), `do: ${line}`]));
}
