// The curves for other programs.

/** A run as CSV: time and curves, with their units in the first line. */
export function toCsv({ time, curves, units }) {
  const names = [...curves.keys()];
  const head = ['time (s)', ...names.map((name) => `${name} (${units.get(name)})`)].join(',');
  const row = (at, k) => [at, ...names.map((name) => curves.get(name)[k])].join(',');
  return new Blob([head, '\n', Array.from(time, row).join('\n'), '\n'], { type: 'text/csv' });
}

/** An SVG element as a file. */
export function toFile(element) {
  return new Blob([new XMLSerializer().serializeToString(element)], { type: 'image/svg+xml' });
}

/** Offers a file to be saved. */
export function offer(name, content) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(content);
  link.download = name.split('/').at(-1);
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** Copies the content of a field; the button confirms it. */
export async function copyFrom(field, button) {
  field.select();
  await navigator.clipboard.writeText(field.value).catch(() => document.execCommand('copy'));
  button.textContent = 'Copied';
  setTimeout(() => { button.textContent = 'Copy'; }, 1500);
}
