#!/usr/bin/env python3
"""One long log in several divisions: the joined reports have to be the same bytes; the memory of a worker and
of the one that joins.

usage: stretches_trial.py BUILD FOLDER [--samples N] [--channels C] [--divisions 64,7,2,1]

Makes N samples of float32 (four bytes each; white noise and a walk; of C channels in turn) in FOLDER, plans
them in so many stretches, runs every unit in a process of its own, and prints a row a division: largest
worker, join, seconds, digests of report.json, curves.csv and the record. Exit 1 where they differ.
"""

import argparse
import hashlib
import pathlib
import re
import shutil
import subprocess
import sys
import time


def call(words, folder):
    """Peak resident memory in MB."""
    done = subprocess.run(["/usr/bin/time", "-f", "%M", *[str(w) for w in words]], cwd=folder, capture_output=True,
                          text=True)
    assert done.returncode == 0, done.stderr
    return int(re.findall(r"\d+", done.stderr)[-1]) / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=lambda p: pathlib.Path(p).resolve())
    parser.add_argument("folder", type=lambda p: pathlib.Path(p).resolve())
    parser.add_argument("--samples", type=int, default=5_000_000_000)
    parser.add_argument("--channels", type=int, default=1)
    parser.add_argument("--divisions", default="64,7,2,1")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    program = options.build / "tools/sensorchar"
    log = options.folder / "long.f32"
    if not log.exists():
        subprocess.run([options.build / "tests/bench/stretches_bench", "make", str(options.samples), log],
                       check=True, stdout=subprocess.DEVNULL)
        channels = ", ".join(f'{{"name": "gyro_{c + 1}", "unit": "deg/s"}}' for c in range(options.channels))
        head = '"dtype": "f32", "endian": "little", "rate_hz": 1000'
        pathlib.Path(f"{log}.json").write_text(f'{{{head}, "channels": [{channels}]}}\n')
    seen = set()
    print("| stretches | worker, MB | join, MB | s | report.json, curves.csv, device.record "
          "|\n|---:|---:|---:|---:|---|")
    for count in map(int, options.divisions.split(",")):
        fleet, begun = options.folder / f"in-{count}", time.time()
        shutil.rmtree(fleet, ignore_errors=True)
        call([program, "fleet", "plan", log, "--split-above", 1024, "--stretch", log.stat().st_size // count, "-o",
              fleet, "--quiet"], options.folder)
        peaks = [call([program, "fleet", "run", task, "--threads", 1, "--quiet"], options.folder)
                 for task in sorted((fleet / "tasks").iterdir())]
        report = next((fleet / "results").glob("*/*/report.json")).parent
        digests = " ".join(hashlib.sha256((report / name).read_bytes()).hexdigest()[:12]
                           for name in ("report.json", "curves.csv", "device.record"))
        seen.add(digests)
        print(f"| {len(peaks) - 1} | {max(peaks[:-1]):.0f} | {peaks[-1]:.0f} | {time.time() - begun:.0f} | "
              f"{digests} |", flush=True)
    print("the same bytes" if len(seen) == 1 else "NOT the same")
    return len(seen) != 1


if __name__ == "__main__":
    sys.exit(main())
