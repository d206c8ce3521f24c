// What the tests of the page share: a page opened with every request recorded, files dropped on it, faults counted.
"use strict";
const fs = require("fs"), http = require("http"), path = require("path");
const playwright = require("playwright-core");

const ROOT = path.resolve(__dirname, "../..");
const LIMIT_MS = 120000;
const BROWSERS = {
  chromium: { executablePath: "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu"] },
  firefox: { executablePath: "/usr/bin/firefox-esr", channel: "moz-firefox" }, // Debian's own, by WebDriver BiDi
};
const faults = [];

function check(good, what) {
  if (!good) faults.push(what);
  if (!good) console.log(`FAULT: ${what}`);
}

function fixtures() {
  const found = [];
  for (const folder of ["arrays", "flight", "npy", "packed", "ros", "known/badinputs/csv", "known/badinputs/npy"]) {
    const full = path.join(ROOT, "fixtures", folder);
    for (const name of fs.readdirSync(full).sort()) if (!/\.(py|mjs|md|tsv)$/.test(name)) found.push(path.join(full, name));
  }
  return [path.join(ROOT, "fixtures/imu_at_rest.csv"), ...found];
}

/** Addresses outside of the page that a context asks for, as they come. */
function requestsOf(context) {
  const requests = [];
  context.on("request", request => {
    if (!/^(data|blob|file):|^about:/.test(request.url())) requests.push(request.url());
  });
  return requests;
}

/** Does the browser tell of requests at all? */
async function recorderWorks(browser) {
  const server = http.createServer((request, response) => response.end()).listen(0, "127.0.0.1");
  const context = await browser.newContext(), requests = requestsOf(context), tab = await context.newPage();
  await tab.evaluate(port => fetch(`http://127.0.0.1:${port}/`, { mode: "no-cors" }), server.address().port);
  check(requests.length === 1, `a request is recorded: ${requests}`);
  await context.close();
  server.close();
}

async function opened(browser, page, options = {}) {
  const context = await browser.newContext({ acceptDownloads: true, ...options });
  const requests = requestsOf(context);
  const tab = await context.newPage();
  const said = [];
  tab.on("console", message => {
    if (message.type() === "error") said.push(message.text());
  });
  tab.on("pageerror", error => said.push(String(error)));
  tab.on("dialog", dialog => {
    said.push(`dialog ${dialog.message()}`);
    dialog.dismiss();
  });
  const begin = Date.now();
  await tab.goto(`file://${path.resolve(page)}`);
  await state(tab, ["ready"]);
  return { tab, context, requests, said, start: Date.now() - begin };
}

async function state(tab, wanted, limit = LIMIT_MS) {
  await tab.waitForFunction(states => states.includes(document.documentElement.dataset.state), wanted, { timeout: limit });
  return tab.evaluate(() => document.documentElement.dataset.state);
}

/** Drops files and waits for the end; milliseconds to the first number and to the end. */
async function dropped(tab, files) {
  const begin = Date.now();
  await tab.setInputFiles("#logs", files);
  await tab.waitForFunction(() => document.documentElement.dataset.state !== "ready", null, { timeout: LIMIT_MS });
  await tab.waitForFunction(() => document.querySelector("#found table, #found .bad, #found .asked, #found .facts:not(:empty)"), null, { timeout: LIMIT_MS });
  const first = Date.now() - begin;
  const end = await state(tab, ["done", "error"]);
  return { end, first, all: Date.now() - begin };
}

/** A browser by its name. */
const launched = kind => playwright[kind].launch(BROWSERS[kind]);

module.exports = { ROOT, LIMIT_MS, faults, check, fixtures, recorderWorks, opened, state, dropped, launched };
