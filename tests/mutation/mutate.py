#!/usr/bin/env python3
"""Breaks lines of the sources one at a time and asks which test goes red.

usage: tests/mutation/mutate.py [--mutants 400] [--seed 1] [--only PATTERN] [--build build] [--results FILE]

A mutant is one source of the library with one line rewritten (sites.py); a hash of seed, file and line chooses it,
each place with the same probability: the share of killed ones is that of the whole library, within the interval
that is printed, and an edit elsewhere does not change the choice. It is compiled alone, and linked in front of a
build of the library whose functions are not inlined into each other (build-mutation, -O1, with the assertions of
the standard library as `.ci/gates sanitize` has them), with the test objects of an ordinary build (`--build`, whose
test programs must be up to date). The floor's cases run, then those of the floors that use it (targets.py), quick
ones first, until one fails; a case that takes longer than --slowest seconds without a mutation is left out.

Results: killed (and by which case), timed out (10 times the time of the sound program; counts as killed),
survived, did not compile (does not count). Each is a line of JSON in --results; mutants that stand there with
the same text are not run again, unless they survived and --again is given. Survivors named in equivalent.txt
cannot be told from the original by any test; the reason stands there."""
import argparse
import collections
import fnmatch
import hashlib
import json
import math
import os
import pathlib
import re
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "builds"))
from relinked import ARCHIVES, link_words  # noqa: E402
from sites import mutants  # noqa: E402
from targets import USERS  # noqa: E402

ROOT = HERE.parent.parent
LIBRARY = ROOT / "build-mutation"
# Without inlining a function into others of its piece, and without what the compiler concludes of its body there.
FLAGS = "-O1 -fPIC -fsemantic-interposition -D_GLIBCXX_ASSERTIONS -w"


def run(command, **more):
    return subprocess.run(command, capture_output=True, text=True, errors="replace", **more)


# --- what is broken
# -------------------------------------------------------------------------------------------------------------------

def chosen(count, seed, only):
    """The first mutants, {path, floors, line, before, after, operator, nth}, of all places of the library in the
    order of a hash: a random sample, which an edit elsewhere does not change."""
    found = []
    for path in sorted(p.relative_to(ROOT).as_posix() for p in (ROOT / "libchar").rglob("*.cpp")):
        if not fnmatch.fnmatch(path, only):
            continue
        floor, seen = path.split("/")[1], collections.Counter()
        for mutant in mutants((ROOT / path).read_text()):
            key = (path, mutant.before.strip(), mutant.after.strip())
            seen[key] += 1
            order = hashlib.sha256(repr((seed, key, seen[key])).encode()).hexdigest()
            found.append((order, {"path": path, "floors": [floor, *USERS.get(floor, [])], "nth": seen[key],
                                  **mutant._asdict()}))
    return [mutant for _, mutant in sorted(found, key=lambda entry: entry[0])[:count]]


def equivalents():
    """{(path, before, after): reason} of equivalent.txt: blocks of path, '- before', '+ after', '= reason'."""
    found = {}
    for block in (HERE / "equivalent.txt").read_text().split("\n\n"):
        lines = [line for line in block.split("\n") if line.strip() and not line.startswith("#")]
        if lines:
            found[(lines[0].strip(), lines[1][2:].strip(),
                   lines[2][2:].strip())] = " ".join(line[2:].strip() for line in lines[3:])
    return found


# --- how it is built
# ------------------------------------------------------------------------------------------------------------------

