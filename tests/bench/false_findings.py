"""How often a sound log is called doubtful: simulated logs of eleven kinds (rates, units, formats, quantization,
gaps, clocks), 20 seeds each, through characterize. Prints the cautions and bad findings, a line for each kind.

usage: false_findings.py PROGRAM [SEEDS = 20]
"""
import collections
import json
import pathlib
import random
import subprocess
import sys
import tempfile

program = sys.argv[1]
seeds = int(sys.argv[2]) if len(sys.argv) > 2 else 20
# name: unit, rate, N, B, K, resolution, samples, suffix of the log, options of characterize
KINDS = {
    "white gyroscope": ("deg/s", 100, 5e-3, 0, 0, None, 60000, ".npy", []),
    "gyroscope N B": ("deg/s", 200, 5e-3, 4e-3, 0, None, 60000, ".f64", []),
    "gyroscope N K": ("rad/s", 400, 1e-4, 0, 2e-5, None, 60000, ".csv", []),
    "gyroscope N B K": ("deg/s", 100, 5e-3, 3e-3, 5e-4, None, 200000, ".npy", []),
    "accelerometer in g": ("g", 50, 1e-4, 5e-5, 0, None, 40000, ".csv", []),
    "coarse magnetometer": ("uT", 20, 0.1, 0, 0, 0.3, 20000, ".csv", []),
    "whole counts": ("deg/s", 100, 5e-3, 0, 0, 6e-3, 10000, ".npy", []),
    "slow barometer": ("Pa", 1, 2, 0.5, 0, None, 7200, ".csv", []),
    "gaps": ("deg/s", 100, 5e-3, 0, 0, None, 30000, ".csv", []),
    "clock": ("s", 1, 1e-9, 0, 0, None, 20000, ".csv", ["--data", "phase"]),
    "short": ("m/s^2", 100, 1e-3, 0, 0, None, 2000, ".csv", []),
}


def drop_rows(path, draw):
    lines = path.read_text().splitlines()
    keep = [line for i, line in enumerate(lines) if i < 2 or draw.random() > 0.003]
    path.write_text("\n".join(keep) + "\n")


counts = {"caution": 0, "bad": 0}
with tempfile.TemporaryDirectory() as folder:
    here = pathlib.Path(folder)
    for number, (kind, (unit, rate, white, flicker, walk, step, samples, suffix, options)) in enumerate(KINDS.items()):
        model = here / "model.yaml"
        model.write_text(f"format: sensor-model\nversion: 1\nchannel: s\nunit: {unit}\nrate_hz: {rate}\n"
                         f"density: two-sided\nwhite_noise: {white}\nbias_instability: {flicker}\n"
                         f"random_walk: {walk}\n" + (f"resolution: {step}\n" if step else ""))
        said = collections.Counter()
        for seed in range(seeds):
            log, out = here / f"log{seed}{suffix}", here / "out"
            own = 1000 * (number + 1) + seed  # kinds of one seed are one draw
            subprocess.run([program, "simulate", model, "--samples", str(samples), "--seed", str(own), "-o", log,
                            "--no-truth", "--no-scene", "--force", "-q"], check=True)
            if kind == "gaps":
                drop_rows(log, random.Random(seed))
            more = ["--rate", str(rate)] if suffix == ".npy" else []
            ran = subprocess.run([program, "characterize", log, "-o", out, "--force", "-q", *options, *more],
                                 capture_output=True, text=True)
            if ran.returncode != 0:
                sys.exit(f"{kind}, seed {seed}: {ran.stderr}")
            report = json.loads((out / "report.json").read_text())
            for channel in report["summary"]["channels"]:
                for one in channel["findings"]:
                    if one["severity"] != "note":
                        said[f"{one['severity']} {one['code']}"] += 1
                        counts[one["severity"]] += 1
            log.unlink()
        print(f"{kind}: {seeds} logs; " + (", ".join(f"{n} × {what}" for what, n in said.items()) or "none"))
print(f"{len(KINDS) * seeds} logs: {counts['caution']} cautions, {counts['bad']} bad")
