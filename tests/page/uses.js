// The uses of the page, each as a person drives it: files in, buttons pressed, what comes of it looked at.
"use strict";
const crypto = require("crypto"), fs = require("fs"), path = require("path");
const { ROOT, LIMIT_MS, check, opened, state, dropped } = require("./support.js");
const { bagOf } = require("./bag.js");

/** Normal numbers, the same ones every time (Numerical Recipes' 32-bit generator, Box-Muller). */
function normal(seed) {
  let x = seed >>> 0;
  const uniform = () => (x = (Math.imul(1664525, x) + 1013904223) >>> 0, (x + 0.5) / 4294967296);
  return () => Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform());
}

function written(folder, name, heads, rows) {
  const file = path.join(folder, name);
  fs.writeFileSync(file, `${heads.join(",")}\n${rows.map(row => row.join(",")).join("\n")}\n`);
  return file;
}

/** A device at rest, as noisy as said. */
function device(folder, name, sd, seed) {
  const draw = normal(seed);
  return written(folder, name, ["t", "gyro_x [deg/s]"], Array.from({ length: 20000 }, (_, i) => [i / 100, (sd * draw()).toFixed(6)]));
}

/** Four sensors of one turning thing, and the truth. */
function array(folder) {
  const draw = normal(7), noise = [0.1, 0.1, 0.2, 0.4];
  return written(folder, "array.csv", ["t", "a [deg/s]", "b [deg/s]", "c [deg/s]", "d [deg/s]", "truth [deg/s]"], Array.from({ length: 8000 }, (_, i) => {
    const truth = 5 * Math.sin(i / 300);
    return [i / 100, ...noise.map(sd => (truth + sd * draw()).toFixed(5)), truth.toFixed(5)];
  }));
}

/** A curve as one reads it off a data sheet: white noise of 0.01, flicker of 0.002. */
function curve(folder) {
  const taus = Array.from({ length: 25 }, (_, i) => 0.1 * 10 ** (i / 6));
  return written(folder, "sheet.csv", ["tau", "adev"], taus.map(tau => [tau.toPrecision(6), Math.hypot(0.01 / Math.sqrt(tau), 0.002).toPrecision(6)]));
}

/** One page, and what a person does with it. */
class Session {
  constructor(browser, page, folder) {
    Object.assign(this, { browser, page, folder });
  }
  async open() {
    Object.assign(this, await opened(this.browser, this.page));
    return this;
  }
  async drop(...files) {
    const answer = await dropped(this.tab, files);
    return answer.end;
  }
  async ended(what, wanted = "done") {
    await this.tab.waitForFunction(() => document.documentElement.dataset.state !== "working", null, { timeout: LIMIT_MS });
    const end = await state(this.tab, ["done", "error", "ready"]);
    const error = await this.tab.locator("#error").innerText().catch(() => "");
    check(end === wanted, `${what}: ${end}: ${error}`);
    console.log(`${what}: ${end}; ${await this.command()}`);
  }
  command() { return this.tab.locator("#command").innerText(); }
  text() { return this.tab.locator("#text").innerText(); }
  /** Brings a part into sight: a click right after scrolling would go to the report's frame, which was there a moment before. */
  async to(part) {
    await part.evaluate(element => element.scrollIntoView());
    await this.tab.waitForTimeout(200);
  }
  toUses() { return this.to(this.tab.locator("#use")); }
  /** Chooses a use and runs it. */
  async run(use, fill = async () => {}) {
    await this.toUses();
    await this.tab.getByRole("button", { name: use, exact: true }).first().click();
    await fill(this.tab);
    await this.tab.locator("#run").click();
    await this.ended(use);
  }
  files() { return this.tab.locator("#files a[download]").allInnerTexts(); }
  async has(...ends) {
    const files = await this.files();
    for (const end of ends) check(files.some(name => name.endsWith(end)), `no file ${end} among ${files}`);
  }
  /** Words of the report in the frame. */
  async report(...words) {
    const frame = this.tab.frameLocator("#report");
    await frame.locator("body").waitFor({ timeout: LIMIT_MS });
    const text = await frame.locator("body").innerText();
    for (const word of words) check(text.includes(word), `the report does not say ${word}`);
  }
  /** The file that a press saves; Firefox tells nobody of its downloads: there, what would be saved. */
  async saved(press, name) {
    const file = path.join(this.folder, name);
    if (this.browser.browserType().name() === "firefox") {
      await press();
      const bytes = await this.tab.evaluate(async end => Array.from(end.endsWith(".zip")
        ? new Uint8Array(await zipped(bench.made).arrayBuffer()) : bench.made.find(one => one.name.endsWith(end)).bytes), name);
      fs.writeFileSync(file, Buffer.from(bytes));
      return file;
    }
    const [download] = await Promise.all([this.tab.waitForEvent("download"), press()]);
    await download.saveAs(file);
    return file;
  }
  async close(what) {
    check(this.requests.length === 0 && this.said.length === 0, `${what}: requests ${this.requests}, console ${this.said}`);
    await this.context.close();
  }
}

