// The page: takes what is dropped, asks the program what it is, offers uses, runs their commands, shows what came of it.
"use strict";

let USAGE = null; // what the program can be told (--generate json)
let TARGETS = []; // of model --to
const CODE = /\berror (E\d{4})\b/;

const bench = {
  items: [], // what was dropped: {name, kind, parts, reading, units, recording, warnings, error}
  made: [], // what the program wrote: {name, blob}
  get logs() { return this.items.filter(isLog); },
  get scenes() { return this.items.filter(({ kind }) => kind === "scene"); },
  get tables() { return this.items.filter(({ kind, name }) => kind === "log" && /\.(csv|tsv|txt)$/i.test(name)); },
  get models() {
    const dropped = this.items.filter(({ kind }) => kind === "model"), written = this.made.filter(({ name }) => name.endsWith(".sensor.yaml"));
    return [...dropped, ...written];
  },
  /** What figures, exports and comparisons are made of. */
  get subjects() {
    const dropped = this.items.filter(({ kind, about }) => kind === "model" || about).map(({ name, kind, about }) => ({ name, kind, channels: [], ...about }));
    const folders = this.made.filter(({ report }) => report).map(({ name, report }) => ({ name: folderOf(name), ...report }));
    return [...folders, ...dropped];
  },
  /** What a log can be fused by. */
  get fusions() {
    return [...this.made, ...this.items].filter(({ name }) => name.endsWith("fusion.yaml"));
  },
  /** A name that no output has yet. */
  free(name) {
    const taken = new Set(this.made.flatMap(one => [one.name, one.name.split("/")[0]]));
    return freeName(name, taken);
  },
};
let pool = null, use = null, picked = false, running = 0; // picked: the use was asked for, not the first that fits

function setState(state, text) {
  document.documentElement.dataset.state = state;
  byId("cancel").hidden = state !== "working";
  if (text !== undefined) byId("status").textContent = text;
}

function showError(text, code) {
  const box = byId("error");
  box.hidden = !text;
  box.replaceChildren();
  if (!text) return;
  box.append(element("p", {}, ...unbroken(text)));
  if (code) box.append(button(`What ${code} means`, () => command([["explain", code]], { keep: true })));
}

const lastLine = text => text.trim().split("\n").filter(Boolean).pop() || "";

/** Of a run that the browser had no room for. */
const NO_ROOM = "A page has 4 GB at most, less where the browser says so: enough for a log of any length with up to 100 channels. " +
  "The command below takes as much as the machine has.";

/** What a run that failed says, as one who has only this page can use it. */
function failure(answer) {
  if (answer.failed === undefined) {
    const line = answer.err.split("\n").find(one => CODE.test(one) || one.includes("internal error")) || lastLine(answer.err);
    const said = line.replace(/^sensorchar: /, "") || `the program ended with exit code ${answer.code}`;
    return /\bE0403\b/.test(said) ? `${said}. ${NO_ROOM}` : said;
  }
  return /memory|allocation|out of bounds|OOM/i.test(answer.failed)
    ? `The browser gives the program no more memory. ${NO_ROOM}`
    : `The program ended in this browser: ${answer.failed}. On a command line, the command below may say more.`;
}

const parts = items => items.flatMap(item => item.parts);

/** Runs words over everything that is here. */
function start(words, what, made = []) {
  ++running;
  setState("working", `${what} …`);
  const logs = [...parts(bench.items), ...made.map(({ name, blob }) => ({ name, file: blob }))];
  const named = words[0] === "inspect" ? [] : bench.items.filter(({ name }) => words.includes(name));
  const progress = text => setState("working", text || `${what} …`);
  return pool.digestsOf(parts(named)).then(digests => pool.run({ words, logs, digests, progress })).finally(() => --running);
}

