#!/usr/bin/env python3
"""The program as it was built for the page, under node, held against the native one: every fixture is inspected
and characterized by both, each run with a time limit; plots and simulated logs are the same bytes.

usage: same_as_native.py PROGRAM BUILD [FILE…]     BUILD: build-page; FILE: logs besides the fixtures

Statuses, findings, verdicts and all other words are equal; a value lies within 1e-6 of the width of its interval
from the native one, and a number without an interval within 1e-6 of itself.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
RUN = ROOT / "tools/page/build/run.js"
LIMIT_S = 300
NEAR = 1e-6
# What says who ran it and how long it took.
OF_THE_RUN = {"tool", "command", "measured", "seconds", "files_sha256", "sha256_of_files"}
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
        elif abs(a - b) > (NEAR * width if width else max(NEAR * max(abs(a), abs(b)), 1e-300)):
            yield f"{where}: {a!r} and {b!r}"
    elif a != b:
        yield f"{where}: {a!r} and {b!r}"


def same_lines(native, page):
    return [f"native: {a}\n    page:   {b}" for a, b in zip(native.splitlines(), page.splitlines()) if a != b][:3] or (
        [] if len(native.splitlines()) == len(page.splitlines()) else ["another number of lines"])


def inspected(runs, log, folder):
    native, page = (runs(side, ["inspect", str(log), "--json"], folder) for side in ("native", "page"))
    if native[0] != page[0]:
        return [f"exit codes {native[0]} and {page[0]}: {page[2].strip()[-300:]}"]
    if native[0] != 0:
        return same_lines(native[2], page[2])
    return list(differences(json.loads(native[1]), json.loads(page[1])))


def report_of(folder):
    return json.loads((folder / "report.json").read_text())


def characterized(runs, log, folder, words):
    answers = {side: runs(side, ["characterize", str(log), *words, "-o", side, "--force", "--no-timing"], folder)
               for side in ("native", "page")}
    codes = [answers[side][0] for side in ("native", "page")]
    if codes[0] != codes[1]:
        return [f"exit codes {codes}: {answers['page'][2].strip()[-300:]}"]
    if codes[0] not in (0, 4):
        return same_lines(answers["native"][2], answers["page"][2])
    return list(differences(report_of(folder / "native"), report_of(folder / "page")))


def same_bytes(runs, folder, words, name):
    """`words` with OUT for the output."""
    for side in ("native", "page"):
        code, _, err = runs(side, [word.replace("OUT", f"{side}-{name}") for word in words], folder)
        if code != 0:
            return [f"{side}: exit code {code}: {err.strip()[-300:]}"]
    native, page = ((folder / f"{side}-{name}").read_bytes() for side in ("native", "page"))
    return [] if native == page else [f"{name} differs"]


def logs(extra):
    found = [path for pattern in LOGS for path in sorted((ROOT / "fixtures").glob(pattern))]
    return found + [pathlib.Path(name).resolve() for name in extra]


def main():
    runs = Runs(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve())
    failed = 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)

        def check(what, found):
            nonlocal failed
            if found:
                failed += 1
                print(f"{what}: {len(found)} differences", *found[:4], sep="\n    ", flush=True)

        checked = logs(sys.argv[3:])
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
            words = ["plot", "report", "--kind", kind, "-o", "OUT"]
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
