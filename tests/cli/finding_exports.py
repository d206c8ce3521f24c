"""Findings in the files of every consumer: a model with a bad one is refused (E0594), or written with its sentence;
what asks for caution is a comment, once for each channel.

usage: finding_exports.py PROGRAM
"""
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
from finding_inputs.parts import noise, raw  # noqa: E402

program = sys.argv[1]
AXES = {"gx": "rad/s", "gy": "rad/s", "gz": "rad/s", "ax": "m/s^2", "ay": "m/s^2", "az": "m/s^2"}
GRAVITY = 9.80665
faults = []


def run(*words):
    return subprocess.run([program, *map(str, words)], capture_output=True, text=True)


def drifting(n, seed):
    """White noise on a random walk: numbers for everyone."""
    walk, out = 0.0, []
    for white, step in zip(noise(n, 0.02, seed), noise(n, 0.0005, seed + 50)):
        walk += step
        out.append(white + walk)
    return out


def device(change):
    """The six axes of a device at rest, each after `change`."""
    return {name: (unit, [v + (GRAVITY if name == "az" else 0) for v in change(drifting(20000, seed))])
            for seed, (name, unit) in enumerate(AXES.items())}


def moved(x):
    return [v + (6 * math.sin(i / 9) * math.sin(i / 700) if 5000 <= i < 15000 else 0) for i, v in enumerate(x)]


def held(x):
    return [v for v in x[::2] for _ in range(2)]


def expect(holds, what):
    if not holds:
        faults.append(what)


targets = re.findall(r"^([a-z0-9-]{2,})  ", run("model", "--list").stdout, re.M)  # c is not made of models
expect(len(targets) > 10, f"model --list: {targets}")
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    for kind, change, code in (("bad", moved, "motion"), ("caution", held, "held_values")):
        log, report = raw(kind, lambda: device(change))(folder), folder / kind
        ran = run("characterize", log, "-o", report)
        expect(ran.returncode == 0, f"{kind}: {ran.stderr}")
        channels = json.loads((report / "report.json").read_text())["summary"]["channels"]
        said_of = [one for channel in channels for one in channel["findings"] if one["code"] == code]
        expect(len(said_of) == len(AXES), f"{kind}: {code} of {len(said_of)} channels")
        sentence = " ".join(said_of[0]["sentence"].split()[:4])
        for target in targets:
            plain, anyway = run("model", report, "--to", target), run("model", report, "--to", target, "--anyway")
            what = f"{kind}, --to {target}"
            refused = plain.returncode == 3 and "E0594" in plain.stderr
            # The model itself keeps what is said of it.
            expect(refused == (kind == "bad" and target != "json"), f"{what}: exit {plain.returncode}")
            expect(anyway.returncode == 0, f"{what}, --anyway: exit {anyway.returncode}: {anyway.stderr[-200:]}")
            for channel in AXES:
                said = re.search(rf"\b{channel}\b[^\n]*{re.escape(sentence)}", anyway.stdout) or target == "json"
                expect(said, f"{what}: the file does not say it of {channel}")
            expect(anyway.stdout.count(sentence) >= len(AXES), f"{what}: {anyway.stdout.count(sentence)} sentences")

print("\n".join(faults) or f"findings: {len(targets)} exports refuse what is bad and say what asks for caution")
sys.exit(bool(faults))
