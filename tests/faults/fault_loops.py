#!/usr/bin/env python3
"""Every verb, with every call that can fail failing: once and for ever, one place after the other; and killed
before every change of the disk.

usage: fault_loops.py PROGRAM SHIM [--quick] [--verb NAME]… [--kind NAME]… [--heap N] [--list]

A verb runs over the results of an earlier run, with other inputs. After each fault: an exit code that
docs/errors.md knows, one sentence, the old files or the new ones and no others. After each kill: the old
files, the new ones, or a journal that makes the new ones of what is there; and the next run ends well and
leaves nothing else. Prints counts per verb and the commands of what is wrong; exit 1 where something is.

A log that shrinks or grows under the reader, limits of a file's size and of the address space, and a disk
that is full (where tmpfs may be mounted) are tried as well.

  --quick   a few places of each kind in four verbs, as ctest runs it
  --heap N  places in which memory is refused, of the hundreds of thousands there are (default: 600 a verb)
"""

import argparse
import json
import math
import os
import random
import resource
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

KINDS = ["write", "open", "read", "fsync", "rename", "link", "close", "stat", "mmap", "unlink", "mkdir", "malloc",
         "thread", "kill", "shrink", "grow", "fsize",
         "space", "address"]
CALLS = KINDS[:13]
CODES = {0, 2, 3, 4, 5}
JOURNAL = ".libchar-outputs.json"
MARK = ".libchar-tmp-"
LOCK = ".libchar-lock"

MODEL = ("format: sensor-model\nversion: 1\nchannel: gyro\nunit: rad/s\ndensity: two-sided\nrate_hz: 100\n"
         "white_noise: {{value: {}}}\n")
SCENE = """format: scene
version: 1
name: {}
simulate:
  rate_hz: 100
  samples: 600
  truth: {{name: level, kind: sine, amplitude: 2, frequency_hz: 0.5}}
sensors:
  - {{name: a, model: {{unit: m, white_noise: {{value: 0.01}}, density: two-sided}}}}
  - {{name: b, model: {{unit: m, white_noise: {{value: 0.02}}, density: two-sided}}}}
  - {{name: c, model: {{unit: m, white_noise: {{value: 0.03}}, density: two-sided}}}}
learning: [0, 2]
"""


def log_csv(seed, rows=400, columns=2):
    rng = random.Random(seed)
    names = ",".join(f"c{k}" for k in range(columns))
    lines = [f"t[s],{names}"]
    for k in range(rows):
        lines.append(f"{k / 100}," + ",".join(f"{rng.gauss(0, 1):.6f}" for _ in range(columns)))
    return "\n".join(lines) + "\n"


def inputs(seed):
    """What all verbs read; other numbers for another seed."""
    return {
        "log.csv": log_csv(seed),
        "array.csv": log_csv(seed + 1, 600, 4),
        "a.sensor.yaml": MODEL.format(0.001 * (1 + seed)),
        "s.scene.yaml": SCENE.format("old" if seed == 1 else "new"),
    }


# Name: words; "PREPARE" words run once before, without faults. What a verb writes is below out/ or in out.*;
# where that is a file and a folder, they are two sets, whole each.
VERBS = {
    "inspect": {"words": ["inspect", "log.csv", "--json"]},
    "allan": {"words": ["allan", "log.csv", "-c", "c0", "-o", "out.csv", "--force"]},
    "psd": {"words": ["psd", "log.csv", "-c", "c0", "-o", "out.csv", "--force"]},
    "fit": {"sets": True, "words": ["fit", "log.csv", "--models", "out", "-o", "out.txt", "--force"]},
    "characterize": {"words": ["characterize", "log.csv", "-o", "out", "--no-timing", "--force"]},
    "model": {"words": ["model", "a.sensor.yaml", "--to", "sdf", "-o", "out.sdf", "--force"]},
    "simulate": {"words": ["simulate", "a.sensor.yaml", "-o", "out.csv", "--duration", "5", "--force"]},
    "simulate raw": {"words": ["simulate", "a.sensor.yaml", "-o", "out.f64", "--duration", "5", "--force"]},
    "convert npy": {"words": ["convert", "log.csv", "-o", "out.npy", "--order", "planar", "--force"]},
    "convert raw": {"words": ["convert", "log.csv", "-o", "out.f64", "--force"]},
    "replay": {"words": ["replay", "s.scene.yaml", "-o", "out", "--estimates", "csv", "--no-timing", "--force"]},
    "replay log": {"sets": True, "words": ["replay", "array.csv", "--sensors", "c0,c1,c2", "--reference", "c3",
                                           "--write-scene", "out.scene.yaml", "-o", "out",
                             "--no-timing", "--force"]},
    "fuse": {"prepare": ["replay", "array.csv", "--sensors", "c0,c1,c2", "--reference", "c3", "-o", "run",
                         "--no-timing"],
             "words": ["fuse", "array.csv", "--with", "run", "-o", "out.csv", "--force"]},
    "plot": {"prepare": ["characterize", "log.csv", "-o", "run", "--no-timing"],
             "words": ["plot", "run", "-c", "c0", "-o", "out.svg", "--csv", "out.csv", "--gnuplot", "out.gp",
                       "--force"]},
    "compare": {"prepare": ["characterize", "log.csv", "-o", "run"], "words": ["compare", "run", "run", "--json"]},
}


