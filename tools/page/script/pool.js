// Workers with an instance of the program each. A page from disk has no shared memory: what runs side by side are commands.
"use strict";

class Pool {
  constructor(source, module) {
    this.url = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
    this.module = module;
    this.idle = [];
    this.busy = new Map(); // worker → its job
    this.waiting = [];
    this.next = 1;
    this.digests = new Map(); // file → a promise of its digest
    this.most = Math.max(1, Math.min(4, (navigator.hardwareConcurrency || 2) - 1));
  }
  /** A command: {words, logs, files, digests, progress}. Resolves to what the worker answers; rejects where it was cancelled. */
  run(job) {
    return new Promise((resolve, reject) => {
      this.waiting.push({ ...job, id: this.next++, resolve, reject });
      this.deal();
    });
  }
  /** Has the digest of a log taken by a worker more, beside those that read it. */
  digest(log) {
    if (this.digests.has(log.file)) return;
    const worker = this.start(), taken = new Promise((resolve, reject) => this.busy.set(worker, { apart: true, resolve, reject }));
    worker.postMessage({ digested: log });
    this.digests.set(log.file, taken);
    taken.catch(() => {}); // cancelled, and nobody waits for it
  }
  /** Digests that were asked for, by the names of the logs, as soon as all of them are taken; one that failed is left to the command. */
  async digestsOf(logs) {
    const asked = logs.filter(({ file }) => this.digests.has(file));
    const taken = await Promise.all(asked.map(async ({ name, file }) => [name, (await this.digests.get(file)).digest]));
    return Object.fromEntries(taken.filter(([, digest]) => digest));
  }
  cancel() {
    const jobs = [...this.busy.values(), ...this.waiting];
    for (const worker of this.busy.keys()) worker.terminate();
    this.busy.clear();
    this.waiting = [];
    this.digests.clear();
    for (const job of jobs) job.reject(new Cancelled());
  }
  /** A worker that waits: the first command need not wait for it. A browser compiles what runs for the first time: where nobody wants anything
   * yet, `job`, of which nothing is kept, runs once. */
  warm(job) {
    const quiet = () => this.next === 1 && this.busy.size === 0;
    if (quiet()) this.idle.push(this.start());
    setTimeout(() => {
      if (!quiet() || this.idle.length === 0) return;
      const worker = this.idle.pop();
      this.busy.set(worker, { apart: true, resolve: () => {}, reject: () => {} });
      worker.postMessage({ id: 0, logs: [], files: [], digests: {}, ...job });
    }, 300);
  }
  deal() {
    const free = () => [...this.busy.values()].filter(({ apart }) => !apart).length < this.most;
    while (this.waiting.length > 0 && free()) {
      const worker = this.idle.pop() || this.start(), job = this.waiting.shift();
      this.busy.set(worker, job);
      worker.postMessage({ id: job.id, words: job.words, logs: job.logs || [], files: job.files || [], digests: job.digests || {} });
    }
  }
  start() {
    const worker = new Worker(this.url);
    worker.postMessage({ module: this.module });
    worker.onmessage = ({ data }) => this.heard(worker, data);
    worker.onerror = event => this.heard(worker, { failed: event.message || "the worker ended" });
    return worker;
  }
  heard(worker, data) {
    const job = this.busy.get(worker);
    if (!job) return;
    if (data.progress !== undefined) {
      if (job.progress) job.progress(data.progress);
      return;
    }
    this.busy.delete(worker);
    // What went wrong may have left it without memory.
    if (data.failed === undefined) this.idle.push(worker);
    else worker.terminate();
    job.resolve(data);
    this.deal();
  }
}

class Cancelled extends Error {}
