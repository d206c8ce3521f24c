#!/usr/bin/env python3
"""Two nodes that write into one folder: each program in a PID namespace of its own, on storage that is no local disk.

usage: two_nodes.py PROGRAM SHIM [--rounds N] [--seed S] [--storage NAME]

A round takes two writing verbs, a storage, sometimes an earlier set in the folder, and runs both at once, in half of
the rounds one of them killed. Afterwards the folder is what the runs that ended with 0 make of it one after the other,
in one of the two orders, with nothing beside; a run that was killed has its whole set or none. A run that does not end
with 0 says one error. Storages:
  slow     fsync, close and rename take up to 20 ms
  nfs      as slow, without files that have no name, and without locks on descriptors for reading
  smb      as nfs, without hard links
Where nothing can be locked the program says so and removes nothing. Exit 77 where no namespaces may be made.
"""

import argparse
import itertools
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from fault_loops import JOURNAL, LOCK, MARK, MODEL, finished, log_csv

STORAGES = {"slow": "slow", "nfs": "slow,nameless,readlocks", "smb": "slow,nameless,readlocks,links"}
NODE = ["unshare", "--pid", "--fork", "--mount-proc", "--kill-child"]

# What is written into the folder out, of the inputs beside it.
VERBS = {
    "characterize": ["characterize", "log.csv", "-o", "out", "--no-timing"],
    "characterize 2": ["characterize", "log2.csv", "-o", "out", "--no-timing"],
    "allan": ["allan", "log.csv", "-c", "c0", "-o", "out/b.csv"],
    "psd": ["psd", "log.csv", "-c", "c0", "-o", "out/report.html"],
    "fit": ["fit", "log.csv", "-o", "out/fit.txt"],
    "models": ["fit", "log2.csv", "--models", "out"],
    "convert": ["convert", "log.csv", "-o", "out/b.npy", "--order", "planar"],
    "convert raw": ["convert", "log.csv", "-o", "out/b.f64"],
    "convert raw 2": ["convert", "log2.csv", "-o", "out/b.f64"],
    "simulate": ["simulate", "a.sensor.yaml", "-o", "out/b.csv", "--duration", "5"],
    "model": ["model", "a.sensor.yaml", "--to", "sdf", "-o", "out/m.sdf"],
    "replay": ["replay", "array.csv", "--sensors", "c0,c1,c2", "--reference", "c3", "-o", "out", "--estimates", "csv",
               "--no-timing"],
    "fuse": ["fuse", "array.csv", "--with", "run", "-o", "out/fused.csv"],
    "plot": ["plot", "rep", "-o", "out/figure.svg", "--csv", "out/figure.csv", "--gnuplot", "out/figure.gp",
             "-c", "c0"],
}


def files_in(folder):
    return {p.name: p.read_bytes() for p in folder.iterdir() if p.is_file()} if folder.exists() else {}


def applied(state, files):
    """What a run makes of a folder that holds `state`: names of documents that it replaces are its to remove."""
    now = set(files)
    for name, text in files.items():
        if name.endswith(".json"):
            now |= set(named(text))
    stale = {old for name in files if name.endswith(".json") and name in state for old in named(state[name])} - now
    return {**{name: text for name, text in state.items() if name not in stale}, **files}


def named(text):
    try:
        names = json.loads(text).get("files", [])
    except (ValueError, AttributeError):
        return []
    return names if isinstance(names, list) else []


