// Runs commands of the program in a worker: an instance for each, so that nothing of one is left for the next.
//
// In:  {module}: the compiled program, once
//      {id, words, logs: [{name, file}], files: [{name, bytes}], digests: {name: digest}}: a command; logs are read through their handles, never
//      copied; digests of logs need not be taken again
//      {id, digested: {name, file}}: takes the digest of a log
// Out: {id, progress} while it works, then {id, code, out, err, files: [{name, bytes}]}, or {id, digest}, or {id, failed}
"use strict";
const FOLDER = "/work", NOTHING = "/none";
let compiled = null;

/** Bytes of a stream of the program, as they come. */
class Said {
  constructor(line) {
    this.bytes = [];
    this.line = line;
  }
  push(byte) {
    if (byte === null) return;
    this.bytes.push(byte);
    if (this.line && byte === 13 && this.bytes.length > 1) this.line(this.text());
  }
  text() {
    return new TextDecoder().decode(new Uint8Array(this.bytes));
  }
}

/** What the program drew over itself: the last text of each line. */
const shown = text => text.split("\n").map(line => line.replace(/\x1b\[K/g, "").split("\r").pop()).join("\n");

function folders(FS, path) {
  const parts = path.split("/").slice(0, -1);
  for (let i = 1; i <= parts.length; ++i) {
    const folder = parts.slice(0, i).join("/");
    if (folder && !FS.analyzePath(folder).exists) FS.mkdir(folder);
  }
}

function mount(program, logs, files) {
  const { FS } = program;
  const { WORKERFS } = FS.filesystems;
  FS.mkdir(FOLDER);
  FS.mkdir(NOTHING);
  FS.mount(WORKERFS, { files: [] }, NOTHING); // makes its reader
  // Its files stand among those that are written: no links, which some libraries follow with suspicion (HDF5).
  for (const { name, file } of logs) {
    folders(FS, `${FOLDER}/${name}`);
    const at = name.lastIndexOf("/"), parent = FS.lookupPath(`${FOLDER}/${name.slice(0, Math.max(at, 0))}`).node;
    WORKERFS.createNode(parent, name.slice(at + 1), WORKERFS.FILE_MODE, 0, file, file.lastModified ? new Date(file.lastModified) : new Date());
  }
  for (const { name, bytes } of files) {
    folders(FS, `${FOLDER}/${name}`);
    FS.writeFile(`${FOLDER}/${name}`, bytes);
  }
  FS.chdir(FOLDER);
}

/** Files below `folder` that were not there before, or are other ones. */
function written(FS, before, folder = FOLDER) {
  const found = [];
  for (const name of FS.readdir(folder)) {
    if (name === "." || name === "..") continue;
    const path = `${folder}/${name}`, { contents } = FS.lookupPath(path).node;
    if (FS.isDir(FS.lstat(path).mode)) found.push(...written(FS, before, path));
    else if (!(contents instanceof Blob) && before.get(path) !== contents)
      found.push({ name: path.slice(FOLDER.length + 1), bytes: FS.readFile(path) });
  }
  return found;
}

const instance = settings => createProgram({
  ...settings,
  noInitialRun: true,
  instantiateWasm(imports, take) {
    WebAssembly.instantiate(compiled, imports).then(made => take(made, compiled));
    return {};
  },
});

async function run({ id, words, logs, files, digests }) {
  const out = new Said(), err = new Said(text => postMessage({ id, progress: shown(text).split("\n").pop() }));
  const program = await instance({ digests, said: (stream, byte) => (stream === 1 ? out : err).push(byte) });
  mount(program, logs, files);
  const before = new Map(files.map(({ name }) => [`${FOLDER}/${name}`, program.FS.lookupPath(`${FOLDER}/${name}`).node.contents]));
  const code = program.callMain(words);
  return { id, code, out: out.text(), err: shown(err.text()), files: written(program.FS, before), heap: program.HEAPU8.length };
}

async function digest({ id, digested }) {
  const program = await instance({ said: () => {} });
  mount(program, [digested], []);
  return { id, files: [], digest: program.ccall("page_digest", "string", ["string"], [digested.name]) };
}

onmessage = async ({ data }) => {
  if (data.module) {
    compiled = data.module;
    return;
  }
  try {
    const result = await (data.digested ? digest(data) : run(data));
    postMessage(result, result.files.map(file => file.bytes.buffer));
  } catch (error) {
    postMessage({ id: data.id, failed: String(error && error.message || error) });
  }
};
