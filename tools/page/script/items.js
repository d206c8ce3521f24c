// What was dropped, and what the program made of it: recordings, models, reports, scenes, curves.
"use strict";

const KINDS = [
  { kind: "model", ends: [".sensor.yaml", ".sensor.yml"] },
  { kind: "scene", ends: [".scene.yaml", ".scene.yml"] },
  { kind: "fusion", ends: ["fusion.yaml"] },
  { kind: "beside", ends: [".yaml", ".yml", ".sha256"] }, // read with what they stand beside
];
/** The kind of a file, by its name, or by what a JSON document says of itself. */
async function kindOf(name, file) {
  const lower = name.toLowerCase();
  const known = KINDS.find(({ ends }) => ends.some(end => lower.endsWith(end)));
  if (known) return known.kind;
  if (!lower.endsWith(".json")) return "log";
  const head = await file.slice(0, 400).text();
  const format = /"format"\s*:\s*"([a-z-]+)"/.exec(head);
  if (format && format[1] === "sensor-model") return "model";
  return format ? "report" : "beside";
}

/** Of a report.json: a characterization and its channels, or a replay. */
function reportAbout(text) {
  try {
    const { format, recording } = JSON.parse(text);
    const channels = [recording && recording.channels].flat().filter(channel => channel && typeof channel.name === "string");
    return { kind: format === "replay" ? "replay" : "report", channels };
  } catch {
    return null; // the program says what is wrong with it
  }
}

/** Folders of results: what stands in one beside its report.json is no log. */
const resultFolders = files => new Set(files.map(({ name }) => /^(.*\/)report\.json$/.exec(name)).filter(Boolean).map(([, folder]) => folder));

/** Files of a drop, those inside of folders too: [{name, file}]. */
async function droppedFiles(transfer) {
  const entries = [...transfer.items].map(item => item.webkitGetAsEntry && item.webkitGetAsEntry()).filter(Boolean);
  if (entries.length === 0) return [...transfer.files].map(file => ({ name: file.name, file }));
  const found = [];
  for (const entry of entries) await walk(entry, "", found);
  return found;
}

async function walk(entry, above, found) {
  const name = above + entry.name;
  if (entry.isFile) {
    found.push({ name, file: await new Promise((resolve, reject) => entry.file(resolve, reject)) });
    return;
  }
  const reader = entry.createReader();
  for (;;) {
    const some = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0) return;
    for (const inside of some) await walk(inside, `${name}/`, found);
  }
}

/** A name that no command takes for an option. */
const namedSafely = name => name.startsWith("-") ? `./${name}` : name;

/** A name that no other has: "imu (2).csv". */
function freeName(name, taken) {
  if (!taken.has(name)) return name;
  const dot = name.indexOf(".", name.lastIndexOf("/") + 2), [front, end] = dot < 0 ? [name, ""] : [name.slice(0, dot), name.slice(dot)];
  for (let n = 2;; ++n) if (!taken.has(`${front} (${n})${end}`)) return `${front} (${n})${end}`;
}

/** A folder of rosbag2 is one log: of files below one that has a metadata.yaml, the folder. */
function asLogs(files) {
  const bags = files.filter(({ name }) => name.endsWith("/metadata.yaml")).map(({ name }) => name.slice(0, -"/metadata.yaml".length));
  const logs = bags.map(bag => ({ name: bag, parts: files.filter(({ name }) => name.startsWith(`${bag}/`)) }));
  for (const one of files) if (!bags.some(bag => one.name.startsWith(`${bag}/`))) logs.push({ name: one.name, parts: [one] });
  return logs;
}