async function oneLog(one) {
  check(await one.drop(path.join(ROOT, "fixtures/imu_at_rest.csv")) === "done", "the log at rest is characterized");
  check((await one.command()).startsWith("sensorchar characterize imu_at_rest.csv"), "the command is shown");
  await one.has("report.html", "report.json", "curves.csv", "gyro_z.sensor.yaml");
  await one.report("gyro_z");
  await one.run("Export for Kalibr, ROS …", tab => tab.getByLabel("Axes", { exact: true }).selectOption("z"));
  check((await one.text()).includes("gyroscope_noise_density"), "Kalibr's file is shown");
  const top = await one.tab.locator("#result").evaluate(result => result.getBoundingClientRect().top);
  check(top >= -1 && top < 1000, `what came of it is in sight: ${top}`);
  await one.run("Figure");
  check((await one.tab.locator("#figures img").count()) === 1, "a figure is shown");
  await one.tab.getByRole("button", { name: "Add it as PNG" }).click();
  await one.tab.locator("#files a", { hasText: ".png" }).waitFor();
  await one.run("Table of a report", tab => tab.getByLabel("As", { exact: true }).selectOption("tex"));
  check((await one.text()).includes("tabular"), "a table of LaTeX is shown");
  await one.run("Simulate");
  await one.run("Convert", tab => tab.getByLabel("To", { exact: true }).selectOption("npy"));
  await one.has(".svg", ".png", ".tex", "-simulated.csv", "-converted.npy", "imu.yaml");
  const zip = await one.saved(() => one.tab.locator("#zip").click(), "all.zip");
  check(fs.readFileSync(zip).subarray(0, 4).toString("latin1") === "PK\x03\x04" && fs.statSync(zip).size > 1e5, "an archive of all files");
  for (const name of ["report.json", "gyro_z.sensor.yaml"])
    await one.saved(() => one.tab.locator("#files a", { hasText: name }).first().click(), name);
}

/** From a bag to Kalibr's file: three presses. */
async function bagToKalibr(one) {
  const draw = normal(3), file = path.join(one.folder, "imu.bag");
  const three = sd => [0, 0, 0].map(() => sd * draw());
  fs.writeFileSync(file, bagOf(Array.from({ length: 6000 }, () => [three(1e-3), three(2e-2)])));
  check(await one.drop(file) === "done", "a bag is characterized");
  await one.run("Export for Kalibr, ROS …");
  await one.has("imu.yaml");
  check(/rostopic: \/imu\n[^]*gyroscope_noise_density: 0\.0001/.test(await one.text()), `Kalibr's file: ${await one.text()}`);
}

async function printed(one) {
  await one.drop(path.join(ROOT, "fixtures/imu_at_rest.csv"));
  await one.report("gyro_z");
  const frame = one.tab.frames()[1];
  await frame.evaluate(() => {
    window.print = () => {
      window.prints = (window.prints || 0) + 1;
    };
  });
  await one.tab.locator("#print").click();
  await frame.waitForFunction(() => window.prints === 1, null, { timeout: 5000 });
}

async function severalLogs(one) {
  const files = [["left.csv", 0.1], ["middle.csv", 0.05], ["right.csv", 0.2]].map(([name, sd], i) => device(one.folder, name, sd, i + 1));
  check(await one.drop(...files) === "done", "three logs are read");
  check((await one.command()).startsWith("sensorchar characterize"), "what most people want stands in front");
  await one.run("Characterize");
  await one.has("left/report.html", "middle/report.html", "right/report.html");
  await one.tab.getByLabel("Report", { exact: true }).selectOption({ label: "reports/right" });
  await one.report("right.csv");
  await one.run("Which one?");
  check((await one.command()).startsWith("sensorchar compare left.csv middle.csv right.csv"), "all that was dropped is compared");
  await one.report("Lowest N: middle", "sensorchar compare left.csv middle.csv right.csv");
  await one.run("Which one?", async tab => {
    for (const name of ["middle.csv", "right.csv"]) await tab.getByRole("checkbox", { name, exact: true }).uncheck();
    await tab.getByRole("checkbox", { name: "reports/right", exact: true }).check();
  });
  check((await one.command()).startsWith("sensorchar compare left.csv reports/right"), "a recording is compared with a report");
  await one.report("Lowest N: left");
  await one.run("A lot of one kind");
  await one.report("middle");
}