/** One item, looked at by the program. */
async function inspect(item) {
  const answer = await start(["inspect", item.name, ...toldWords("inspect", [item]), "--json", "--preview"], `Reading ${item.name}`);
  item.error = "";
  item.recording = null;
  if (answer.failed !== undefined || answer.code !== 0) {
    item.error = failure(answer);
    return;
  }
  const { recordings, findings } = JSON.parse(answer.out);
  [item.recording, item.warnings] = [recordings[0], findings];
}

function card(item) {
  const changed = () => look([item]);
  const remove = button("Remove", () => {
    bench.items = bench.items.filter(one => one !== item);
    draw();
  }, { "aria-label": `Remove ${item.name}` });
  const head = element("h3", {}, item.name, remove);
  if (item.error) {
    const code = CODE.exec(item.error);
    const box = element("ul", { class: "seen" }, element("li", { class: "bad" }, ...unbroken(item.error),
      code ? button(`What ${code[1]} means`, () => command([["explain", code[1]]], { keep: true })) : null));
    return element("article", {}, head, box, chosen(item, changed), item.kind === "log" ? readingOptions(item, changed) : null);
  }
  if (item.recording) return element("article", {}, head, ...inspectionView(item, changed).filter(Boolean));
  const about = { model: "sensor model", report: "report", scene: "scene", fusion: "result of a replay", beside: "read with the files next to it", log: "" }[item.kind];
  return element("article", {}, head, element("p", { class: "facts" }, about));
}

function drawUses() {
  const there = USES.filter(one => one.fits(bench));
  byId("use").hidden = there.length === 0;
  if (there.length === 0) return;
  if (!picked || !there.includes(use)) [use, picked] = [there[0], false];
  byId("uses").replaceChildren(...there.map(one => button(one.label, () => {
    [use, picked] = [one, true];
    drawUses();
  }, { "aria-pressed": String(one === use) })));
  drawOptions();
}

function drawOptions() {
  const changed = whole => whole === true ? drawOptions() : showCommand();
  const own = use.choices ? element("div", { class: "fields" }, ...use.choices(bench, use, changed)) : null;
  byId("options").replaceChildren(...[own, ...optionFields(use.verb, use, changed), element("p", {}, element("button", { class: "run", id: "run" }, use.label))].filter(Boolean));
  showCommand();
}

function showCommand() {
  byId("command").replaceChildren(...unbroken(shellCommand(use.words(bench, use))));
}

function draw() {
  byId("found").replaceChildren(...bench.items.map(card));
  drawUses();
}

/** A report or a model that was dropped alone is shown. */
function opened(item) {
  [use, picked] = [USES.find(({ id }) => id === (item.kind === "model" ? "show" : "table")), true];
  use.source = item.name;
  drawUses();
  return command([use.words(bench, use), ...(item.about ? [figureWords(bench, use.source)] : [])], { needed: 1 });
}

/** Has a second worker take the digest of a large file. Where there are several files, each has a worker, and no core is left. */
function digestBeside({ parts: [log, ...more] }) {
  const worth = 16e6; // below, a worker takes longer to start
  if (more.length === 0 && log.file.size > worth) pool.digest(log);
}

/** Looks at items again, each beside the others, and draws; a single recording of which all is known is characterized at once. */
async function look(items) {
  showError("");
  const recordings = () => bench.items.filter(({ kind }) => kind === "log");
  if (recordings().length === 1) digestBeside(recordings()[0]);
  try {
    await Promise.all(items.filter(({ kind }) => kind === "log").map(async item => {
      await inspect(item);
      draw();
    }));
  } catch (error) {
    return stopped(error);
  }
  draw();
  if (bench.logs.length === 1 && recordings().length === 1 && bench.logs[0].recording.rate_hz) {
    [use, picked] = [USES[0], false];
    drawUses();
    return run();
  }
  if (bench.logs.length === 0 && items.length === 1 && (items[0].kind === "report" || items[0].kind === "model")) return opened(items[0]);
  const failed = items.filter(item => item.error);
  if (failed.length > 0 && failed.length === items.length) setState("error", failed.length === 1 ? `${failed[0].name} could not be read.` : "None of these files could be read.");
  else if (items.some(item => item.recording && (lacksStream(item) || lacksRate(item)))) setState("done", "Read. One answer is missing, below.");
  else setState("done", bench.items.some(({ recording }) => recording) ? "Read. Choose what to do with it." : "Ready.");
}

