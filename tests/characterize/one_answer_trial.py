"""One log through every door: fit, characterize, --memory, one thread, the stretches of a fleet. Coefficients,
intervals, p, statuses and what was found have to be the same to the last bit.

usage: one_answer_trial.py PROGRAM FOLDER [--samples N]...
(needs python3-numpy; 10⁸ samples take some minutes)
Clean, dirty (spikes, gaps, a line, a step) and clock logs of each length. Prints a line for each and ends with 1
where two doors differ.
"""
import argparse
import json
import pathlib
import shutil
import subprocess
import sys

import numpy as np

arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("program")
arguments.add_argument("folder", type=pathlib.Path)
arguments.add_argument("--samples", type=int, action="append")
options = arguments.parse_args()
program = str(pathlib.Path(options.program).resolve())
RATE = 100.0


def noise(n, rng):
    return 0.05 * rng.standard_normal(n) + 2e-4 * np.cumsum(rng.standard_normal(n))


def dirty(n, rng):
    y = noise(n, rng) + 0.05 * np.sin(2 * np.pi * 0.2513 * np.arange(n))
    wild = rng.integers(0, n, n // 1000)
    y[wild] += rng.choice([-1.5, 1.5], len(wild))
    y[5 * n // 9:] += 0.4
    y[rng.integers(0, n, n // 1000)] = np.nan
    y[n // 3:n // 3 + n // 200] = np.nan
    return y


def clock(n, rng):
    return np.cumsum(1e-9 * noise(n, rng))


def run(*words):
    ran = subprocess.run([program, *map(str, words)], cwd=options.folder, capture_output=True, text=True)
    if ran.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}: exit code {ran.returncode}: {ran.stderr[:400]}")
    return ran.stdout


def fit_of(document, report=None):
    """Coefficients and the rest of a fit, with all that is found of the channel: `fit` has that in one list, a report
    in its summary. The spectrum, which `fit` does not compute, says where a line is and how high, or that it cannot be
    computed."""
    channel = document["channels"][0]
    if report:
        channel["findings"] = report["summary"]["channels"][0]["findings"]
    channel["findings"] = [one for one in channel["findings"] if one["code"] != "not_computed"]
    for finding in channel["findings"]:
        if finding["code"] == "lines_left_out":
            finding.pop("where", None)
            finding["sentence"] = finding["sentence"].split(" The strongest")[0]
    for key in ("name", "bins", "residuals", "derived"):
        channel.pop(key, None)
    return json.dumps(channel, sort_keys=True)


def doors(log, extra):
    reading = ["--rate", RATE, *extra]
    yield "fit", fit_of(json.loads(run("fit", log, *reading, "--json")))
    yield "fit --memory 8MiB", fit_of(json.loads(run("fit", log, *reading, "--json", "--memory", "8MiB")))
    yield "fit --threads 1", fit_of(json.loads(run("fit", log, *reading, "--json", "--threads", "1")))
    for name, more in (("", []), (" --memory 1KiB --segment 4096", ["--memory", "1KiB", "--segment", "4096"])):
        run("characterize", log, *reading, *more, "-o", "report", "--force")
        report = json.loads((options.folder / "report/report.json").read_text())
        yield f"characterize{name}", fit_of(report["fit"], report)
    for stretch in ("8MiB", "64MiB"):
        plan = f"plan-{stretch}"
        shutil.rmtree(options.folder / plan, ignore_errors=True)
        run("fleet", "plan", log, *reading, "--split-above", "1MiB", "--stretch", stretch, "-o", plan)
        run("fleet", "run", plan)
        reports = sorted((options.folder / plan).rglob("report.json"))
        report = json.loads(reports[0].read_text())
        yield f"fleet, stretches of {stretch}", fit_of(report["fit"], report)


options.folder.mkdir(parents=True, exist_ok=True)
differ = 0
for samples in options.samples or [10_000, 1_000_000, 2_100_000, 5_000_000]:
    for kind, extra in ((noise, []), (dirty, []), (clock, ["--data", "phase"])):
        log = f"{kind.__name__}-{samples}.npy"
        np.save(options.folder / log, kind(samples, np.random.default_rng(samples)))
        found = list(doors(log, extra))
        others = [name for name, fit in found if fit != found[0][1]]
        differ += len(others)
        answer = "one answer" if not others else "other answers: " + ", ".join(others)
        print(f"{log}: {len(found)} doors, {answer}", flush=True)
sys.exit(bool(differ))