/** A recording, a report, a model and a curve in one comparison. */
async function anythingCompared(one) {
  const files = [path.join(ROOT, "fixtures/imu_at_rest.csv"), path.join(one.folder, "report.json"), path.join(one.folder, "gyro_z.sensor.yaml"), curve(one.folder)];
  check(await one.drop(...files) === "done", "a recording, a report, a model and a curve are read");
  await one.run("Which one?");
  await one.report("imu_at_rest", "report", "gyro_z", "sheet");
}

/** What a file does not say of itself can be said where it was refused. */
async function toldHow(one) {
  check(await one.drop(path.join(ROOT, "fixtures/arrays/float.imu")) === "error", "a log without a header is refused");
  await one.tab.getByText("Say how it is read").click();
  await one.tab.getByLabel("--preset", { exact: true }).fill("NAVCHIP_FLT");
  await one.tab.getByRole("button", { name: "Read it again" }).click();
  await one.ended("told how");
  check((await one.command()).includes("--preset NAVCHIP_FLT"), "how it is read is in the command");
}

/** What a log does not say is asked: its rate, or the column of its times; and which columns are meant. */
async function asked(one) {
  const draw = normal(4), value = () => draw().toFixed(4);
  let moment = 5; // a clock that pauses, among the channels
  const file = written(one.folder, "counted.csv", ["left [V]", "moment", "right [V]"], Array.from({ length: 3000 }, () =>
    [value(), (moment += draw() > 0.7 ? 0.02 : 0.01).toFixed(2), value()]));
  const plain = written(one.folder, "plain.csv", ["left [V]", "right [V]"], Array.from({ length: 3000 }, () => [value(), value()]));
  await one.drop(plain);
  check((await one.tab.locator("#status").innerText()) === "Read. One answer is missing, below.", "the page says that it asks");
  await one.tab.getByLabel("Sampling rate", { exact: true }).fill("100 Hz");
  await one.tab.getByRole("button", { name: "Go on", exact: true }).click();
  await one.ended("a rate is told");
  check((await one.command()).includes("--rate '100 Hz'"), "the rate is in the command");
  await one.tab.getByText("Say how it is read").click();
  await one.tab.locator("#found").getByLabel("--channel", { exact: true }).fill("right");
  await one.tab.getByRole("button", { name: "Read it again" }).click();
  await one.ended("a column is chosen");
  check((await one.command()).includes("--channel right") && (await one.tab.locator("#found tbody tr").count()) === 1, "one channel is left");
  await one.tab.getByRole("button", { name: "Remove plain.csv" }).click();
  await one.tab.setInputFiles("#logs", [file]);
  await one.tab.locator("#found h3", { hasText: "counted.csv" }).waitFor();
  await one.ended("a log of odd times");
  const column = one.tab.getByLabel("or the column of its times", { exact: true });
  await column.selectOption("moment");
  await one.tab.getByRole("button", { name: "Go on", exact: true }).click();
  await one.ended("a column is told");
  check((await one.command()).includes("--time-column moment"), "the column is in the command");
}

async function anArray(one) {
  check(await one.drop(array(one.folder)) === "done", "an array is read");
  const use = "An array: best fusion";
  await one.run(use, tab => tab.getByRole("checkbox", { name: "truth", exact: true }).uncheck());
  await one.has("fusion.yaml", "report.html", "report.json");
  await one.run(use, tab => tab.getByLabel("Reference, if one channel is the truth").selectOption("truth"));
  check((await one.command()).includes("--reference truth"), "the reference is in the command");
  await one.report("array.csv");
  await one.run("Fuse by a replay");
  await one.has("-fused.csv");
}