/** Of a press on a remedy: what was told of a recording is looked at, and the use is run again. */
async function again(item, wanted) {
  await look([item]);
  if (item.error || bench.logs.length === 1) return; // it was run
  [use, picked] = [wanted, true];
  drawUses();
  return run();
}

/** What reports found and options can mend, but for what stands beside the recording already. */
function mendableLines(files, ran) {
  return files.filter(({ name }) => /(^|\/)report\.json$/.test(name)).flatMap(({ bytes }) => {
    const report = JSON.parse(new TextDecoder().decode(bytes)), item = bench.logs.find(({ name }) => report.recording && name === report.recording.file);
    const known = item ? [...item.warnings, ...item.recording.channels.flatMap(({ findings }) => findings)] : [];
    return mendable(report, known).map(({ finding, subject }) => findingLine(finding, subject, set => {
      applyRemedy(set, item ? item.reading : ran.values, item && item.units);
      return item ? again(item, ran) : run();
    }));
  });
}

function stopped(error) {
  if (error instanceof Cancelled) setState("done", "Cancelled.");
  else setState("error", String(error && error.message || error));
}

async function take(files) {
  const taken = new Set(bench.items.map(({ name }) => name)), fresh = [], results = resultFolders(files);
  for (const { name, parts: found } of asLogs(files)) {
    const free = freeName(namedSafely(name), taken);
    taken.add(free);
    let kind = found.length > 1 ? "log" : await kindOf(free, found[0].file);
    if (kind === "log" && [...results].some(folder => name.startsWith(folder))) kind = "beside";
    const about = kind === "report" ? reportAbout(await found[0].file.text()) : null;
    const renamed = found.map(part => ({ name: free + part.name.slice(name.length), file: part.file }));
    fresh.push({ name: free, kind, about, parts: renamed, reading: new Map(), units: new Map(), recording: null, error: "" });
  }
  bench.items.push(...fresh);
  draw();
  await look(fresh);
}

const run = () => command(use.jobs ? use.jobs(bench, use) : [use.words(bench, use)], { made: use.made ? bench.made : [], said: use.words(bench, use) });

/** The button of a use stands far from what comes of it. */
async function pressed() {
  await run();
  byId(byId("error").hidden ? "result" : "error").scrollIntoView({ block: "start" });
}

const worked = answer => answer.failed === undefined && ([0, 6].includes(answer.code) || (answer.code === 4 && answer.files.length > 0));

/** Runs commands, side by side, and shows all of it. `said`: the command that they are parts of. `keep`: what is shown of the last one stays.
 * `needed`: so many of them have to work. */
async function command(jobs, { made = [], keep = false, said = jobs[0], needed = jobs.length } = {}) {
  if (!keep) showError("");
  byId("command").replaceChildren(...unbroken(shellCommand(said)));
  let answers;
  try {
    answers = await Promise.all(jobs.map(words => start(words, "Working", made)));
  } catch (error) {
    return stopped(error);
  }
  const good = answers.filter(worked), bad = answers.slice(0, needed).filter(answer => !worked(answer));
  keepFiles(good.flatMap(({ files }) => files));
  if (good.length > 0) show(good);
  if (!keep) drawUses();
  byId("command").replaceChildren(...unbroken(shellCommand(said)));
  if (bad.length > 0) {
    const texts = bad.map(failure), code = CODE.exec(texts[0]);
    showError(texts.join("\n"), code && code[1]);
    return setState("error", good.length === 0 ? "That did not work." : `${bad.length} of ${jobs.length} did not work.`);
  }
  const worst = Math.max(...good.map(({ code }) => code));
  setState("done", worst === 0 ? "Done." : worst === 6 ? "Done: a check failed." : "Done, with a warning.");
}

