#!/usr/bin/env python3
"""Fleets, with every call that can fail failing, once and for ever, and killed before every change of the disk.

usage: fleet_faults.py PROGRAM SHIM [--quick] [--step NAME]… [--kind NAME]… [--heap N]

Each step of a fleet (plan, run, run of stretches, export, merge) begins with the same folder, in which an
earlier fleet was. After each fault: an exit code that docs/errors.md knows (from run only such as an engine
understands: 75 where it may try again), one sentence; every published result is byte for byte that of a run
without a fault, and nothing lies beside it; the plan that reads is the old one or the new one, the report the
old one or the new one. Then the step runs again without a fault, the fleet goes its way to the end, and its
report is the one of a fleet that never failed. Exit 1 where something is wrong.
"""

import argparse
import hashlib
import json
import os
import random
import shutil
import struct
import sys
from array import array
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from fault_loops import CALLS, CODES, JOURNAL, MARK, Bench, files_of, log_csv, spread

AGAIN = 75
STEPS = ["plan", "run", "stretches", "export", "merge"]


def npy(seed, rows):
    """One channel of float32 in numpy's format: a log that is divided."""
    rng = random.Random(seed)
    block = array("f", (rng.gauss(0, 1) for _ in range(1 << 14)))
    values = array("f")
    while len(values) < rows:
        k = rng.randrange(1 << 14)
        values.extend(block[k:] + block[:k])
    head = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({rows},), }}".ljust(117).encode() + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head + values[:rows].tobytes()


class Fleet:
    """Two fleets of the same folder: the earlier one, which is there, and the one that the step works on."""

    def __init__(self, bench, step):
        self.bench, self.step = bench, step
        self.logs = bench.root / f"logs-{step}"
        self.logs.mkdir()
        for seed in range(4):
            (self.logs / f"d{seed}.csv").write_text(log_csv(seed))
        self.later = [str(self.logs / f"d{seed}.csv") for seed in range(1, 4)]
        self.extra = []
        if step == "stretches":
            (self.logs / "long.npy").write_bytes(npy(9, 2 << 20))
            self.later = [str(self.logs / "long.npy")]
            self.extra = ["--rate", "100", "--split-above", "1MiB", "--stretch", "4MiB"]
        self.template = bench.root / step
        self.template.mkdir()
        self.begin(self.template)
        done = self.copy("reference")
        ran, self.counts = bench.run(done, self.words())
        if ran.returncode != 0:
            sys.exit(f"{step}: does not run without a fault:\n{ran.stderr.decode()}")
        self.old_report = report_of(self.template)
        self.to_the_end(done)
        self.results, self.report = results_of(done), report_of(done)
        self.plans = [self.plan(self.template), self.plan(done)]
        if not self.results or not self.report:
            sys.exit(f"{step}: no results without a fault")
        shutil.rmtree(done)

    def ok(self, folder, *words):
        ran, _ = self.bench.run(folder, ["fleet", *words])
        if ran is None or ran.returncode != 0:
            raise RuntimeError(f"fleet {' '.join(words)} ends with {ran and ran.returncode}: "
                               f"{ran and ran.stderr.decode()[:300]}")

    def plan_words(self):
        return ["plan", *self.later, "-o", "F", "--no-reports", *self.extra]

    def begin(self, folder):
        """What is there before the step."""
        self.ok(folder, "plan", *[str(self.logs / f"d{seed}.csv") for seed in range(2)], "-o", "F", "--no-reports")
        self.ok(folder, "run", "F")
        self.ok(folder, "merge", "F", "-o", "report")
        if self.step == "plan":
            return
        self.ok(folder, *self.plan_words())
        if self.step == "merge":
            self.ok(folder, "run", "F")

    def words(self):
        return ["fleet", *{
            "plan": self.plan_words(),
            "run": ["run", "F"],
            "stretches": ["run", "F"],
            "export": ["export", "F", "--to", "slurm"],
            "merge": ["merge", "F", "-o", "report", "--force"],
        }[self.step]]

    def to_the_end(self, folder):
        self.ok(folder, "run", "F")
        self.ok(folder, "merge", "F", "-o", "report", "--force")

    def plan(self, folder):
        """Names of units, in the plan's order; costs are measured and differ."""
        lines = (folder / "F" / "plan.jsonl").read_bytes().splitlines(keepends=True)
        head = json.loads(lines[0])
        if hashlib.sha256(b"".join(lines[1:])).hexdigest() != head["sha256"]:
            return None
        return [json.loads(line)["id"] for line in lines[1 + head["devices"]:]]

    def copy(self, tag):
        folder = self.bench.root / f"{self.step}.{tag}"
        shutil.copytree(self.template, folder)
        return folder

    def faults(self, kinds):
        for kind in kinds:
            count = self.counts.get(kind, 0)
            most = (6 if kind == "kill" else 1) if self.bench.quick else self.bench.heap if kind == "malloc" else count
            for place in spread(count, most):
                yield f"{kind}:{place}"
                if kind in CALLS:
                    yield f"{kind}:{place}+"

    def wrong(self, number, fault):
        folder = self.copy(str(number))
        try:
            ran, _ = self.bench.run(folder, self.words(), fault)
            if ran is None:
                return "hangs"
            if fault.startswith("kill"):
                said = "" if ran.returncode in (-9, 0) else f"exit {ran.returncode} although killed"
            else:
                said = self.wrong_words(ran, fault)
            return said or self.wrong_files(folder, fault, ran.returncode) or self.wrong_afterwards(folder)
        except RuntimeError as error:
            return str(error)
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def wrong_words(self, ran, fault):
        err = ran.stderr.decode(errors="replace")
        codes = {0, 3, 5, AGAIN} if self.words()[1] == "run" else CODES
        if fault.startswith("malloc"):
            codes = codes | {4}  # refused before the program knows its verb
        if ran.returncode not in codes or "internal error" in err or "terminate called" in err:
            return f"exit {ran.returncode}: {err.strip()[:300]}"
        mute = fault.startswith("write") and fault.endswith("+")  # nothing can be said where nothing can be written
        said = sum(": error " in line or " error " in line for line in err.splitlines())
        if ran.returncode != 0 and not mute and said != 1:
            return f"exit {ran.returncode} with {said} sentences: {err.strip()[:300]}"
        return ""

    def wrong_files(self, folder, fault, code):
        found = results_of(folder)
        odd = [name for name, content in found.items() if self.results.get(name) != content]
        if odd:
            return f"results that are no others': {odd}"
        units = {str(Path(name).parent) for name in found}
        cut = [name for name in self.results if str(Path(name).parent) in units and name not in found]
        if cut:
            return f"results without all of their files: {cut}"
        # What refuses to be removed stays, and so does what is begun where a worker is killed, or can look
        # into no folder any more.
        cannot_clean = fault.startswith(("kill", "unlink", "malloc")) or (fault.startswith("open")
                                                                          and fault.endswith("+"))
        if not cannot_clean and hidden(folder / "F"):
            return f"exit {code}, left behind: {hidden(folder / 'F')}"
        if self.plan(folder) not in self.plans:
            return "the plan is neither the old one nor the new one"
        if code == 0 and self.step == "plan" and self.plan(folder) != self.plans[1]:
            return "exit 0 and the old plan"
        report = {name: content for name, content in report_of(folder).items() if MARK not in name}
        journal = any(name.endswith(JOURNAL) for name in report)
        if not journal and report not in (self.old_report, self.report):
            return "the report is neither the old one nor the new one"
        return ""

    def wrong_afterwards(self, folder):
        self.ok(folder, *self.words()[1:])
        self.to_the_end(folder)
        if results_of(folder) != self.results:
            return "the results afterwards are others"
        return "" if report_of(folder) == self.report else "the report afterwards is another"