QUICK = ["characterize", "simulate raw", "convert npy", "replay", "plot"]


class Bench:
    def __init__(self, program, shim, heap, quick):
        self.program, self.shim, self.heap, self.quick = program, shim, heap, quick
        fast = Path("/dev/shm")
        self.root = Path(tempfile.mkdtemp(prefix="libchar-faults-", dir=fast if os.access(fast, os.W_OK) else None))
        self.may_mount = self.try_mount()

    def least_address_space(self):
        """Bytes below which the program is not even loaded (to 1 MiB): what is refused there is the loader's word."""
        few, enough = 1 << 20, 4 << 30
        while enough - few > 1 << 20:
            middle = (few + enough) // 2
            loads = subprocess.run([self.program, "--version"], capture_output=True,
                                   env=dict(os.environ, LD_PRELOAD=str(self.shim)),
                                   preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS,
                                                                         (middle, middle))).returncode == 0
            few, enough = (few, middle) if loads else (middle, enough)
        return enough

    def try_mount(self):
        """Only an administrator may make small disks, and not in every container."""
        folder = self.root / "disk"
        folder.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "libchar-faults", folder],
                          capture_output=True).returncode != 0:
            return False
        return subprocess.run(["umount", folder], capture_output=True).returncode == 0

    def run(self, folder, words, fault=""):
        log = Path(str(folder) + ".count")
        environment = dict(os.environ, LIBCHAR_FAULT=fault, LIBCHAR_FAULT_LOG=str(log), LD_PRELOAD=str(self.shim),
                           LIBCHAR_FAULT_FILE=next((word for word in words if word in inputs(1)), ""))
        limited = {"fsize": resource.RLIMIT_FSIZE, "address": resource.RLIMIT_AS}.get(fault.split(":")[0])
        size = int(fault.split(":")[1]) if limited is not None else 0
        limit = None if limited is None else lambda: resource.setrlimit(limited, (size, size))
        try:
            ran = subprocess.run([self.program, *words], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                                 capture_output=True, timeout=60,
                                 preexec_fn=limit)
        except subprocess.TimeoutExpired:
            return None, {}
        counts = {}
        if log.exists():
            rows = [line.split() for line in log.read_text().splitlines()]
            counts = {row[0]: int(row[1]) for row in rows if len(row) == 2}
            log.unlink()
        return ran, counts


def files_of(folder):
    """What is there apart from inputs and the lock of a folder: name → bytes."""
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()
            and p.name not in inputs(1) and p.name != LOCK}


def sets_of(files):
    """A set is what one folder holds: out.txt beside out/a, out/b are two."""
    return {str(Path(name).parent) for name in files}


def part(files, folder):
    return {name: text for name, text in files.items() if str(Path(name).parent) == folder}


def finished(folder):
    """A copy of the files in which a journal has been done by hand: what the next run has to make of them."""
    for journal in folder.rglob(JOURNAL):
        order = json.loads(journal.read_text())
        for source, target, *_ in order["rename"]:
            if (journal.parent / source).exists():
                (journal.parent / source).rename(journal.parent / target)
        for name in order["remove"]:
            (journal.parent / name).unlink(missing_ok=True)
        journal.unlink()


