#!/usr/bin/env python3
"""Every file of a fleet with a bit turned or its end cut off, through the program: damaged_files.py PROGRAM
[--step 37] [--end 40]

A fleet of three small logs and one in stretches is planned and run. Then records, partial states, log.seen,
tasks, plan and manifests are damaged, one at a time, at every STEP-th byte and cut there. Right is
  record, state, log.seen   `status` counts that unit as missing and no other; `run` and `merge` end in the
  report of the fleet without damage
  plan                      refused in one sentence (E0784; of its first line, what is wrong there)
  task                      exit 0, 3 or 75 in at most one sentence, and no result is there that is not one of
                            the fleet's
  manifest                  planned, or refused in one sentence
and no report of a sanitizer. `run` and `merge` follow at every END-th damage (they take most of the time).
"""
import argparse
import json
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "faults"))
from fault_loops import log_csv  # noqa: E402
from fleet_faults import npy  # noqa: E402

SAID = re.compile(r": error E\d{4}: ")
YAML = """format: fleet-manifest
version: 1
defaults: {type: gyro, batch: "2026-11", temperature_c: 21.5}
devices:
  - {device: A, log: d0.csv, temperature_c: 25}
  - {device: B, log: d1.csv, batch: other}
  - {device: C, log: d2.csv, options: {reading: {rate_hz: 100}}}
"""
TABLE = "device,log,type,batch,temperature_c\nA,d0.csv,gyro,b1,25\nB,d1.csv,gyro,b2,\n\"C, c\",d2.csv,gyro,,21.5\n"