def results_of(folder):
    files = files_of(folder / "F" / "results") if (folder / "F" / "results").exists() else {}
    # Which file it was read from, and its time of change: of the logs, which all copies share.
    return {name: content for name, content in files.items() if not name.split("/")[1].startswith(".")}


def report_of(folder):
    return files_of(folder / "report")


def hidden(fleet):
    return sorted(str(p.relative_to(fleet)) for p in fleet.rglob("*") if p.name.startswith(".") or MARK in p.name)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("shim")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--step", action="append")
    parser.add_argument("--kind", action="append")
    parser.add_argument("--heap", type=int, default=300)
    options = parser.parse_args()
    bench = Bench(os.path.abspath(options.program), os.path.abspath(options.shim), options.heap, options.quick)
    kinds = options.kind or [*CALLS, "kill"]
    cases, bad = 0, 0
    try:
        for step in options.step or (["plan", "run", "merge"] if options.quick else STEPS):
            fleet = Fleet(bench, step)
            faults = list(fleet.faults(kinds))
            with ThreadPoolExecutor(os.cpu_count()) as pool:
                for fault, wrong in zip(faults, pool.map(lambda n: fleet.wrong(n, faults[n]), range(len(faults)))):
                    if wrong:
                        bad += 1
                        print(f"fleet {step}: LIBCHAR_FAULT={fault}: {wrong}", flush=True)
            cases += len(faults)
            print(f"fleet {step:10} {len(faults):6} faults and kills", flush=True)
    finally:
        shutil.rmtree(bench.root, ignore_errors=True)
    print(f"{cases} cases, {bad} wrong")
    sys.exit(1 if bad or not cases else 0)


if __name__ == "__main__":
    main()
