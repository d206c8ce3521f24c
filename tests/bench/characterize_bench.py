"""Speed and memory of `sensorchar characterize` against the Python pipeline (python_pipeline.py), interleaved
in one run.

    python3 tests/bench/characterize_bench.py [--build build] [--rows 10000000] [--rounds 3] [--segment 65536|0]

Needs python3-pandas and python3-scipy from Debian (/usr/bin/python3). Prints medians and ratios; asserts nothing.
"""
import argparse
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

here = pathlib.Path(__file__).resolve().parent
options = argparse.ArgumentParser()
options.add_argument("--build", default=str(here.parent.parent / "build"))
options.add_argument("--rows", type=int, default=10_000_000)
options.add_argument("--rounds", type=int, default=3)
options.add_argument("--segment", type=int, default=65536, help="0 = a quarter of the record")
options.add_argument("--log", help="use this CSV instead of making one")
options = options.parse_args()


def run(command):
    """Wall seconds, CPU seconds, peak MB of a command that must succeed."""
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    wall = time.perf_counter() - start
    if status != 0:
        sys.exit(f"{command[0]} failed with status {status}")
    return wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


folder = pathlib.Path(tempfile.mkdtemp(prefix="characterize-bench-"))
try:
    log = options.log or str(folder / "log.csv")
    if not options.log:
        subprocess.run([f"{options.build}/tests/bench/make_log_bench", log, str(options.rows)], check=True)
    print(f"log: {os.path.getsize(log) / 1e9:.2f} GB, segment {options.segment or 'N/4'}, {options.rounds} "
          f"interleaved rounds")
    segment = [] if options.segment == 0 else ["--segment", str(options.segment)]
    ours = [f"{options.build}/tools/sensorchar", "characterize", log, "-o", str(folder / "out"), "--force",
            "--quiet", *segment]
    theirs = ["/usr/bin/python3", str(here / "python_pipeline.py"), log, str(options.segment)]
    results = {"sensorchar": [], "python": []}
    for _ in range(options.rounds):
        results["sensorchar"].append(run(ours))
        results["python"].append(run(theirs))
    median = {name: [statistics.median(column) for column in zip(*rows)] for name, rows in results.items()}
    print(f"{'':12}{'wall s':>10}{'cpu s':>10}{'peak MB':>10}")
    for name, (wall, cpu, peak) in median.items():
        print(f"{name:12}{wall:10.2f}{cpu:10.2f}{peak:10.0f}")
    ratios = [[p[i] / o[i] for o, p in zip(results["sensorchar"], results["python"])] for i in range(2)]
    for what, ratio in zip(("wall", "cpu"), ratios):
        print(f"{what} ratio python / sensorchar: median {statistics.median(ratio):.1f} (from {min(ratio):.1f} to "
              f"{max(ratio):.1f})")
finally:
    shutil.rmtree(folder)