def build_library():
    """The library, each of whose functions the linker can take from a mutant instead; {source: (command without
    source and object, folder)}."""
    made = run(["cmake", "-S", str(ROOT), "-B", str(LIBRARY), "-G", "Ninja", "--log-level=WARNING",
                "-DCMAKE_BUILD_TYPE=Mutation", f"-DCMAKE_CXX_FLAGS_MUTATION={FLAGS}", "-DLIBCHAR_TESTS=OFF",
                "-DLIBCHAR_TOOLS=OFF", "-DLIBCHAR_BENCH=OFF", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON"])
    made = made if made.returncode else run(["ninja", "-C", str(LIBRARY), "-j2", *(f"libchar/{a}" for a in ARCHIVES)])
    if made.returncode:
        sys.exit((made.stderr + made.stdout)[-2000:])
    found = {}
    for entry in json.loads((LIBRARY / "compile_commands.json").read_text()):
        words = shlex.split(entry["command"])
        while not re.search(r"(?:\+\+|/g\+\+-\d+)$", words[0]):  # ccache before it
            words.pop(0)
        at = words.index("-o")
        del words[at:at + 2]
        del words[words.index("-c"):]
        piece = pathlib.Path(entry["file"])
        for source in re.findall(r'^#include "(.*)"', piece.read_text(), re.M) if "Unity" in piece.parts else [piece]:
            found[os.path.relpath(source, ROOT)] = (words, entry["directory"])
    return found


def link_command(build, floor, scratch):
    """The command that links a floor's tests with the library to break, whose functions a mutant before it replaces;
    OBJECT and PROGRAM are to be replaced. Objects are copied: `build` may be built again while this runs."""
    words = link_words(build, f"tests/test_{floor}", LIBRARY)
    objects = [i for i, word in enumerate(words) if word.endswith(".o")]
    for i in objects:
        words[i] = shutil.copy(build / words[i], scratch / f"{floor}_{i}.o")
    first = objects[0]
    return words[:first] + (["-fuse-ld=gold"] if shutil.which("ld.gold") else []) + [
        "-Wl,-z,muldefs", "OBJECT"] + words[first:]


def linked(command, build, program, mutant_object=None):
    words = [str(program) if word == "PROGRAM" else word for word in command]
    words = [word for word in words if word != "OBJECT"] if mutant_object is None else [
        str(mutant_object) if word == "OBJECT" else word for word in words]
    return run(words, cwd=build)


# --- how it is tested
# -----------------------------------------------------------------------------------------------------------------

def limits():
    resource.setrlimit(resource.RLIMIT_AS, (6 << 30, 6 << 30))
    resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 30, 1 << 30))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def run_cases(program, names, seconds, scratch, options=("--abort",)):
    """(what happened, in which case, report) of these cases: ok, failed, crashed or timed out."""
    (scratch / "cases.txt").write_text("".join(f'"{name}"\n' for name in names))
    with open(scratch / "out.xml", "wb") as out:
        process = subprocess.Popen([str(program), "-f", str(scratch / "cases.txt"), *options, "-r", "xml", "-d",
                                    "yes"], stdout=out,
                                   stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL, preexec_fn=limits, cwd=scratch,
                                   env={**os.environ, "TMPDIR": str(scratch)})
        try:
            code = process.wait(seconds)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            code = None
    text = (scratch / "out.xml").read_text(errors="replace")
    last = re.findall(r'<TestCase name="([^"]*)"', text)
    case = last[-1] if last else "at start"
    return ("timed out" if code is None else "ok" if code == 0 else "crashed" if code < 0 else "failed"), case, text


def cases_of(program, slowest, scratch):
    """Seconds, names and files of the sound program's cases, quick first; those that take longer than
    `slowest` are left out."""
    listed = run([str(program), "--list-test-names-only"]).stdout
    waiting, found = [name for name in listed.split("\n") if name], []
    while waiting:
        what, last, text = run_cases(program, [quoted(name) for name in waiting], 3000, scratch, [])
        for name, file, body in re.findall(r'<TestCase name="([^"]*)"[^>]*? filename="([^"]*)"(.*?)</TestCase>',
                                           text, flags=re.S):
            result = re.search(r'<OverallResult success="(\w+)"(?: durationInSeconds="([^"]*)")?', body)
            name = unescaped(name)
            waiting.remove(name)
            if result[1] == "true":
                found.append((float(result[2] or 0), quoted(name), pathlib.Path(file).name))
            else:
                print(f"not used, red without a mutation: {name}", flush=True)
        if what in ("ok", "failed"):
            break
        # A crash is not the end of the list: what comes after it is asked again.
        if unescaped(last) in waiting:
            print(f"not used, {what} without a mutation: {unescaped(last)}", flush=True)
            waiting.remove(unescaped(last))
        elif last == "at start":
            sys.exit(f"{program}: {what} at start")
    found.sort()
    kept = [entry for entry in found if entry[0] <= slowest]
    return kept, len(found) - len(kept)


