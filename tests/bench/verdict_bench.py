#!/usr/bin/env python3
"""Is the verdict's choice good? Thermometers side by side with unlike offsets, lags, resolutions and noise, a
seed each.

usage: verdict_bench.py PROGRAM [SEEDS]

Each scene is replayed twice: with the truth as its reference (learnt on the first third, judged on the rest)
and without any reference. Printed is the error against the truth of what each verdict recommends, over that
of the best method of its own list (bounds apart).
"""

import csv
import json
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

ROWS, STEP_S, SENSORS = 10_000, 60.0, 9


def truth(rng):
    """A daily swing, weather that wanders, and fast moves of a door."""
    out, slow, fast = [], 0.0, 0.0
    for k in range(ROWS):
        slow = 0.9995 * slow + 0.06 * rng.gauss(0, 1)
        fast = 0.97 * fast + (rng.gauss(0, 0.2) if rng.random() < 0.02 else 0.0)
        out.append(20 + 4 * math.sin(2 * math.pi * k * STEP_S / 86400) + slow + fast)
    return out


def sensor(rng, x):
    """Offset, lag of first order, drift, noise, resolution."""
    offset, lag = rng.gauss(0, 0.1), rng.choice([0, 30, 60, 120, 300])
    noise, resolution = rng.choice([0.02, 0.05, 0.1, 0.2]), rng.choice([0.01, 0.0625, 0.1, 0.25])
    state, drift, out = x[0], 0.0, []
    gain = 1 - math.exp(-STEP_S / lag) if lag else 1.0
    for value in x:
        state += gain * (value - state)
        drift += rng.gauss(0, 0.0004)
        y = state + offset + drift + rng.gauss(0, noise)
        out.append(round(y / resolution) * resolution)
    return out


def run(program, folder, scene, *more):
    path = folder / "scene.yaml"
    path.write_text(scene)
    done = subprocess.run([program, "replay", path, "-o", folder / "out", "--force", "--json", *more],
                          capture_output=True, text=True)
    if done.returncode not in (0, 4):
        sys.exit(done.stderr)
    return json.loads(done.stdout)


def errors(path, x):
    """RMS error of each method against the truth, from its estimates."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    names, out = [column.split("[")[0].strip() for column in rows[0]], {}
    for c in range(2, len(names)):
        squares = [(float(row[c]) - x[round(float(row[0]) / STEP_S)]) ** 2 for row in rows[1:] if row[c]]
        if squares:
            out[names[c]] = math.sqrt(sum(squares) / len(squares))
    return out


def ran(report):
    return [a for a in report["algorithms"] if a["status"] == "ran" and not a["bound"]]


def main():
    program, seeds = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 20
    good = {"with": 0, "without": 0}
    print("seed  with a reference                 without one                      (chosen, over the best)")
    for seed in range(1, seeds + 1):
        rng = random.Random(seed)
        x = truth(rng)
        columns = [sensor(rng, x) for _ in range(SENSORS)]
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            with open(folder / "log.csv", "w", newline="") as file:
                out = csv.writer(file)
                out.writerow(["t[s]", "truth[degC]"] + [f"s{i}[degC]" for i in range(SENSORS)])
                for k in range(ROWS):
                    out.writerow([f"{k * STEP_S:g}", f"{x[k]:.6f}"] + [f"{c[k]:.4f}" for c in columns])
            sensors = "".join(f"  - {{name: s{i}, channel: s{i}}}\n" for i in range(SENSORS))
            head = f"format: scene\nversion: 1\nname: thermometers\nrecording: log.csv\nsensors:\n{sensors}"
            third = ROWS // 3 * STEP_S
            judged = f"learning: [0, {third:g}]\nevaluation: [{third:g}, end]\n"
            taught = run(program, folder, head + "reference: {channels: [truth]}\n" + judged)
            blind = run(program, folder, head + f"evaluation: [{third:g}, end]\n", "--estimates", "csv")
            blind_known = errors(folder / "out" / "estimates.csv", x)
        known = {a["name"]: a["rmse"] for a in ran(taught) if a["rmse"] is not None}
        row = f"{seed:4d}  "
        for kind, report, table, limit in (("with", taught, known, 1.05), ("without", blind, blind_known, 1.15)):
            best = report["best"]
            ratio = table[best] / min(table.values()) if best in table else math.inf
            good[kind] += ratio <= limit
            row += f"{best or 'none':>24s} {ratio:7.3f} "
        print(row)
    print(f"within 5 % with a reference: {good['with']} of {seeds}; within 15 % without one: {good['without']} of "
          f"{seeds}")


main()
