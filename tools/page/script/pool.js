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
    this.most = Math.max(1, Math.min(4, (navigator.hardwareConcurrency || 2) - 1));
  }
  /** A command: {words, logs, files, progress}. Resolves to what the worker answers; rejects where it was cancelled. */
  run(job) {
    return new Promise((resolve, reject) => {
      this.waiting.push({ ...job, id: this.next++, resolve, reject });
      this.deal();
    });
  }
  cancel() {
    const jobs = [...this.busy.values(), ...this.waiting];
    for (const worker of this.busy.keys()) worker.terminate();
    this.busy.clear();
    this.waiting = [];
    for (const job of jobs) job.reject(new Cancelled());
  }
  /** A worker that waits: the first command need not wait for it. */
  warm() {
    if (this.idle.length + this.busy.size === 0) this.idle.push(this.start());
  }
  deal() {
    while (this.waiting.length > 0 && this.busy.size < this.most) {
      const worker = this.idle.pop() || this.start(), job = this.waiting.shift();
      this.busy.set(worker, job);
      worker.postMessage({ id: job.id, words: job.words, logs: job.logs || [], files: job.files || [] });
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