/** A file and channels with names that a command line takes for something else. */
async function hardNames(one) {
  const draw = normal(11), rows = Array.from({ length: 3000 }, (_, i) => [i / 100, ...[0, 0, 0].map(() => (0.1 * draw()).toFixed(5))]);
  check(await one.drop(written(one.folder, "--help", ["t", '"a, left"', "-b", '"c=2!"'], rows)) === "done", "a file --help is read");
  await one.tab.getByLabel("Unit of -b").fill("deg/s");
  await one.tab.getByLabel("Unit of -b").press("Tab");
  await one.ended("a unit is told");
  check((await one.tab.locator("#found td", { hasText: "deg/s" }).count()) === 1, "the unit of a channel -b is taken");
  await one.run("An array: best fusion", tab => tab.getByRole("checkbox", { name: "-b", exact: true }).check());
  check((await one.command()).includes("--sensors 'a? left,c?2?,-b'"), "names in a list");
  await one.has("help-replay/fusion.yaml");
}

/** Marks of missing values in a channel whose name has a comma, a bump in another one. */
function troubled(folder) {
  const draw = normal(5);
  return written(folder, "troubled.csv", ["t", '"a, left [deg/s]"', "b [deg/s]"], Array.from({ length: 20000 }, (_, i) =>
    [i / 100, i % 131 === 0 ? -999 : (0.1 * draw()).toFixed(5), (0.1 * draw() + (i > 5000 && i < 8000 ? 1.5 + draw() : 0)).toFixed(5)]));
}

/** What was found is mended by a press, where the log was read and where the report found it, and taken back. */
async function mended(one) {
  await one.drop(troubled(one.folder));
  await one.tab.locator("#found").getByRole("button", { name: "Say that it means missing", exact: true }).click();
  await one.ended("a mark is told");
  check((await one.command()).includes("--missing=-999"), "the mark is in the command");
  check((await one.tab.locator("#found td[data-label=missing]").allInnerTexts()).join() === "153,0", "what is marked is missing");
  check((await one.tab.locator("#mend").innerText()).startsWith("b: "), "what only the report found is told of its channel");
  await one.tab.locator("#mend").getByRole("button", { name: "Use the longest still stretch", exact: true }).click();
  await one.ended("a still stretch is asked for");
  check(/--missing=-999 .*--still auto|--still auto .*--missing=-999/.test(await one.command()), "both are in the command");
  check((await one.tab.locator("#found .bad").count()) === 0, "inspect is not told what it does not know");
  const takeBack = one.tab.getByRole("button", { name: "Take back --missing=-999" });
  await one.to(takeBack);
  await takeBack.click();
  await one.ended("the mark is taken back");
  check(!(await one.command()).includes("missing"), "it is not in the command any more");
  const words = await one.tab.evaluate(() => [listed("a, b", ["a, b", "ab"]), listed("a, b", ["x", "a, b", "a_ b"]), together("-999", "-99,-999"),
    together("x=2,y=3", "y=4"), ...settingsOf({ options: [{ option: "channel_scale", value: "a, b=c=2" }] }).map(({ value }) => value)]);
  check(words.join("|") === "a? b|c1|-99,-999|x=2,y=4|a? b?c=2", `lists: ${words.join("|")}`);
}

/** Values of any size have traces inside of their box, and documents that are none end in a sentence. */
async function extremes(one) {
  const draw = normal(2), file = written(one.folder, "extremes.csv", ["t", "huge", "whole", "tiny", "constant", "unknown", "step"], Array.from({ length: 3000 }, (_, i) =>
    [i / 100, draw() * 1e300, i % 2 ? 1.7e308 : -1.7e308, Math.round(9 * draw()) * 5e-324, 7, "nan", i < 1500 ? 0 : 1e-300]));
  await one.drop(file);
  const paths = await one.tab.locator("svg.trace path").evaluateAll(all => all.map(path => path.getAttribute("d")));
  check(paths.length > 4, `${paths.length} traces`);
  for (const text of paths) {
    const heights = [...text.matchAll(/(?: |V)(-?[0-9.]+)/g)].map(([, y]) => Number(y));
    check(!/NaN|Infinity/.test(text) && heights.every(y => y >= 0 && y <= 24), `a trace leaves its box: ${text.slice(0, 80)}`);
  }
  const documents = ["null", "5", "[]", '{"format": "characterization", "recording": {"channels": 5}}', '{"format": "characterization", "recording": {"channels": [null, {"name": 3}]}}',
    '{"format": "sensor-model"}', '{"format": "replay", "findings": 1}', '{"format":', "\ufeff{}"];
  for (const [i, text] of documents.entries()) {
    const name = path.join(one.folder, `document${i}.json`);
    fs.writeFileSync(name, text);
    const { tab, context, said } = await opened(one.browser, one.page);
    await tab.setInputFiles("#logs", [name]);
    await tab.waitForFunction(() => ["done", "error"].includes(document.documentElement.dataset.state), null, { timeout: LIMIT_MS });
    const error = await tab.locator("#error").innerText();
    check(said.length === 0, `${text}: ${said}`);
    check((await state(tab, ["done", "error"])) === "done" || /E\d{4}/.test(error), `${text}: no sentence: ${error}`);
    await context.close();
  }
}

