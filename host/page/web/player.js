// Plays the move in real time.

/** Moves the cursor of the graphs, from where it stands to the end. `end()` gives that, s. */
export class Player {
  #button;
  #plot;
  #end;
  #frame = null;

  constructor(button, plot, end) {
    this.#button = button;
    this.#plot = plot;
    this.#end = end;
    button.addEventListener('click', () => (this.#frame ? this.#pause() : this.#play()));
  }

  #play() {
    const end = this.#end();
    const begun = performance.now();
    const from = this.#plot.cursor < end ? this.#plot.cursor : 0;
    this.#button.textContent = 'Pause';
    const step = (now) => {
      const time = from + (now - begun) / 1e3;
      this.#plot.moveTo(time);
      if (time >= end) return this.#pause();
      this.#frame = requestAnimationFrame(step);
    };
    this.#frame = requestAnimationFrame(step);
  }

  #pause() {
    cancelAnimationFrame(this.#frame);
    this.#frame = null;
    this.#button.textContent = 'Play';
  }
}
