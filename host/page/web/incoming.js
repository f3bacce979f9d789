// Files and run folders that are dropped on the page, or chosen.
//
// A file is `{ name, text }`. A run folder, as `simulate --out` writes it, is `{ name, run_json, trace_csv }`.

import { Refused } from './answer.js';

const [RUN, TRACE] = ['run.json', 'trace.csv'];

/** What was dropped, in its order. */
export function dropped({ items, files }) {
  // Entries are gone once the event is over.
  const entries = [...items].map((item) => item.webkitGetAsEntry());
  if (!entries.some((entry) => entry?.isDirectory)) return Promise.all([...files].map(ofFile));
  return Promise.all(entries.filter(Boolean).map(async (entry) =>
    (entry.isDirectory ? ofFolder(entry.name, await filesIn(entry)) : ofFile(await fileOf(entry)))));
}

/** The files that were chosen. */
export function chosenFiles(files) {
  return Promise.all([...files].map(ofFile));
}

/** The folder that was chosen: its own files, and none of the folders in it. */
export function chosenFolder(files) {
  const own = [...files].filter(({ webkitRelativePath: path }) => path.split('/').length === 2);
  return ofFolder([...files][0]?.webkitRelativePath.split('/')[0] ?? 'the folder', own);
}

async function ofFile(file) {
  return { name: file.name, text: await file.text() };
}

async function ofFolder(name, files) {
  const [run, trace] = [RUN, TRACE].map((wanted) => files.find((file) => file.name === wanted));
  if (!run || !trace) throw new Refused(422, { error: `${name} is not the folder of a run: it has no ${run ? TRACE : RUN}` });
  return { name, run_json: await run.text(), trace_csv: await trace.text() };
}

/** A folder tells its entries in parts, and none once it has told all. */
async function filesIn(folder) {
  const reader = folder.createReader();
  const found = [];
  for (let part = await read(reader); part.length > 0; part = await read(reader)) found.push(...part);
  return Promise.all(found.filter(({ isFile }) => isFile).map(fileOf));
}

function read(reader) {
  return new Promise((resolve, reject) => reader.readEntries(resolve, reject));
}

function fileOf(entry) {
  return new Promise((resolve, reject) => entry.file(resolve, reject));
}