async function aModel(one) {
  check(await one.drop(path.join(one.folder, "gyro_z.sensor.yaml")) === "done", "a model opens");
  check((await one.text()).includes("gyro_z"), "a model is shown");
  await one.run("Simulate", tab => tab.getByLabel("Devices", { exact: true }).fill("3"));
  await one.has("-simulated.csv");
}

async function aReport(one) {
  check(await one.drop(path.join(one.folder, "report.json")) === "done", "a report opens");
  check(/gyro\\?_z/.test(await one.text()), "its table is shown");
  check((await one.tab.locator("#figures img").count()) === 1, "its figure is shown");
}

async function aCurve(one) {
  await one.drop(curve(one.folder));
  await one.run("Curve of a data sheet", tab => tab.getByLabel("Length of its recording").fill("1h"));
  check(/0\.0?10|1\.0\d?e-2/.test(await one.text()), "the coefficients are shown");
  await one.has(".sensor.yaml");
}

async function cancelled(one) {
  const log = device(one.folder, "long.csv", 0.1, 9), rows = fs.readFileSync(log, "utf8").split("\n");
  const more = Array.from({ length: 1500000 }, (_, i) => `${(i + 20000) / 100},${rows[1 + i % 20000].split(",")[1]}`);
  fs.appendFileSync(log, `${more.join("\n")}\n`);
  await one.tab.setInputFiles("#logs", [log]);
  await one.tab.locator("#cancel").click({ timeout: LIMIT_MS });
  await one.ended("cancel");
  check((await one.tab.locator("#status").innerText()) === "Cancelled.", "the page says that it was cancelled");
  check(await one.drop(path.join(ROOT, "fixtures/packed/table.csv.gz")) === "done", "it goes on after that");
}

/** The digest of a large file, which a second worker takes, is the one that the report states. */
async function digested(one) {
  const log = device(one.folder, "large.csv", 0.1, 12), rows = fs.readFileSync(log, "utf8").trim().split("\n");
  const more = Array.from({ length: 1000000 }, (_, i) => `${(i + 20000) / 100},${rows[1 + i % 20000].split(",")[1]}`);
  fs.appendFileSync(log, `${more.join("\n")}\n`);
  check(await one.drop(log) === "done", "a large log is characterized");
  const file = await one.saved(() => one.tab.locator("#files a", { hasText: "report.json" }).first().click(), "report.json");
  const wanted = crypto.createHash("sha256").update(fs.readFileSync(log)).digest("hex");
  check(fs.readFileSync(file, "utf8").includes(wanted), "the digest of the log is in the report");
  const taken = await one.tab.evaluate(async () => Promise.all(pool.digests.values()));
  check(taken.map(({ digest }) => digest).join() === wanted, `a second worker took the digest: ${JSON.stringify(taken)}`);
}

/** Nothing but keys: the file's channel is looked at, a use is chosen and run. */
async function byKeys(one) {
  await one.drop(path.join(ROOT, "fixtures/imu_at_rest.csv"));
  const reached = new Set();
  for (let i = 0; i < 60 && !reached.has("Simulate"); ++i) {
    await one.tab.keyboard.press("Tab");
    reached.add(await one.tab.evaluate(() => document.activeElement.id || document.activeElement.textContent));
  }
  for (const name of ["logs", "Characterize", "Simulate"]) check(reached.has(name), `Tab reaches ${name}`);
  await one.tab.keyboard.press("Enter");
  await one.tab.locator("#run").focus();
  await one.tab.keyboard.press("Enter");
  await one.ended("by keys");
}

const SCENES = { oneLog, bagToKalibr, printed, severalLogs, anythingCompared, toldHow, asked, anArray, hardNames, mended, extremes, aModel, aReport, aCurve, cancelled, digested, byKeys };

async function uses(browser, page, folder, only) {
  for (const [name, scene] of Object.entries(SCENES)) if (!only || only === name) {
    const one = await new Session(browser, page, folder).open();
    try {
      await scene(one);
    } catch (error) {
      check(false, `${name}: ${String(error).split("\n").slice(0, 3).join(" ")}`);
    }
    await one.close(name);
  }
}

module.exports = { uses };
