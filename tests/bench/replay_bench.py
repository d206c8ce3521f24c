"""Replay of all algorithms on an array that streams from a file: wall time, CPU time, peak memory, and the
cost of each algorithm.

    python3 tests/bench/replay_bench.py [--sensors 12] [--samples 1000000] [--program build/tools/sensorchar]

Simulates the array once into a temporary folder (CSV, as most logs are), then replays it with the learning
window in its first tenth.
"""
import argparse
import json
import pathlib
import resource
import subprocess
import tempfile
import time

options = argparse.ArgumentParser()
options.add_argument("--sensors", type=int, default=12)
options.add_argument("--samples", type=int, default=1_000_000)
options.add_argument("--program", default="build/tools/sensorchar")
given = options.parse_args()

with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    rate = 200
    sensors = "".join(
        f"  - {{name: g{i + 1}, model: {{unit: rad/s, density: two-sided, white_noise: {{value: "
        f"{3e-3 + 5e-4 * i:.4g}}}}}}}\n"
        for i in range(given.sensors))
    end = given.samples / rate
    (folder / "array.yaml").write_text(
        f"format: scene\nversion: 1\nname: {given.sensors} gyroscopes\nsimulate:\n  rate_hz: {rate}\n  samples: "
        f"{given.samples}\n"
        f"  truth: {{kind: noise, standard_deviation: 2, bandwidth_hz: 5}}\nsensors:\n{sensors}learning: [0, "
        f"{end / 10}]\n"
        f"faults:\n  - {{sensor: g1, kind: scale, value: 0.85, from_s: {0.4 * end}, to_s: {0.7 * end}}}\n")
    subprocess.run([given.program, "simulate", folder / "array.yaml", "-o", folder / "array.csv", "--quiet"],
                   check=True, stdout=subprocess.DEVNULL)
    size = (folder / "array.csv").stat().st_size
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.monotonic()
    said = subprocess.run([given.program, "replay", folder / "array.scene.yaml", "-o", folder / "report", "--json",
                           "--quiet"],
                          check=True, capture_output=True, text=True).stdout
    wall = time.monotonic() - start
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    report = json.loads(said)
    print(f"{given.sensors} sensors, {given.samples} samples, {size / 1e6:.0f} MB of CSV, "
          f"{report['measured']['passes']} passes: "
          f"{wall:.1f} s wall, {cpu:.1f} s CPU, {after.ru_maxrss / 1024:.0f} MB peak")
    mean = next(a["ns_per_sample"] for a in report["algorithms"] if a["name"] == "mean")
    print(f"{'algorithm':34} {'ns per sample':>12} {'x mean':>8} {'learning s':>11} {'heap kB':>9}")
    for a in report["algorithms"]:
        if a["status"] == "ran":
            heap = "-" if a["peak_bytes"] is None else f"{a['peak_bytes'] / 1e3:.1f}"
            print(f"{a['label']:34} {a['ns_per_sample']:12.1f} {a['ns_per_sample'] / mean:8.1f} "
                  f"{a['learning_s']:11.3f} {heap:>9}")
