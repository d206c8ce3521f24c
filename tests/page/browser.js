// The page in a browser: files are dropped on it, every request is recorded, and what comes of it is looked at.
//
// usage: node browser.js PAGE [--browser chromium|firefox] [--only STEP [--use SCENE]] [--screens FOLDER] [--native PROGRAM] [FILE…]
// NODE_PATH has playwright-core and axe-core. FILE: logs (default: the fixtures); what stands beside one goes with it. Prints a row per file:
// state, seconds to the first number and to the end, the largest heap of the program; with PROGRAM its seconds for the same by one thread.
// Exit code 1 where something is wrong.
"use strict";
const { spawnSync } = require("child_process");
const fs = require("fs"), os = require("os"), path = require("path");
const { ROOT, faults, check, fixtures, recorderWorks, opened, dropped, launched } = require("./support.js");
const { uses } = require("./uses.js");

/** Seconds of the native program for what the page does with a file: inspect, and characterize where it did. */
function nativeSeconds(program, file, characterized, folder) {
  const verbs = [["inspect", file, "--json", "--threads", "1"], ["characterize", file, "--threads", "1", "-q", "--force", "-o", path.join(folder, "native")]];
  const begin = process.hrtime.bigint();
  for (const words of verbs.slice(0, characterized ? 2 : 1)) spawnSync(program, words);
  return Number(process.hrtime.bigint() - begin) / 1e9;
}

/** The largest heap that the program has had in any worker from now on, in window.heap. */
const watchHeap = tab => tab.evaluate(() => {
  const run = pool.run.bind(pool);
  pool.run = async job => {
    const answer = await run(job);
    window.heap = Math.max(window.heap || 0, answer.heap || 0);
    return answer;
  };
});

async function everyFile(browser, page, files, program, folder) {
  const heads = ["file", "MB", "state", "first s", "all s", "heap MB", ...program ? ["native s"] : []];
  console.log(heads.join("\t"));
  const sums = { first: 0, all: 0, native: 0 };
  for (const file of files) {
    const { tab, context, requests, said } = await opened(browser, page);
    try {
      await watchHeap(tab);
      const beside = [file.replace(/\.[^.]*$/, ".yaml"), `${file}.yaml`, `${file}.json`].filter(name => name !== file && fs.existsSync(name));
      const { end, first, all } = await dropped(tab, [file, ...beside]);
      const links = await tab.locator("#files a[download]").count(), frame = await tab.locator("#report:not([hidden])").count();
      const text = end === "error" ? (await tab.locator("#error, #found .bad").allInnerTexts()).join(" ").trim() : "";
      const heap = await tab.evaluate(() => window.heap || 0), native = program ? nativeSeconds(program, file, links > 0, folder) : 0;
      Object.entries({ first, all, native: native * 1e3 }).forEach(([name, ms]) => sums[name] += ms / 1e3);
      console.log([path.basename(file), (fs.statSync(file).size / 1e6).toFixed(2), end, (first / 1e3).toFixed(2), (all / 1e3).toFixed(2), (heap / 1e6).toFixed(0),
        ...program ? [native.toFixed(2)] : [], text.split("\n")[0].slice(0, 110)].join("\t"));
      check(end === "done" || /E\d{4}/.test(text), `${file}: an error without a code: ${text}`);
      check(frame === 0 || links >= 3, `${file}: a report without files`);
    } catch (error) {
      check(false, `${file}: ${String(error).split("\n")[0]}`);
    }
    check(requests.length === 0, `${file}: requests ${requests}`);
    check(said.length === 0, `${file}: the console says ${said.slice(0, 3)}`);
    await context.close();
  }
  console.log(`${files.length} files: ${sums.first.toFixed(1)} s to the first numbers, ${sums.all.toFixed(1)} s in all${program ? `, ${sums.native.toFixed(1)} s native` : ""}`);
}

