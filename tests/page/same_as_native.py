#!/usr/bin/env python3
"""The program as it was built for the page, under node, held against the native one: every fixture is inspected
and characterized by both, each run with a time limit; plots and simulated logs are the same bytes.

usage: same_as_native.py PROGRAM BUILD [--few] [--hostile COUNT] [FILE…]
BUILD: build-page; FILE: logs besides the fixtures. --few: of every kind of fixture the first. --hostile: records with
known truth by ../shared/oracle/records/make_records.py, so many seeds of every kind.

Statuses, findings, verdicts and all other words are equal; a value lies within 1e-6 of the width of its interval
from the native one, and a number without an interval within 1e-6 of itself.
"""
import argparse
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
RECORDS = ROOT / "../shared/oracle/records/make_records.py"
RUN = ROOT / "tools/page/build/run.js"
LIMIT_S = 300
NEAR = 1e-6
# What says who ran it and how long it took: steps of a descent as well.
OF_THE_RUN = {"tool", "command", "measured", "seconds", "files_sha256", "iterations"}
# Exact ramps and steps: what is left of them is the rounding of sines and logarithms, and so are the
# coefficients. Their ratings are compared.
ROUNDING = {"jazzy.db3", "085_jitter.csv"}
FORECASTS = {"relative_sd", "bound_relative_sd", "seconds_for_10_percent"}
LOGS = ["imu_at_rest.csv", "arrays/*.npz", "arrays/*.h5", "arrays/*.mat", "arrays/*.imu", "flight/*.ulg",
        "flight/*.bin", "npy/*.npy", "packed/table.csv.*", "ros/*.db3", "ros/*.mcap", "ros/*.bag",
        "known/badinputs/csv/*", "known/badinputs/npy/*.npy"]


class Runs:
    def __init__(self, program, build):
        self.commands = {"native": [str(program)], "page": ["node", "--no-experimental-fetch", str(RUN), str(build)]}
        self.seconds = {"native": 0.0, "page": 0.0}
        # One thread: that is what is compared.
        self.environment = {**os.environ, "TERM": "dumb", "COLUMNS": "110", "NODE_PATH": "/usr/share/nodejs"}

    def __call__(self, side, words, folder):
        """(exit code, stdout, stderr)"""
        begin = time.monotonic()
        try:
            done = subprocess.run(self.commands[side] + words, cwd=folder, capture_output=True, timeout=LIMIT_S,
                                  env=self.environment)
        except subprocess.TimeoutExpired:
            return "no end", "", ""
        finally:
            self.seconds[side] += time.monotonic() - begin
        return done.returncode, done.stdout.decode(), done.stderr.decode()


def tolerance(a, b, width, where):
    size = max(abs(a), abs(b))
    # A residual is in standard deviations: its interval is 2 · 1.96 wide.
    if "/residuals/z[" in where:
        return NEAR * max(3.92, size)
    # What more data would bring is said to two digits.
    if where.rsplit("/", 1)[-1] in FORECASTS:
        return 1e-4 * size
    # A coefficient as it is drawn, which its interval may leave far wider.
    if "/asymptotes/" in where:
        return 10 * NEAR * size
    # It scatters by twice its root.
    if where.endswith("likelihood_ratio"):
        return NEAR * (1 + 2 * math.sqrt(size))
    return max(NEAR * width, 1e-12 * size) if width else max(NEAR * size, 1e-300)


NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def same_sentence(a, b):
    """But for the last digits of numbers."""
    numbers = [[float(x) for x in NUMBER.findall(text)] for text in (a, b)]
    return NUMBER.sub("#", a) == NUMBER.sub("#", b) and all(
        abs(x - y) <= NEAR * max(abs(x), abs(y)) for x, y in zip(*numbers))


def differences(a, b, where="", width=None):
    """Places where two documents say different things."""
    if isinstance(a, dict) and isinstance(b, dict):
        interval = a.get("ci95") or a.get("interval")
        if isinstance(interval, list) and len(interval) == 2 and all(isinstance(x, (int, float)) for x in interval):
            width = interval[1] - interval[0]
        for key in [*a, *(key for key in b if key not in a)]:
            if key in OF_THE_RUN:
                continue
            if key not in a or key not in b:
                yield f"{where}/{key}: only one has it"
            else:
                of_interval = key in ("value", "ci95", "interval")
                yield from differences(a[key], b[key], f"{where}/{key}", width if of_interval else None)
    elif isinstance(a, list) and isinstance(b, list):
        if len(a) != len(b):
            yield f"{where}: {len(a)} and {len(b)} entries"
        for i, (x, y) in enumerate(zip(a, b)):
            yield from differences(x, y, f"{where}[{i}]", width)
    elif isinstance(a, float) or isinstance(b, float):
        if not isinstance(a, (int, float)) or not isinstance(b, (int, float)):
            yield f"{where}: {a} and {b}"
        elif abs(a - b) > tolerance(a, b, width, where):
            yield f"{where}: {a!r} and {b!r}"
    elif isinstance(a, str) and isinstance(b, str):
        if a != b and not same_sentence(a, b):
            yield f"{where}: {a!r} and {b!r}"
    elif a != b:
        yield f"{where}: {a!r} and {b!r}"