function keepFiles(files) {
  const fresh = files.map(({ name, bytes }) => ({ name, bytes, blob: new File([bytes], name.split("/").pop()), report: name.endsWith("/report.json") ? reportAbout(new TextDecoder().decode(bytes)) : null }));
  bench.made = [...bench.made.filter(({ name }) => !fresh.some(one => one.name === name)), ...fresh];
  drawFiles();
}

const TYPES = { html: "text/html", json: "application/json", svg: "image/svg+xml", csv: "text/csv", yaml: "text/yaml", md: "text/markdown" };

function drawFiles() {
  byId("saving").hidden = bench.made.length === 0;
  for (const link of byId("files").querySelectorAll("a")) URL.revokeObjectURL(link.href);
  byId("files").replaceChildren(...bench.made.map(({ name, bytes }) => {
    const type = TYPES[name.split(".").pop()] || "application/octet-stream";
    const link = element("a", { href: URL.createObjectURL(new Blob([bytes], { type })), download: name.split("/").pop() }, name);
    return element("li", {}, link, element("span", { class: "dim" }, ` ${bytesText(bytes.length)}`));
  }));
}

/** Pages of reports, the overview first. */
const PAGE = /(^|\/)(report|index|runs|which[^/]*)\.html$/;
const pagesOf = files => files.filter(({ name }) => PAGE.test(name)).sort((a, b) => a.name.split("/").length - b.name.split("/").length);

/** Prints itself when the page asks for it: from outside, nobody may. In front of the report's own policy, which allows no other script. */
const PRINTS = "<script>addEventListener('message', event => event.data === 'print' && print());</scr" + "ipt>";

/** In a fresh frame: one that was hidden is not always drawn again. */
function showPage({ bytes }) {
  const old = byId("report"), fresh = old.cloneNode();
  fresh.srcdoc = new TextDecoder().decode(bytes).replace("<head>", head => head + PRINTS);
  old.replaceWith(fresh);
}

/** What is shown as text: what the program says, and a single short file. */
function shownText(out, files) {
  const texts = files.filter(({ name }) => !/\.(svg|npy|html)$/.test(name)), [file] = texts, short = texts.length === 1 && file.bytes.length < 2e5;
  return `${out}\n${short ? new TextDecoder().decode(file.bytes) : ""}`.trim();
}

function show(answers) {
  byId("result").hidden = false;
  const files = answers.flatMap(answer => answer.files), pages = pagesOf(files), text = shownText(answers.map(({ out }) => out).join("\n"), files);
  byId("report").hidden = byId("print").hidden = pages.length === 0;
  byId("pages").replaceChildren(...pages.length < 2 ? [] : [choice("Report", pages.map(({ name }) => [name, folderOf(name)]), pages[0].name,
    wanted => showPage(pages.find(({ name }) => name === wanted)))]);
  if (pages.length > 0) showPage(pages[0]);
  const warnings = answers.flatMap(({ err }) => err.split("\n")).filter(line => line.trim());
  byId("said").replaceChildren(...warnings.map(line => element("li", {}, line.replace(/^sensorchar: /, ""))));
  byId("mend").replaceChildren(...mendableLines(files, use));
  byId("text").hidden = pages.length > 0 || !text;
  byId("text").textContent = text;
  byId("figures").replaceChildren(...files.filter(({ name }) => name.endsWith(".svg")).map(figure));
}

/** A figure as it is saved, with a way to have it as PNG. */
function figure({ name, bytes }) {
  const picture = element("img", { src: URL.createObjectURL(new Blob([bytes], { type: "image/svg+xml" })), alt: `Figure ${name}` });
  const png = button("Add it as PNG", () => {
    const scale = 3, canvas = element("canvas", { width: picture.naturalWidth * scale, height: picture.naturalHeight * scale });
    const context = canvas.getContext("2d");
    context.fillStyle = "#fff";
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.drawImage(picture, 0, 0, canvas.width, canvas.height);
    canvas.toBlob(async blob => keepFiles([{ name: name.replace(/svg$/, "png"), bytes: new Uint8Array(await blob.arrayBuffer()) }]), "image/png");
  });
  return element("figure", { class: "plot" }, picture, element("figcaption", {}, name, " ", png));
}

