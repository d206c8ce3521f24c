"""Runs every verb of two builds on every fixture and shipped scene and compares what they print, write and return.

usage: compare_builds.py OLD [NEW] [--python OLD_DIR NEW_DIR] [--keep DIR] [--quick] [--only EXPRESSION]
       [--listed FILE] [--lines N]
OLD is a program, or the folder of an earlier --keep: outputs that are compared as they were, without the
program. --keep DIR writes the outputs of OLD into that folder; without NEW that is all. --python has a folder
for each program given, that of its module (PYTHONPATH). Both sides run in folders that look alike; masks
(builds/masks.py) take out what is measured or names the build. Prints the differing lines of each run. FILE
lists differences that are meant, one per line: `PATTERN<tab>reason`; PATTERN is a regular expression searched
in "RUN: FILE: -old line / +new line". Exit code 1: a difference is not listed. --quick leaves out replays of
whole scenes.
"""
import argparse
import difflib
import json
import os
import pathlib
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import zipfile
import zlib

from builds.masks import NUMBER, masked
from builds.runs import FILES, Run, all_runs

root = pathlib.Path(__file__).resolve().parent.parent
CASES = root / "tests/builds/python_cases.py"
LAST_DIGITS = 2e-13  # the probability of a chi-square far out in its tail has chi2/2 times the rounding of chi2
LONG = 4000  # lines: longer texts are compared line by line, as a search for what moved takes the square of that
MOST_SECONDS = 900


class Kept:
    """Outputs of one program in a file: texts by run, masked with today's masks and again with those of the
    day they are read."""

    def __init__(self, folder, new=False):
        folder = pathlib.Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / "outputs.sqlite"
        if new:
            path.unlink(missing_ok=True)
        elif not path.exists():
            sys.exit(f"compare_builds.py: {folder} is no program, and no folder of outputs that were kept")
        self.base = sqlite3.connect(path)
        self.base.execute("CREATE TABLE IF NOT EXISTS outputs (run TEXT PRIMARY KEY, words TEXT, found BLOB)")

    def write(self, run, found):
        row = run.name, json.dumps(run.words), zlib.compress(json.dumps(found).encode())
        self.base.execute("INSERT OR REPLACE INTO outputs VALUES (?, ?, ?)", row)
        self.base.commit()

    def run(self, run):
        """None: that run was not kept, or it was of other words."""
        row = self.base.execute("SELECT words, found FROM outputs WHERE run = ?", (run.name,)).fetchone()
        if not row or json.loads(row[0]) != run.words:
            return None
        found = json.loads(zlib.decompress(row[1]))
        return {part: text if part == "exit code" else masked(text, run) for part, text in found.items()}


def contents(path):
    """Bytes of a file; of an archive of arrays those of its members, texts in it in a byte per letter."""
    if path.suffix != ".npz":
        return path.read_bytes()
    with zipfile.ZipFile(path) as archive:
        return b"".join(f"\n{name}: ".encode() + archive.read(name).replace(b"\0\0\0", b"")
                        for name in archive.namelist())


class Side:
    """One program with a folder in which relative paths are the same as on the other side."""

    def __init__(self, program, module, work):
        self.folder = work / "main"
        self.folder.mkdir(parents=True)
        shutil.copytree(root / "fixtures", self.folder / "fixtures")
        if (root.parent / "shared").is_dir():
            (work / "shared").symlink_to(root.parent / "shared")
        for name, text in FILES.items():
            (self.folder / name).write_text(text)
        (self.folder / "bin").mkdir()
        (self.folder / "bin/sensorchar").symlink_to(os.path.abspath(program))
        quiet = {key: value for key, value in os.environ.items() if key not in ("COLUMNS", "NO_COLOR", "PYTHONPATH")}
        self.environment = quiet | {"LC_ALL": "C.UTF-8", "PYTHONPATH": os.path.abspath(module) if module else ""}
        self.units = {}
        self.seen = self.stamps()

    def stamps(self):
        return {p: p.stat().st_mtime_ns for p in self.folder.rglob("*") if p.is_file()}

    def plain(self, text):
        """Without the folder's own path, units of fleets by number: their names are digests of settings and version."""
        text = text.replace(str(self.folder), "FOLDER")
        for name, number in self.units.items():
            text = text.replace(name, number).replace(f"{name[:2]}/{name[2:]}", number)
        return text

    def learn_units(self):
        for plan in sorted(self.folder.glob("*/plan.jsonl")):
            for name in re.findall(r'"(?:id|unit)": *"([0-9a-f]{16,64})"', plan.read_text()):
                self.units.setdefault(name, f"UNIT{len(self.units)}")

    def run(self, run):
        command = [sys.executable, CASES, run.words[1]] if run.words[0] == "python" else ["bin/sensorchar", *run.words]
        try:
            ran = subprocess.run(command, cwd=self.folder, capture_output=True, stdin=subprocess.DEVNULL,
                                 env=self.environment,
                                 timeout=MOST_SECONDS)
        except subprocess.TimeoutExpired:
            return {"exit code": f"none after {MOST_SECONDS} s"}
        if run.words[:2] == ["fleet", "plan"]:
            self.learn_units()

        def text_of(data):
            return masked(self.plain(data.decode("utf-8", "surrogateescape")), run)

        found = {"exit code": str(ran.returncode), "stdout": text_of(ran.stdout), "stderr": text_of(ran.stderr)}
        now = self.stamps()
        for path in sorted(now):
            if self.seen.get(path) != now[path]:
                found[self.plain(path.relative_to(self.folder).as_posix())] = text_of(contents(path))
        self.seen = now
        return found