def spread(count, most):
    """So many of the numbers from 1 to count: each once at either end, where a run begins and its files get their
    names, then in growing steps to the middle."""
    if count <= most:
        return list(range(1, count + 1))
    half = max(1, most // 3)
    step = math.log(count) / half
    begin = {min(count, max(1, round(math.exp(step * k)))) for k in range(half + 1)}
    return sorted(begin | {count + 1 - k for k in begin} | {max(1, count * k // most) for k in range(1, half)})


class Verb:
    def __init__(self, bench, name):
        self.bench, self.name, self.words = bench, name, VERBS[name]["words"]
        self.template = bench.root / name.replace(" ", "-")
        self.template.mkdir()
        self.put(self.template, 1)
        self.checked(self.template, VERBS[name].get("prepare"))
        self.checked(self.template, self.words)
        self.put(self.template, 2)
        if VERBS[name].get("prepare"):
            self.checked(self.template, VERBS[name]["prepare"] + ["--force"])
        self.old = files_of(self.template)
        done = self.copy("new")
        ran, self.counts = bench.run(done, self.words)
        self.out, self.new = ran.stdout, files_of(done)
        writes = any(word in ("-o", "--models") for word in self.words)
        if ran.returncode != 0 or (writes and self.new == self.old):
            sys.exit(f"{name}: does not run without a fault:\n{ran.stderr.decode()}")
        shutil.rmtree(done)

    def put(self, folder, seed):
        for name, text in inputs(seed).items():
            (folder / name).write_text(text)

    def checked(self, folder, words):
        if words is None:
            return
        ran, _ = self.bench.run(folder, words)
        if ran.returncode != 0:
            sys.exit(f"{self.name}: {' '.join(words)} fails without a fault:\n{ran.stderr.decode()}")

    def copy(self, tag):
        folder = self.bench.root / f"{self.template.name}.{tag}"
        shutil.copytree(self.template, folder)
        return folder

    def copy_on_small_disk(self, number, pages):
        """A file system of its own with the earlier results, and so many pages of 4096 bytes left."""
        folder = self.bench.root / f"{self.template.name}.{number}"
        folder.mkdir()
        subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64m", "libchar-faults", folder], check=True)
        shutil.copytree(self.template, folder, dirs_exist_ok=True)
        used = os.statvfs(folder)
        size = 4096 * (used.f_blocks - used.f_bfree + pages) * (used.f_frsize // 4096)
        subprocess.run(["mount", "-o", f"remount,size={size}", folder], check=True)
        return folder

    def places(self, kind):
        if kind in ("fsize", "space", "address"):
            return self.sizes(kind)
        count = self.counts.get(kind, 0)
        most = 1 if self.bench.quick else self.bench.heap if kind == "malloc" else count
        if self.bench.quick and kind in ("kill", "malloc"):
            most = 6
        return spread(count, most)

    def sizes(self, kind):
        """Bytes a file or the address space may have, or pages that a full disk has left: from nothing to
        more than enough."""
        if kind == "space" and (not self.bench.may_mount or self.name in ("inspect", "compare")):
            return []
        if kind == "address":
            # Stacks of threads take 8 MiB each: 160 MiB more than what is loaded is enough for every verb here.
            loaded = self.bench.least_address_space()
            return [loaded + (160 << 20) * k // (8 if self.bench.quick else 80)
                    for k in range(9 if self.bench.quick else 81)]
        largest = max((len(text) for text in self.new.values()), default=1000)
        if kind == "space":
            pages = sum(2 + len(text) // 4096 for text in self.new.values()) + 4
            return sorted({round(pages * k / 8) for k in range(9)} if self.bench.quick else set(range(pages + 1)))
        return sorted({0, 1, 100, 5000, largest // 2, largest - 1, largest})

    def faults(self, kinds):
        for kind in kinds:
            for place in self.places(kind):
                yield kind, f"{kind}:{place}"
                if kind in CALLS:
                    yield kind, f"{kind}:{place}+"

    def wrong(self, number, kind, fault):
        """What is wrong after this fault: "" where nothing is; and what stands there."""
        small = kind == "space"
        folder = self.copy_on_small_disk(number, int(fault.split(":")[1])) if small else self.copy(str(number))
        try:
            ran, counts = self.bench.run(folder, self.words, fault)
            if ran is None:
                return "hangs", "hangs"
            return self.after_kill(folder, ran) if kind == "kill" else self.after_fault(folder, ran, kind, fault)
        finally:
            if kind == "space":
                subprocess.run(["umount", "-l", folder], check=True)
            shutil.rmtree(folder, ignore_errors=True)

    def sets_are_whole(self, now):
        sets = sets_of(self.old | self.new | now)
        return VERBS[self.name].get("sets") and all(part(now, s) in (part(self.old, s), part(self.new, s))
                                                    for s in sets)

    def state(self, folder):
        now = files_of(folder)
        if now == self.new:
            return "new"
        if now == self.old:
            return "old"
        if self.sets_are_whole(now):
            return "old and new sets"
        if any(name.endswith(JOURNAL) for name in now):
            finished(folder)
            now = files_of(folder)
            now = {name: text for name, text in now.items() if MARK not in name}
            if now == self.new or self.sets_are_whole(now):
                return "to be finished"
        odd = sorted(n for n in now if now[n] not in (self.old.get(n), self.new.get(n)))
        return "mixed: " + ", ".join(odd or [n for n in set(self.old) ^ set(self.new) if n in now]
                                     or sorted(set(now) ^ set(self.new)) or ["old and new"])

    def after_fault(self, folder, ran, kind, fault):
        err = ran.stderr.decode(errors="replace")
        lines = [line for line in err.splitlines() if line]
        # Where it cannot be removed, or nobody can know whose it is, the lock stays; the next run takes it.
        left = kind not in ("unlink", "stat") and any(folder.rglob(LOCK))
        state = f"mixed: {LOCK}" if left else self.state(folder)
        if ran.returncode < 0 or ran.returncode not in CODES:
            return f"exit {ran.returncode}: {err.strip()[:200]}", state
        if "internal error" in err or "terminate called" in err:
            return err.strip()[:200], state
        if state.startswith("mixed") and kind not in ("shrink", "grow"):
            return f"exit {ran.returncode}, {state}; {err.strip()[:200]}", state
        if kind in ("shrink", "grow"):
            # Other input, other numbers: what is asked is that the run ends well or with a sentence, and
            # leaves no other names.
            names, allowed = set(files_of(folder)), (set(self.old), set(self.new))
            if names not in allowed:
                return f"exit {ran.returncode}, names {sorted(names)}", "other names"
            said = sum(" error " in line or ": error" in line for line in lines) == (ran.returncode != 0)
            return "" if said else f"exit {ran.returncode}: {err.strip()[:200]}", "ended"
        if ran.returncode == 0:
            if state != "new" and self.new != self.old:
                return f"exit 0 and {state}", state
            return ("other text on stdout" if ran.stdout != self.out else ""), state
        # Nothing can be said where nothing can be written.
        mute = kind == "write" and fault.endswith("+")
        if not mute and sum(" error " in line or ": error" in line for line in lines) != 1:
            return f"exit {ran.returncode} with {len(lines)} lines: {err.strip()[:200]}", state
        return "", state

    def after_kill(self, folder, ran):
        if ran.returncode not in (-9, 0):
            return f"exit {ran.returncode} although killed", "?"
        again = Path(str(folder) + ".again")
        shutil.copytree(folder, again)
        try:
            state = self.state_but_litter(folder)
            if state.startswith("mixed"):
                return state, state
            next_run, _ = self.bench.run(again, self.words)
            if next_run is None or next_run.returncode != 0:
                ended = f"{next_run and next_run.returncode}: {next_run and next_run.stderr.decode()[:200]}"
                return f"the next run ends with {ended}", state
            after = f"mixed: {LOCK}" if any(again.rglob(LOCK)) else self.state(again)
            if after != "new" and self.new != self.old:
                return f"the next run leaves {after}: {sorted(set(files_of(again)) - set(self.new))}", state
            return "", state
        finally:
            shutil.rmtree(again, ignore_errors=True)

    def state_but_litter(self, folder):
        """A killed run may leave temporary files beside the old set: the next run removes them."""
        if not any(folder.rglob(JOURNAL)):
            for litter in list(folder.rglob("*" + MARK + "*")):
                litter.unlink()
        return self.state(folder)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("shim")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--verb", action="append")
    parser.add_argument("--kind", action="append")
    parser.add_argument("--heap", type=int, default=600)
    parser.add_argument("--list", action="store_true")
    options = parser.parse_args()
    bench = Bench(os.path.abspath(options.program), os.path.abspath(options.shim), options.heap, options.quick)
    cases, bad = 0, 0
    try:
        for name in options.verb or (QUICK if options.quick else VERBS):
            verb = Verb(bench, name)
            faults = list(verb.faults(options.kind or KINDS))
            if options.list:
                print(name, verb.counts)
                continue
            states = {}
            with ThreadPoolExecutor(os.cpu_count()) as pool:
                for (kind, fault), (wrong, state) in zip(faults, pool.map(lambda n: verb.wrong(n, *faults[n]),
                                                                          range(len(faults)))):
                    states[state.split(":")[0]] = states.get(state.split(":")[0], 0) + 1
                    if wrong:
                        bad += 1
                        print(f"{name}: LIBCHAR_FAULT={fault}: {wrong}")
            cases += len(faults)
            print(f"{name:14} {len(faults):6} faults and kills: "
                  + ", ".join(f"{count} {state}" for state, count in sorted(states.items())), flush=True)
    finally:
        shutil.rmtree(bench.root, ignore_errors=True)
    print(f"{cases} cases, {bad} wrong")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
