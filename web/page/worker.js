// Does the work beside the page, so that the page can show progress and can end it.

import init, { Job, look } from "./breakaway.js";

// The WebAssembly calls these two by name.
self.onStep = (json) => self.postMessage({ kind: "step", step: JSON.parse(json) });
let panic = null;
self.onPanic = (text) => { panic = text; };

/** The bytes of a file. A browser refuses one that was moved or changed since it was chosen. */
async function read(file) {
  try {
    return new Uint8Array(await file.arrayBuffer());
  } catch (error) {
    throw `${file.name}: the browser cannot read the file; choose it again (${error.name})`;
  }
}

const tasks = {
  async look({ file }) {
    return JSON.parse(look(file.name, await read(file)));
  },
  async run({ columns, fit, holdout }) {
    const job = new Job(JSON.stringify(columns));
    for (const [files, heldOut] of [[fit, false], [holdout, true]]) {
      for (const file of files) job.add(file.name, await read(file), heldOut);
    }
    return JSON.parse(job.run());
  },
};

const ready = init();

self.onmessage = async ({ data }) => {
  try {
    await ready;
    self.postMessage({ kind: "done", result: await tasks[data.task](data) });
  } catch (error) {
    const text = typeof error === "string" ? error : `the program itself failed: ${panic ?? error}`;
    self.postMessage({ kind: "failed", text });
  }
};
