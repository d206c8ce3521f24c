// The program as it was built for the page, under node: node --no-experimental-fetch run.js BUILD WORD…
// Files are those of this machine, as the program's own folder /here (NODEFS): paths relative to where node was started.
// HEAP=1 prints the heap, CPU=1 the processor time of the command's thread, which its compilers are not; DIGEST=NAME: that of a log is known.
"use strict";
const fs = require("fs"), path = require("path");
const build = path.resolve(process.argv[2]);
const createProgram = require(path.join(build, "tools/sensorchar.js"));
const streams = { 1: [], 2: [] };

const cpu = () => Number(fs.readFileSync(`/proc/self/task/${process.pid}/schedstat`, "utf8").split(" ")[0]) / 1e9;
const begin = process.env.CPU && cpu();

createProgram({
  digests: process.env.DIGEST ? { [process.env.DIGEST]: "0".repeat(64) } : {},
  noInitialRun: true,
  said: (stream, byte) => {
    if (byte !== null) streams[stream].push(byte);
  },
  wasmBinary: fs.readFileSync(path.join(build, "tools/sensorchar.wasm")),
}).then(program => {
  const { FS } = program;
  FS.mkdir("/here");
  FS.mount(FS.filesystems.NODEFS, { root: process.cwd() }, "/here");
  FS.chdir("/here");
  const code = program.callMain(process.argv.slice(3));
  fs.writeSync(1, Buffer.from(streams[1]));
  fs.writeSync(2, Buffer.from(streams[2]).toString().split("\n").map(line => line.replace(/\x1b\[K/g, "").split("\r").pop()).join("\n"));
  if (process.env.HEAP) fs.writeSync(2, `heap ${program.HEAPU8.length}\n`);
  if (process.env.CPU) fs.writeSync(2, `cpu ${cpu() - begin}\n`);
  process.exit(code);
});