function save(blob, name) {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

function listen() {
  // What nobody thought of ends in a sentence too.
  addEventListener("unhandledrejection", ({ reason }) => stopped(reason));
  addEventListener("error", ({ error, message }) => stopped(error || message));
  byId("logs").addEventListener("change", event => {
    const files = [...event.target.files].map(file => ({ name: file.webkitRelativePath || file.name, file }));
    event.target.value = "";
    if (files.length > 0) take(files);
  });
  for (const kind of ["dragenter", "dragover"]) addEventListener(kind, event => {
    event.preventDefault();
    document.documentElement.classList.add("dragging");
  });
  addEventListener("dragleave", event => {
    if (event.relatedTarget === null) document.documentElement.classList.remove("dragging");
  });
  addEventListener("drop", async event => {
    event.preventDefault();
    document.documentElement.classList.remove("dragging");
    const files = await droppedFiles(event.dataTransfer);
    if (files.length > 0) await take(files);
  });
  byId("options").addEventListener("submit", event => {
    event.preventDefault();
    if (running === 0) pressed();
  });
  byId("cancel").addEventListener("click", () => pool.cancel());
  byId("copy").addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(byId("command").textContent);
      byId("status").textContent = "Copied.";
    } catch {
      getSelection().selectAllChildren(byId("command")); // a page from disk may not: selected, for Ctrl-C
    }
  });
  byId("zip").addEventListener("click", () => save(zipped(bench.made), "sensorchar.zip"));
  byId("print").addEventListener("click", () => byId("report").contentWindow.postMessage("print", "*"));
}

/** The bytes of a text of 7 bits a character (tools/page/build/pack.py: seven_bits). */
function fromSevenBits(text) {
  const replaced = [0x00, 0x0d, 0x3c], bytes = new Uint8Array(Math.floor(text.length * 7 / 8));
  let value = 0, held = 0, at = 0;
  for (let i = 0; i < text.length; ++i) {
    const code = text.charCodeAt(i);
    value = value << 7 | (code < 0x80 ? code : replaced[code - 0x80]);
    held += 7;
    if (held < 8) continue;
    held -= 8;
    bytes[at++] = value >> held;
    value &= (1 << held) - 1;
  }
  return bytes;
}

/** What an element of the page has packed inside. */
function unpacked(id, type) {
  const bytes = fromSevenBits(byId(id).textContent);
  byId(id).remove();
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip")), { headers: { "Content-Type": type } });
}

/** The program, compiled while it is unpacked. */
async function makePool() {
  const [texts, module] = await Promise.all([unpacked("texts", "application/json").json(), WebAssembly.compileStreaming(unpacked("module", "application/wasm"))]);
  USAGE = texts.usage;
  TARGETS = texts.targets.targets;
  return new Pool(texts.worker, module);
}

/** A short recording and what a drop does with it. */
function rehearsal() {
  let x = 1; // white noise
  const rows = Array.from({ length: 4000 }, (_, i) => `${i / 100},${((x = (Math.imul(1664525, x) + 1013904223) >>> 0) / 2 ** 32).toFixed(4)}`);
  const bytes = new TextEncoder().encode(`t,x [deg/s]\n${rows.join("\n")}\n`);
  return { words: ["characterize", "rehearsal.csv", "-o", "rehearsal"], files: [{ name: "rehearsal.csv", bytes }] };
}

async function begin() {
  listen();
  try {
    pool = await makePool();
  } catch (error) {
    showError(`This browser cannot run the program: ${error.message}. It needs Chromium or Edge 95, Firefox 113, Safari 16.4 or a newer one.`);
    return setState("error", "");
  }
  byId("version").textContent = USAGE.program_version.replace(/^sensorchar /, "");
  setState("ready", "Ready.");
  pool.warm(rehearsal());
}

begin();