class Trial:
    def __init__(self, program, folder, step, end):
        self.program, self.folder, self.step, self.end = program, folder, step, end
        self.fleet = folder / "fleet"
        for seed in range(3):
            (folder / f"d{seed}.csv").write_text(log_csv(seed))
        (folder / "long.npy").write_bytes(npy(9, 2 << 20))
        (folder / "m.yaml").write_text(YAML)
        (folder / "m.csv").write_text(TABLE)
        logs = [*(str(folder / f"d{seed}.csv") for seed in range(3)), str(folder / "long.npy")]
        self.checked("plan", *logs, "--rate", "100", "--split-above", "1MiB", "--stretch", "4MiB", "-o",
                     str(self.fleet), "--no-reports")
        self.checked("run", str(self.fleet))
        self.report = self.merged(self.fleet)
        self.units = {}
        for task in sorted((self.fleet / "tasks").glob("*.json")):
            unit = json.loads(task.read_text())
            self.units[unit["id"]] = (task.name, unit["kind"])
        self.results = self.results_of(self.fleet)

    def call(self, *words):
        return subprocess.run([self.program, "fleet", *words, "--quiet"], capture_output=True,
                              stdin=subprocess.DEVNULL, timeout=300)

    def checked(self, *words):
        ran = self.call(*words)
        if ran.returncode != 0:
            raise RuntimeError(f"fleet {' '.join(words)}: exit {ran.returncode}: "
                               f"{ran.stderr.decode(errors='replace')[:500]}")
        return ran

    def merged(self, fleet):
        """The tables of the lot: pages hold the path."""
        out = fleet.parent / (fleet.name + "-report")
        self.checked("merge", str(fleet), "-o", str(out))
        report = {name: (out / name).read_bytes() for name in ("coefficients.csv", "coefficients.npz")}
        shutil.rmtree(out)
        return report

    @staticmethod
    def results_of(fleet):
        paths = (p.relative_to(fleet) for p in sorted((fleet / "results").rglob("*")) if p.is_file())
        return {str(p): (fleet / p).read_bytes() for p in paths if not any(part.startswith(".") for part in p.parts)}

    def cases(self):
        """(number, what, file below the fleet or beside it, place, cut)."""
        of_kind = {}
        for unit, (task, kind) in self.units.items():
            of_kind.setdefault(kind, (unit, task))
        result = lambda kind: f"results/{of_kind[kind][0][:2]}/{of_kind[kind][0]}"
        files = [("record", f"{result('log')}/device.record"), ("record", f"{result('join')}/device.record"),
                 ("state", f"{result('stretch')}/state-1.bin"),
                 ("seen", f"{result('stretch')}/log.seen"), ("plan", "plan.jsonl"),
                 ("task", f"tasks/{of_kind['log'][1]}"),
                 ("task", f"tasks/{of_kind['stretch'][1]}"), ("task", f"tasks/{of_kind['join'][1]}"),
                 ("manifest", "../m.yaml"), ("manifest", "../m.csv")]
        number = 0
        for what, name in files:
            size = (self.fleet / name).stat().st_size
            step = max(self.step, size // 400)
            for place in range(0, size, step):
                for cut in (False, True):
                    yield number, what, name, place, cut
                    number += 1

    def wrong(self, case):
        number, what, name, place, cut = case
        copy = self.folder / f"copy-{number}"
        try:
            return self.wrong_in(copy, *case)
        except (RuntimeError, subprocess.TimeoutExpired) as error:
            return str(error)
        finally:
            shutil.rmtree(copy, ignore_errors=True)

    def wrong_in(self, copy, number, what, name, place, cut):
        data = bytearray((self.fleet / name).read_bytes())
        if cut:
            del data[place:]
        else:
            data[place] ^= 1 << random.Random(number).randrange(8)
        if what == "manifest":
            copy.mkdir()
            for seed in range(3):
                shutil.copy(self.folder / f"d{seed}.csv", copy)
            (copy / pathlib.Path(name).name).write_bytes(data)
            return self.wrong_answer(self.call("plan", str(copy / pathlib.Path(name).name), "-o", str(copy / "F")),
                                     {0, 2, 3})
        shutil.copytree(self.fleet, copy)
        (copy / name).write_bytes(data)
        if what == "plan":
            ran = self.call("status", str(copy))
            head = place <= (self.fleet / name).read_bytes().index(b"\n")
            return self.wrong_answer(ran, {3}) or ("" if head or b"E0784" in ran.stderr
                                                   else ran.stderr.decode(errors="replace"))
        return self.wrong_task(copy, name) if what == "task" else self.wrong_result(copy, number, what, name)

    @staticmethod
    def wrong_answer(ran, codes):
        said = ran.stderr.decode(errors="replace")
        if "Sanitizer" in said or "runtime error" in said:
            return "a sanitizer's report:\n" + said[:3000]
        if ran.returncode not in codes:
            return f"exit {ran.returncode}: {said[:500]}"
        lines = [line for line in said.splitlines() if SAID.search(line)]
        if len(lines) == (ran.returncode != 0):
            return ""
        return f"exit {ran.returncode} with {len(lines)} sentences: {said[:500]}"

    def wrong_task(self, copy, name):
        # Its own result is gone, so that there is something to do.
        unit = next(unit for unit, (task, _) in self.units.items() if f"tasks/{task}" == name)
        shutil.rmtree(copy / "results" / unit[:2] / unit)
        said = self.wrong_answer(self.call("run", str(copy / name)), {0, 3, 75})
        found = self.results_of(copy)
        odd = [path for path in found if found[path] != self.results.get(path)]
        return said or (f"results that are no others': {odd}" if odd else "")

    def wrong_result(self, copy, number, what, name):
        unit = pathlib.Path(name).parent.name
        if what in ("state", "seen"):
            join = next(unit for unit, (_, kind) in self.units.items() if kind == "join")
            shutil.rmtree(copy / "results" / join[:2] / join)
        ran = self.call("status", str(copy), "--json")
        said = self.wrong_answer(ran, {0})
        if said:
            return said
        status = json.loads(ran.stdout)
        missing = {pathlib.Path(one["task"]).name for one in status["missing"]}
        expected = {self.units[unit][0]} | ({self.units[join][0]} if what in ("state", "seen") else set())
        # Without its record a join is to be done again, and its stretches are looked at again.
        if missing != expected:
            return f"missing are {missing} instead of {expected}"
        if what != "seen" and len(status["damaged"]) != 1:
            return f"damaged: {status['damaged']}"
        if number % self.end != 0:
            return ""
        said = self.wrong_answer(self.call("merge", str(copy), "-o", str(copy / "report")), {3})
        if said:
            return said
        self.checked("run", str(copy))
        if self.results_of(copy) != self.results:
            return "results afterwards are others"
        return "" if self.merged(copy) == self.report else "the report afterwards is another"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=lambda path: str(pathlib.Path(path).resolve()))
    parser.add_argument("--step", type=int, default=37)
    parser.add_argument("--end", type=int, default=40)
    options = parser.parse_args()
    counts, bad = {}, 0
    with tempfile.TemporaryDirectory(prefix="libchar-damaged-") as folder, ThreadPoolExecutor(2) as workers:
        trial = Trial(options.program, pathlib.Path(folder), options.step, options.end)
        cases = list(trial.cases())
        for case, wrong in zip(cases, workers.map(trial.wrong, cases)):
            counts[case[1]] = counts.get(case[1], 0) + 1
            if wrong:
                bad += 1
                print(f"{case[1]} {case[2]} {'cut at' if case[4] else 'a bit turned in'} {case[3]}: {wrong}",
                      flush=True)
    print(", ".join(f"{count} of {what}" for what, count in counts.items())
          + f": {sum(counts.values())} damaged files, {bad} wrong")
    sys.exit(1 if bad or not counts else 0)


if __name__ == "__main__":
    main()
