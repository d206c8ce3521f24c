#!/usr/bin/env python3
"""Where a fleet stops scaling: the jobs of a plan on 1 to 1,000 workers, by a model with measured costs.

usage: fleet_model.py [--devices N] [--unit-s S] [--unit-cv C] [--unit-mb M] [--job-s S] [--start-s S] [--dispatch-s S]
                      [--storage-mb-s B] [--plan-s S] [--merge-s S] [--seed K]

A job holds as many units as its length allows. A worker that is free takes the next job; the engine starts
one job after the other (--dispatch-s each), a job takes --start-s and its units' seconds (log-normal, mean
--unit-s, coefficient of variation --unit-cv), and reads its units' bytes from a storage that all workers
share in equal parts (--storage-mb-s). Planning and merging are one process each, --plan-s and --merge-s a
device. Prints a row for each number of workers: time, speed-up, efficiency, and which part it is.
"""

import argparse
import heapq
import math
import random

WORKERS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000]


def jobs_of(options):
    rng = random.Random(options.seed)
    sigma = math.sqrt(math.log(1 + options.unit_cv**2))
    jobs, seconds, megabytes = [], 0.0, 0.0
    for _ in range(options.devices):
        seconds += options.unit_s * math.exp(rng.gauss(-sigma * sigma / 2, sigma))
        megabytes += options.unit_mb
        if seconds >= options.job_s:
            jobs.append((seconds, megabytes))
            seconds = megabytes = 0.0
    if seconds > 0:
        jobs.append((seconds, megabytes))
    return jobs


def makespan(jobs, workers, options):
    """List scheduling; bytes at the share that all workers at work leave."""
    share = options.storage_mb_s / min(workers, len(jobs))
    free = [0.0] * workers
    heapq.heapify(free)
    engine = end = 0.0
    for seconds, megabytes in jobs:
        at = heapq.heappop(free)
        engine = max(engine, at) + options.dispatch_s if at > engine else engine + options.dispatch_s
        done = max(engine, at) + options.start_s + max(seconds, megabytes / share)
        heapq.heappush(free, done)
        end = max(end, done)
    return end


def what_holds(jobs, workers, options, total):
    parts = {
        "work": sum(s for s, _ in jobs) / workers,
        "storage": sum(m for _, m in jobs) / options.storage_mb_s,
        "engine": len(jobs) * options.dispatch_s,
        "longest job": max(s for s, _ in jobs) + options.start_s,
        "plan and merge": options.devices * (options.plan_s + options.merge_s),
    }
    return max(parts, key=parts.get) if total > 0 else ""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, value in (("unit-s", 0.15), ("unit-cv", 0.2), ("unit-mb", 0.4), ("job-s", 60), ("start-s", 0.1),
                        ("dispatch-s", 0.05),
                        ("storage-mb-s", 2000), ("plan-s", 0.001), ("merge-s", 0.0005)):
        parser.add_argument("--" + name, type=float, default=value)
    parser.add_argument("--devices", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    jobs = jobs_of(options)
    serial = options.devices * (options.plan_s + options.merge_s)
    alone = sum(s for s, _ in jobs) + serial
    print(f"{options.devices} devices in {len(jobs)} jobs; one process alone: {alone:.0f} s")
    print("| workers | time, s | speed-up | efficiency | held by |\n|---:|---:|---:|---:|---|")
    for workers in WORKERS:
        time = makespan(jobs, workers, options) + serial
        print(f"| {workers} | {time:.1f} | {alone / time:.1f} | {100 * alone / time / workers:.0f} % | "
              f"{what_holds(jobs, workers, options, time)} |")


if __name__ == "__main__":
    main()