def unescaped(name):
    for code, character in (("&lt;", "<"), ("&gt;", ">"), ("&quot;", '"'), ("&amp;", "&")):
        name = name.replace(code, character)
    return name


def quoted(name):
    return re.sub(r'([\\,"\[])', r"\\\1", name)


class Floor:
    """The tests of a floor: how to link them, and in which groups to run them."""

    def __init__(self, name, build, slowest, scratch):
        self.link = link_command(build, name, scratch)
        program = scratch / f"sound_{name}"
        done = linked(self.link, build, program)
        if done.returncode:
            sys.exit(f"test_{name} does not link:\n{done.stderr[-2000:]}")
        cases, left_out = cases_of(program, slowest, scratch)
        quick = [entry for entry in cases if entry[0] < 0.1]
        slow = cases[len(quick):]
        _, _, text = run_cases(program, [case for _, case, _ in quick], 3000, scratch)
        if text.count("<TestCase ") != len(quick):
            sys.exit(f"test_{name}: {len(quick)} cases asked for, {text.count('<TestCase ')} ran")
        self.quick, self.slow = quick, slow
        print(f"test_{name}: {len(quick)} quick cases, {len(slow)} slower ones ({sum(s for s, *_ in cases):.1f} s "
              f"together), "
              f"{left_out} above {slowest:g} s left out", flush=True)
        program.unlink()

    def groups(self, path):
        """[(cases, seconds they may take)]: those of the test files that are named like the source, the other
        quick ones, the slow ones."""
        stem = pathlib.Path(path).stem
        near = [case for case in self.quick if stem in case[2]]
        far = [case for case in self.quick if stem not in case[2]]
        return [([case for _, case, _ in group], 10 * sum(seconds for seconds, *_ in group) + 5)
                for group in (near, far, self.slow) if group]


def judged(mutant, commands, floors, build, scratch):
    """(result, by) of one mutant."""
    lines = (ROOT / mutant["path"]).read_text().split("\n")
    if lines[mutant["line"]] != mutant["before"]:
        sys.exit(f"{mutant['path']} was edited while this ran: start again")
    lines[mutant["line"]] = mutant["after"]
    source, compiled = scratch / pathlib.Path(mutant["path"]).name, scratch / "mutant.o"
    source.write_text("\n".join(lines))
    words, folder = commands[mutant["path"]]
    done = run([*words, "-c", str(source), "-o", str(compiled)], cwd=folder)
    if done.returncode:
        return "did not compile", (re.search(r"error: .*", done.stderr) or [""])[0][:100]
    for name in mutant["floors"]:
        program = scratch / "mutated"
        done = linked(floors[name].link, build, program, compiled)
        if done.returncode:
            return "did not compile", done.stderr[-100:]
        for cases, seconds in floors[name].groups(mutant["path"]):
            result, case, _ = run_cases(program, cases, seconds, scratch)
            if result != "ok":
                return ("timed out" if result == "timed out"
                        else "killed"), f"{name}: {case}" + (" (crash)" if result == "crashed" else "")
    return "survived", ""


# --- what is said
# ---------------------------------------------------------------------------------------------------------------------

def key(mutant):
    return mutant["path"], mutant["before"].strip(), mutant["after"].strip(), mutant["nth"]


def shown(mutant):
    return f'{mutant["path"]}:{mutant["line"] + 1}\n- {mutant["before"].strip()}\n+ {mutant["after"].strip()}'


def share(part, whole):
    """In percent, with Wilson's interval."""
    p, n, z = part / max(1, whole), max(1, whole), 1.96
    middle, reach = p + z * z / (2 * n), z * math.sqrt(p * (1 - p) / n + (z / (2 * n)) ** 2)
    low, high = (100 * (middle + side * reach) / (1 + z * z / n) for side in (-1, 1))
    return f"{100 * p:.1f} % [{low:.1f}, {high:.1f}]"