class Nodes:
    def __init__(self, program, shim):
        self.program, self.shim = os.path.abspath(program), os.path.abspath(shim)
        fast = Path("/dev/shm")
        self.root = Path(tempfile.mkdtemp(prefix="libchar-nodes-", dir=fast if os.access(fast, os.W_OK) else None))
        self.inputs = self.root / "inputs"
        self.inputs.mkdir()
        for name, text in {"log.csv": log_csv(1), "log2.csv": log_csv(2, 400, 3), "array.csv": log_csv(3, 600, 4),
                           "a.sensor.yaml": MODEL.format(0.001)}.items():
            (self.inputs / name).write_text(text)
        for words in (["characterize", "log.csv", "-o", "rep", "--no-timing"],
                      [*VERBS["replay"][:-4], "run", "--no-timing"]):
            words = [word.replace("out", "run") if word == "out" else word for word in words]
            subprocess.run([self.program, *words, "-q"], cwd=self.inputs, check=True, capture_output=True)
        self.sets = {name: self.alone(words) for name, words in VERBS.items()}

    def folder(self, tag):
        folder = self.root / tag
        shutil.copytree(self.inputs, folder)
        (folder / "out").mkdir()
        return folder

    def alone(self, words):
        folder = self.folder("alone")
        subprocess.run([self.program, *words, "--force"], cwd=folder, check=True, capture_output=True)
        made = files_in(folder / "out")
        shutil.rmtree(folder)
        return made

    def start(self, folder, words, storage, seed):
        environment = dict(os.environ, LD_PRELOAD=self.shim, LIBCHAR_STORAGE=storage, LIBCHAR_STORAGE_SEED=str(seed))
        return subprocess.Popen([*NODE, self.program, *words, "--force"], cwd=folder, env=environment,
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def round(self, number, seed, storages):
        """What is wrong, "" where nothing is, and what happened."""
        rng = random.Random(f"{seed} {number}")
        pairs = list(itertools.product(VERBS, VERBS))
        names = pairs[(number * 37 + seed) % len(pairs)]
        storage = rng.choice(storages)
        folder = self.folder(str(number))
        earlier = rng.choice([None, "characterize 2", "replay", "convert raw 2", "simulate"])
        for name, text in (self.sets[earlier] if earlier else {}).items():
            (folder / "out" / name).write_bytes(text)
        killed = rng.choice([None, None, 0, 1])
        runs = []
        for k, name in enumerate(names):
            runs.append(self.start(folder, VERBS[name], STORAGES[storage], rng.randrange(1 << 30)))
            time.sleep(rng.random() * 0.05)
        if killed is not None:
            time.sleep(rng.random() * 0.2)
            runs[killed].kill()
        ended = [(run.communicate(timeout=120), run.returncode) for run in runs]
        try:
            wrong = self.judge(folder / "out", earlier, names, ended, killed)
            if not wrong and killed is not None:
                wrong = self.next_run(folder, names[killed])
        finally:
            shutil.rmtree(folder)
        what = f"round {number}: {names[0]} | {names[1]} on {storage}, earlier {earlier}, killed {killed}"
        return f"{what}: {wrong}" if wrong else "", "killed" if killed is not None else "undisturbed"

    def judge(self, out, earlier, names, ended, killed):
        codes = [code for _, code in ended]
        for k, (streams, code) in enumerate(ended):
            text = streams[1].decode(errors="replace")
            if code not in (0, 5) and k != killed:
                return f"exit {code}: {text.strip()[:300]}"
            if code == 5 and text.count(" error ") != 1:
                return f"exit 5 with {text.strip()[:300]}"
            if code == 5 and "E0515" not in text:
                return f"fails: {text.strip()[:300]}"
        if killed is not None:
            finished(out)
        now = files_in(out)
        if killed is not None:
            now = {name: text for name, text in now.items() if MARK not in name and name != LOCK}
        must = [n for n, code in zip(names, codes) if code == 0]
        may = [names[killed]] if killed is not None and codes[killed] != 0 else []
        start = self.sets[earlier] if earlier else {}
        for order in [*itertools.permutations(must), *itertools.permutations(must + may)]:
            state = start
            for name in order:
                state = applied(state, self.sets[name])
            if state == now:
                return ""
        expected = applied(applied(start, self.sets[names[0]]), self.sets[names[1]])
        odd = sorted(n for n in set(now) | set(expected) if now.get(n) != expected.get(n))
        return f"exits {codes}, no order of the runs leaves this: {odd}, there: {sorted(now)}"

    def next_run(self, folder, name):
        """The next run ends well; where its set is a whole one nothing of it is missing."""
        ran = subprocess.run([self.program, *VERBS[name], "--force"], cwd=folder, capture_output=True)
        if ran.returncode != 0:
            return f"the next run ends with {ran.returncode}: {ran.stderr.decode()[:300]}"
        now = files_in(folder / "out")
        missing = [n for n, text in self.sets[name].items() if now.get(n) != text]
        left = [n for n in now if n in (LOCK, JOURNAL)]
        return f"the next run leaves {left}, lacks {missing}" if missing or left else ""

    def without_locks(self):
        """Where nothing can be locked: said, nothing of others removed, the set there."""
        folder = self.folder("unlocked")
        litter = folder / "out" / f"a.csv{MARK}999999999-0"
        litter.write_text("another's")
        run = self.start(folder, VERBS["characterize"], "locks,nameless", 1)
        _, err = run.communicate()
        now = files_in(folder / "out")
        wrong = ""
        if run.returncode != 0 or b"lock" not in err:
            wrong = f"without locks: exit {run.returncode}, says {err.decode().strip()[:300]}"
        elif now.pop(litter.name, None) is None or now != self.sets["characterize"]:
            wrong = f"without locks: there are {sorted(now)}"
        shutil.rmtree(folder)
        return wrong


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("shim")
    parser.add_argument("--rounds", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--storage", action="append", choices=STORAGES)
    options = parser.parse_args()
    if subprocess.run([*NODE, "true"], capture_output=True).returncode != 0:
        print("no PID namespaces may be made here")
        sys.exit(77)
    nodes = Nodes(options.program, options.shim)
    wrong, kinds = [nodes.without_locks()], Counter()
    try:
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            storages = options.storage or list(STORAGES)
            for said, kind in pool.map(lambda n: nodes.round(n, options.seed, storages), range(options.rounds)):
                wrong.append(said)
                kinds[kind] += 1
                if said:
                    print(said, flush=True)
    finally:
        shutil.rmtree(nodes.root, ignore_errors=True)
    if wrong[0]:
        print(wrong[0])
    bad = sum(map(bool, wrong))
    print(f"{options.rounds} rounds ({kinds['undisturbed']} undisturbed, {kinds['killed']} with a kill), "
          f"one without locks: {bad} wrong")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