/** Names and cells of a log that would be markup, if anybody took them for it. */
async function injections(browser, page, folder) {
  const payload = "<img src=x onerror=\"window.pwned=1\"><script>window.pwned=1</script>\"'>{{7*7}}`${1}`";
  const csv = path.join(folder, "<b>bold<img src=x onerror=window.pwned=1>.csv".replaceAll("/", ""));
  const rows = Array.from({ length: 2000 }, (_, i) => `${i / 100},${Math.sin(i * i) + (i % 131 === 0 ? -999 : 0)}`);
  fs.writeFileSync(csv, `t,"${payload.replaceAll('"', '""')} [<i>U</i>]"\n${rows.join("\n")}\n`);
  const broken = path.join(folder, "broken<script>.json");
  fs.writeFileSync(broken, `{"format": "characterization", "verdict": "${"<img src=x onerror=window.pwned=1>".replaceAll('"', "")}"}`);
  const { tab, context, requests, said } = await opened(browser, page);
  await dropped(tab, [csv]);
  check((await tab.locator("#found b, #found img, #found i, #command img, #status b").count()) === 0, "markup of a log became elements");
  check((await tab.evaluate(() => window.pwned)) === undefined, "a script of a log ran");
  for (const frame of tab.frames().slice(1)) check((await frame.evaluate(() => window.pwned)) === undefined, "a script of a log ran in the report");
  await dropped(tab, [broken]);
  check((await tab.evaluate(() => window.pwned)) === undefined, "a script of a document ran");
  check(requests.length === 0, `requests of hostile files: ${requests}`);
  check(!said.some(text => text.startsWith("dialog")), `dialogs: ${said}`);
  await context.close();
}

async function accessible(browser, page) {
  let axe;
  try {
    axe = fs.readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");
  } catch {
    console.log("axe-core is not there: its rules were not asked");
    return;
  }
  for (const colorScheme of ["light", "dark"]) {
    const { tab, context } = await opened(browser, page, { colorScheme });
    await dropped(tab, [path.join(ROOT, "fixtures/imu_at_rest.csv")]);
    await tab.evaluate(axe);
    const found = await tab.evaluate(() => window.axe.run(document, { iframes: false }));
    for (const one of found.violations) check(false, `axe, ${colorScheme}: ${one.id}: ${one.nodes.slice(0, 3).map(node => node.html.slice(0, 120)).join(" | ")}`);
    console.log(`axe, ${colorScheme}: ${found.passes.length} rules passed, ${found.violations.length} not`);
    await context.close();
  }
}

async function screens(browser, page, folder) {
  fs.mkdirSync(folder, { recursive: true });
  for (const [width, colorScheme] of [[1400, "light"], [800, "light"], [390, "light"], [1400, "dark"]]) {
    const { tab, context } = await opened(browser, page, { viewport: { width, height: 1000 }, colorScheme });
    await tab.screenshot({ path: path.join(folder, `empty-${width}-${colorScheme}.png`) });
    await dropped(tab, [path.join(ROOT, "fixtures/imu_at_rest.csv")]);
    await tab.waitForTimeout(1500);
    await tab.screenshot({ path: path.join(folder, `one-${width}-${colorScheme}.png`), fullPage: true });
    await tab.locator("#report").scrollIntoViewIfNeeded();
    await tab.waitForTimeout(800);
    await tab.screenshot({ path: path.join(folder, `report-${width}-${colorScheme}.png`) });
    const wide = await tab.evaluate(() => document.documentElement.scrollWidth > document.documentElement.clientWidth);
    check(!wide, `the page is wider than ${width} px`);
    await context.close();
  }
}

async function main() {
  const words = process.argv.slice(2), named = name => {
    const at = words.indexOf(name);
    return at < 0 ? undefined : words.splice(at, 2)[1];
  };
  const kind = named("--browser") || "chromium", folder = named("--screens"), only = named("--only"), scene = named("--use"), program = named("--native");
  const [page, ...files] = words;
  const scratch = fs.mkdtempSync(path.join(os.tmpdir(), "page-"));
  const browser = await launched(kind);
  const steps = {
    recorder: () => recorderWorks(browser),
    uses: () => uses(browser, page, scratch, scene),
    injections: () => injections(browser, page, scratch),
    accessible: () => accessible(browser, page),
    screens: () => folder && screens(browser, page, folder),
    files: () => everyFile(browser, page, files.length > 0 ? files : fixtures(), program, scratch),
  };
  for (const [name, step] of Object.entries(steps)) if (!only || only === name || name === "recorder") {
    try {
      await step();
    } catch (error) {
      check(false, `${name}: ${String(error).split("\n").slice(0, 3).join(" ")}`);
    }
  }
  await browser.close();
  fs.rmSync(scratch, { recursive: true });
  console.log(faults.length === 0 ? "page: no fault" : `page: ${faults.length} faults`);
  process.exit(faults.length > 0 ? 1 : 0);
}

main();