def summary(results):
    known = equivalents()
    count = collections.Counter(r["result"] for r in results)
    survivors = [r for r in results if r["result"] == "survived"]
    equal = [r for r in survivors if key(r)[:3] in known]
    still_open = [r for r in survivors if key(r)[:3] not in known]
    for mutant in still_open:
        print(f"\nopen: {shown(mutant)}")
    tried = len(results) - count["did not compile"]
    killed = count["killed"] + count["timed out"]
    print(f"\n{tried} mutants ({count['did not compile']} more did not compile): {count['killed']} killed, "
          f"{count['timed out']} timed out, "
          f"{len(survivors)} survived: {len(equal)} equivalent, {len(still_open)} open")
    if tried:
        print(f"killed: {share(killed, tried)} of all, {share(killed, tried - len(equal))} of those that are not "
              f"equivalent (95 % intervals of the whole library's)")
    by_floor = collections.defaultdict(collections.Counter)
    for r in results:
        if r["result"] != "did not compile":
            by_floor[r["path"].split("/")[1]][r["result"] == "survived"] += 1
    print("  ".join(f"{name}: {c[False]} of {c[False] + c[True]}" for name, c in sorted(by_floor.items())))
    return still_open


def options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mutants", type=int, default=400, help="how many (default 400)")
    parser.add_argument("--seed", default="1")
    parser.add_argument("--only", default="*", help="sources that match, e.g. 'libchar/allan/*'")
    parser.add_argument("--build", default="build", help="the ordinary build whose test objects are used")
    parser.add_argument("--results", default="build-mutation/results.jsonl")
    parser.add_argument("--slowest", type=float, default=3, help="cases above these seconds are left out (default 3)")
    parser.add_argument("--again", action="store_true", help="run survivors of --results again, after tests were added")
    parser.add_argument("--list", action="store_true", help="print the mutants, run none")
    parser.add_argument("--summary", action="store_true", help="print what --results says, run none")
    return parser.parse_args()


def remembered(path, again):
    found = {}
    if path.exists():
        for line in path.read_text().splitlines():
            result = json.loads(line)
            found[key(result)] = result
    return {k: r for k, r in found.items() if not (again and r["result"] == "survived" and k[:3] not in equivalents())}


def run_all(wanted, done, arguments, scratch):
    build = (ROOT / arguments.build).resolve()
    wanted = [mutant for mutant in wanted if key(mutant) not in done]
    commands = build_library()
    floors = {}
    for i, mutant in enumerate(wanted):
        for name in mutant["floors"]:
            if name not in floors:
                floors[name] = Floor(name, build, arguments.slowest, scratch)
        begin = time.monotonic()
        result, by = judged(mutant, commands, floors, build, scratch)
        record = {**mutant, "result": result, "by": by, "seconds": round(time.monotonic() - begin, 1)}
        done[key(mutant)] = record
        with open(ROOT / arguments.results, "a") as out:
            out.write(json.dumps(record) + "\n")
        print(f'{i + 1}/{len(wanted)} {record["seconds"]} s {result}: {by or shown(mutant)}', flush=True)


def main():
    arguments = options()
    wanted = chosen(arguments.mutants, arguments.seed, arguments.only)
    if arguments.list:
        for mutant in wanted:
            print(f"{shown(mutant)}  [{mutant['operator']}]")
        return
    done = remembered(ROOT / arguments.results, arguments.again)
    if not arguments.summary:
        scratch = pathlib.Path(tempfile.mkdtemp(prefix="mutation-",
                                                dir="/dev/shm" if os.path.isdir("/dev/shm") else None))
        try:
            run_all(wanted, done, arguments, scratch)
        finally:
            shutil.rmtree(scratch, ignore_errors=True)
    summary([done[key(mutant)] for mutant in wanted if key(mutant) in done])


if __name__ == "__main__":
    main()
