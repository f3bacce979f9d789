// The rig of the page as a file.

import { asked, told } from './dialog.js';
import { post } from './server.js';
import { html } from './svg.js';

/** Asks for the name of a file and writes the rig there; `saved(rig)` takes what was written. */
export async function save(rig, saved) {
  const name = /\.toml$/.test(rig.name) ? rig.name.split('/').at(-1) : `${rig.name}.toml`;
  const field = html('input', { id: 'file-name', value: name, autocomplete: 'off', spellcheck: 'false' });
  const content = [html('label', { for: 'file-name' }, 'Name of the rig file'), field];
  const file = await asked('Save', content, 'Save', () => field.value.trim());
  if (file) await write({ ...rig, file, replace: false }, saved);
}

async function write(request, saved) {
  try {
    await saved(await post('/api/save', request));
  } catch (error) {
    if (error.status !== 409) return told('Not saved', error.message);
    const question = [html('p', {}, `${error.message}. Replace it?`)];
    if (await asked('Replace the file?', question, 'Replace')) await write({ ...request, replace: true }, saved);
  }
}