def same_message(native, page):
    """The line of the error; the page, like a terminal, shows the place in the file below it."""
    a, b = ((text.splitlines() or [""])[0] for text in (native, page))
    return [] if a == b else [f"native: {a}", f"page:   {b}"]


def inspected(runs, log, folder):
    native, page = (runs(side, ["inspect", str(log), "--json"], folder) for side in ("native", "page"))
    if native[0] != page[0]:
        return [f"exit codes {native[0]} and {page[0]}: {page[2].strip()[-300:]}"]
    if native[0] != 0:
        return same_message(native[2], page[2])
    return list(differences(json.loads(native[1]), json.loads(page[1])))


def report_of(folder):
    return json.loads((folder / "report.json").read_text())


def characterized(runs, log, folder, words):
    for side in ("native", "page"):
        shutil.rmtree(folder / side, ignore_errors=True)
    answers = {side: runs(side, ["characterize", str(log), *words, "-o", side, "--force", "--no-timing"], folder)
               for side in ("native", "page")}
    codes = [answers[side][0] for side in ("native", "page")]
    if codes[0] != codes[1]:
        return [f"exit codes {codes}: {answers['page'][2].strip()[-300:]}"]
    if codes[0] not in (0, 4):
        return same_message(answers["native"][2], answers["page"][2])
    reports = [report_of(folder / side) for side in ("native", "page")]
    if log in ROUNDING:
        reports = [[(channel["name"], channel["rating"]) for channel in one["summary"]["channels"]] for one in reports]
    return list(differences(*reports))


def same_bytes(runs, folder, words, name):
    """`words` with OUT for the output."""
    for side in ("native", "page"):
        code, _, err = runs(side, [word.replace("OUT", f"{side}-{name}") for word in words], folder)
        if code != 0:
            return [f"{side}: exit code {code}: {err.strip()[-300:]}"]
    native, page = ((folder / f"{side}-{name}").read_bytes() for side in ("native", "page"))
    return [] if native == page else [f"{name} differs"]


def hostile(folder, seeds):
    """Records of every kind that the generator knows, as .npy or .csv."""
    made = []
    for kind in subprocess.run(["/usr/bin/python3", str(RECORDS), "--list"], check=True, capture_output=True,
                               text=True).stdout.split():
        for seed in range(1, seeds + 1):
            out = folder / f"{kind}-{seed}.npy"
            subprocess.run(["/usr/bin/python3", str(RECORDS), kind, "-o", str(out), "--records", "1", "--seed",
                            str(seed), "--samples", str(10000 * seed)], check=True, capture_output=True)
            made.append(out if out.exists() else out.with_suffix(".csv"))  # with stamps of its own
    return made


def logs(arguments, folder):
    found = []
    for pattern in LOGS:
        fixtures = sorted((ROOT / "fixtures").glob(pattern))
        found += fixtures[:1] if arguments.few else fixtures
    return found + hostile(folder, arguments.hostile) + [name.resolve() for name in arguments.files]


def arguments_of(words):
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("files", nargs="*", type=pathlib.Path)
    parser.add_argument("--few", action="store_true")
    parser.add_argument("--hostile", type=int, default=0)
    return parser.parse_intermixed_args(words)  # FILE… may stand behind options


def main():
    arguments = arguments_of(sys.argv[1:])
    runs = Runs(arguments.program.resolve(), arguments.build.resolve())
    failed = 0
    with tempfile.TemporaryDirectory() as name, tempfile.TemporaryDirectory() as records:
        folder = pathlib.Path(name)

        def check(what, found):
            nonlocal failed
            if found:
                failed += 1
                print(f"{what}: {len(found)} differences", *found[:4], sep="\n    ", flush=True)

        checked = logs(arguments, pathlib.Path(records))
        for log in checked:
            link = folder / log.name  # NODEFS sees what is below the folder
            link.write_bytes(log.read_bytes())
            for beside in (log.with_suffix(".yaml"), log.parent / f"{log.name}.json", log.parent / f"{log.name}.yaml"):
                if beside.exists():
                    (folder / beside.name).write_bytes(beside.read_bytes())
            check(f"inspect {log.name}", inspected(runs, log.name, folder))
            rate = ["--rate", "200Hz"] if log.suffix in (".npy", ".npz") else []
            check(f"characterize {log.name}", characterized(runs, log.name, folder, rate))
        (folder / "imu.csv").write_bytes((ROOT / "fixtures/imu_at_rest.csv").read_bytes())
        runs("native", ["characterize", "imu.csv", "-o", "report", "--force"], folder)
        for kind in ("allan", "psd", "residuals", "trace"):
            words = ["plot", "report", "--kind", kind, "-c", "gyro_z", "-o", "OUT"]
            check(f"plot {kind}", same_bytes(runs, folder, words, f"{kind}.svg"))
        model = "report/gyro_z.sensor.yaml"
        words = ["simulate", model, "--duration", "200s", "--no-scene", "-o", "OUT"]
        check("simulate", same_bytes(runs, folder, words, "simulated.csv"))
        check("model", same_bytes(runs, folder, ["model", model, "--to", "json", "-o", "OUT"], "model.json"))
        print(f"{len(checked)} logs, {failed} runs with differences; {runs.seconds['native']:.1f} s native, "
              f"{runs.seconds['page']:.1f} s under node")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