def differs_in_last_digits(a, b):
    """The same text but for numbers, and these are equal to LAST_DIGITS of their size."""
    if NUMBER.sub("#", a) != NUMBER.sub("#", b):
        return False
    pairs = zip(NUMBER.findall(a), NUMBER.findall(b))
    return all(x == y or abs(float(x) - float(y)) <= LAST_DIGITS * max(abs(float(x)), abs(float(y))) for x, y in pairs)


def around(line, other, width=300):
    """The part of a long line that differs."""
    if len(line) <= width:
        return line
    at = next((k for k, (x, y) in enumerate(zip(line, other)) if x != y), min(len(line), len(other)))
    begin = max(0, min(at - 80, len(line) - width))
    return ("…" if begin else "") + line[begin:begin + width]


def opcodes(a, b):
    if max(len(a), len(b)) <= LONG:
        return difflib.SequenceMatcher(None, a, b, autojunk=False).get_opcodes()
    same = min(len(a), len(b))
    return [("replace", k, k + 1, k, k + 1) for k in range(same)
            if a[k] != b[k]] + [("replace", same, len(a), same, len(b))]


def different_lines(a, b):
    for kind, a_from, a_to, b_from, b_to in opcodes(a, b):
        if kind == "equal":
            continue
        if a_to - a_from != b_to - b_from:
            yield from (("-", line[:300]) for line in a[a_from:a_to])
            yield from (("+", line[:300]) for line in b[b_from:b_to])
            continue
        for old, new in zip(a[a_from:a_to], b[b_from:b_to]):
            if differs_in_last_digits(old, new):
                yield "~", "last digits of numbers"
            else:
                yield "-", around(old, new)
                yield "+", around(new, old)


def differences(a, b):
    for part in sorted(set(a) | set(b)):
        if part not in a or part not in b:
            yield part, "-" if part in a else "+", "file only in one"
        elif a[part] != b[part] and differs_in_last_digits(a[part], b[part]):
            yield part, "~", "last digits of numbers"
        elif a[part] != b[part]:
            yield from ((part, sign, line)
                        for sign, line in different_lines(a[part].splitlines(), b[part].splitlines()))


class Listed:
    """Differences that are meant, and how many lines each met."""

    def __init__(self, path):
        self.rows = []
        for line in pathlib.Path(path).read_text().splitlines() if path else []:
            if line and not line.startswith("#"):
                pattern, _, reason = line.partition("\t")
                self.rows.append([re.compile(pattern), reason, 0])

    def holds(self, text):
        match = next((row for row in self.rows if row[0].search(text)), None)
        if match:
            match[2] += 1
        return match is not None


def wanted_runs(options, with_module):
    for run in all_runs(root, options.quick):
        if re.search(options.only, run.name):
            yield run
    if with_module:
        cases = subprocess.run([sys.executable, CASES], capture_output=True, text=True, check=True).stdout.split()
        yield from (Run(f"python {case}", ["python", case]) for case in cases
                    if re.search(options.only, f"python {case}"))


def report(run, strange, most):
    print(f"DIFFERS {run.name} ({len(strange)} lines): {' '.join(run.words)}")
    for text in strange[:most or None]:
        print("   ", text)
    sys.stdout.flush()


def compare(options, old, new, kept, listed):
    count = same = others = missing = 0
    for run in wanted_runs(options, bool(options.python)):
        before = old.run(run)
        if kept:
            kept.write(run, before)
        if not new:
            count += 1
            continue
        after = new.run(run)  # also where nothing was kept of it: later runs read what it writes
        if before is None:
            missing += 1
            continue
        count += 1
        found = list(differences(before, after))
        same += not found
        strange = [f"{part}: {sign}{text}" for part, sign,
                   text in found if not listed.holds(f"{run.name}: {part}: {sign}{text}")]
        others += bool(strange)
        if strange:
            report(run, strange, options.lines)
    if new:
        print(f"{count} runs, {same} with the same bytes, {count - same - others} with listed differences only, "
              f"{others} with others"
              + (f"; {missing} were not kept" if missing else ""))
    else:
        print(f"{count} runs kept in {options.keep}")
    for pattern, reason, hits in listed.rows:
        if hits or not (options.quick or options.only):
            print(f"  listed, {hits} lines: {reason}"
                  + ("" if hits else f" [{pattern.pattern} is met by nothing: drop it]"))
    return others


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("old")
    arguments.add_argument("new", nargs="?")
    arguments.add_argument("--python", nargs="+", default=[], metavar="DIR")
    arguments.add_argument("--keep", metavar="DIR", help="write the outputs of OLD there")
    arguments.add_argument("--quick", action="store_true")
    arguments.add_argument("--only", default="",
                           help="only runs in whose name this expression is found: name those too whose files they "
                                "need")
    arguments.add_argument("--listed", metavar="FILE")
    arguments.add_argument("--lines", type=int, default=6, help="differing lines of a run that are printed (0: all)")
    options = arguments.parse_args()
    from_kept = pathlib.Path(options.old).is_dir()
    programs = [p for p in (None if from_kept else options.old, options.new) if p]
    if not options.new and (from_kept or not options.keep):
        arguments.error("NEW is required, or a program and --keep")
    if from_kept and options.keep:
        arguments.error("--keep writes outputs of a program, and OLD is a folder of such")
    if options.python and len(options.python) != len(programs):
        arguments.error("--python has a folder for each program")
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        modules = options.python or [None] * len(programs)
        sides = [Side(program, module, work / name) for program, module, name in zip(programs, modules, ("one", "two"))]
        old = Kept(options.old) if from_kept else sides[0]
        new = sides[-1] if options.new else None
        kept = Kept(options.keep, new=True) if options.keep else None
        sys.exit(bool(compare(options, old, new, kept, Listed(options.listed))))


if __name__ == "__main__":
    main()
