#!/usr/bin/env python3
"""The whole program on broken files: program_fuzz.py PROGRAM SEEDS [--seconds 60] [--runs N] [--seed 1]
[--findings FOLDER]

Takes files of SEEDS (seeds.py), breaks each a little, and runs a verb over it. Asked of every run: an exit
code that the README lists, no report of a sanitizer, no "internal error", no hang, one sentence of refusal
that names a code or the file, and no output where the verb failed. An input that breaks one of these is kept
in FOLDER with its command. PROGRAM is a build with LIBCHAR_SANITIZE; an ordinary one does, faster and
blinder."""
import argparse
import os
import pathlib
import random
import re
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

ALLOWED = {0, 2, 3, 4, 6}  # 5, "cannot write", is no answer to a bad input
TIMEOUT = 60
WORDS = [b"nan", b"inf", b"1e400", b"1e-400", b",", b";", b"\t", b"\r\n", b"\n", b'"', b"#", b"-",
         b"9223372036854775807", b"-9223372036854775808",
         b"\0", b"\xff", b"\xef\xbb\xbf", b"[", b"]", b"{", b"}", b": ", b"null", b"0", b"999999999", b"1e-15",
         b"&a", b"*a"]
# Suffix and verbs of each kind of seed; LOG stands for the broken file, OUT for a new folder or file.
LOG_VERBS = [["inspect", "LOG"], ["inspect", "LOG", "--json"], ["allan", "LOG"], ["psd", "LOG"], ["fit", "LOG"],
             ["convert", "LOG", "-o", "OUT.csv"],
             ["convert", "LOG", "-o", "OUT.npy"], ["convert", "LOG", "-o", "OUT.f64"],
             ["characterize", "LOG", "-o", "OUT"],
             ["inspect", "LOG", "--strict"], ["allan", "LOG", "--rate", "100"]]
KINDS = {
    "csv": (".csv", 2, LOG_VERBS),
    "npy": (".npy", 1, [*LOG_VERBS, ["inspect", "LOG", "--rate", "100"],
                        ["characterize", "LOG", "-o", "OUT", "--rate", "100"]]),
    "model": (".yaml", 1, [["model", "LOG"], ["model", "LOG", "--to", "kalibr"],
                           ["simulate", "LOG", "-o", "OUT.csv", "--duration", "1s"]]),
    "scene": (".yaml", 1, [["replay", "LOG", "--explain"], ["replay", "LOG", "-o", "OUT"]]),
    "report": (".json", 1, [["compare", "LOG", "LOG"]]),
    "limits": (".yaml", 1, [["characterize", "FIXTURE", "-o", "OUT", "--limits", "LOG"]]),
    "curve": (".csv", 1, [["fit", "LOG", "--curve", "allan"], ["fit", "LOG"]]),
    "fusion": (".yaml", 1, [["fuse", "FIXTURE", "--with", "LOG", "-o", "OUT.csv"]]),
}
FIXTURE = pathlib.Path(__file__).resolve().parent.parent.parent / "fixtures" / "imu_at_rest.csv"


def broken(data, others, generator):
    """The data after one to four small changes."""
    data = bytearray(data)
    for _ in range(generator.choice([0, 1, 1, 2, 4])):
        at = generator.randrange(len(data) + 1)
        what = generator.randrange(7)
        if what == 0 and data:
            data[at % len(data)] ^= 1 << generator.randrange(8)
        elif what == 1:
            del data[at:at + generator.randrange(1, 20)]
        elif what == 2:
            data[at:at] = generator.choice(WORDS)
        elif what == 3:
            data[at:at + 8] = generator.choice(WORDS)
        elif what == 4:
            del data[at:]
        elif what == 5:
            end = at + generator.randrange(1, 200)
            data[at:at] = bytes(data[at:end]) * generator.choice([1, 3, 50])
        else:
            other = generator.choice(others)
            data[at:] = other[generator.randrange(len(other) + 1):]
    return bytes(data[:200000])


def limits(sanitized):
    def apply():
        resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 30, 1 << 30))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if not sanitized:
            resource.setrlimit(resource.RLIMIT_AS, (8 << 30, 8 << 30))
    return apply


def wrong(code, out, err, outputs):
    """What is wrong with this answer; empty: nothing."""
    text = err.decode(errors="replace")
    if re.search(r"Sanitizer|runtime error:", text):
        return "sanitizer"
    if code is None:
        return "hang"
    if code not in ALLOWED:
        return f"exit code {code}"
    if re.search(r"sensorchar: internal error|terminate called|Assertion|what\(\)",
                 text + out[:2000].decode(errors="replace")):
        return "internal error"
    if code in (2, 3, 4):
        errors = [line for line in text.splitlines() if "error" in line]
        if not errors:
            return "no sentence"
        if outputs and code in (2, 3):
            return "output of a refused run"
    return ""


def one_run(arguments, seeds, generator, scratch):
    kind = generator.choice([k for k in KINDS if k in seeds])
    suffix, skip, verbs = KINDS[kind]
    name, data = generator.choice(seeds[kind])
    data = broken(data[skip:], [other for _, other in seeds[kind]], generator)
    if kind != "csv" and kind != "curve" and data.lstrip()[:1] == b"{":
        suffix = ".json"
    for entry in scratch.iterdir():
        shutil.rmtree(entry) if entry.is_dir() else entry.unlink()
    log = scratch / ("log" + suffix)
    log.write_bytes(data)
    words = [{"LOG": str(log), "FIXTURE": str(FIXTURE)}.get(word, word.replace("OUT", str(scratch / "out")))
             for word in generator.choice(verbs)]
    try:
        done = subprocess.run([arguments.program, *words], capture_output=True, timeout=TIMEOUT,
                              stdin=subprocess.DEVNULL, cwd=scratch,
                              preexec_fn=limits(arguments.sanitized),
                              env={**os.environ, "ASAN_OPTIONS": "allocator_may_return_null=0"})
        code, out, err = done.returncode, done.stdout, done.stderr
    except subprocess.TimeoutExpired as slow:
        code, out, err = None, slow.stdout or b"", slow.stderr or b""
    outputs = [entry.name for entry in scratch.iterdir() if entry != log]
    return kind, words, code, err, wrong(code, out, err, outputs), log


def keep(arguments, number, found, words, log, err):
    folder = pathlib.Path(arguments.findings)
    folder.mkdir(parents=True, exist_ok=True)
    name = f"program-{re.sub('[^a-z0-9]+', '_', found)}-{arguments.seed}-{number}"
    shutil.copy(log, folder / (name + log.suffix))
    (folder / (name + ".txt")).write_text(f"{found}: {shlex.join(words)}\n" + err.decode(errors="replace")[-4000:])
    print(f"FINDING {found}: {shlex.join(words)}\n   kept as {name}{log.suffix}\n   "
          f"{err.decode(errors='replace')[-300:]}", flush=True)


def options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("seeds", type=pathlib.Path)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--runs", type=int, default=10**9)
    parser.add_argument("--seed", type=int, default=int(time.time()))
    parser.add_argument("--findings", default="findings")
    arguments = parser.parse_args()
    arguments.sanitized = b"AddressSanitizer" in pathlib.Path(arguments.program).read_bytes()
    return arguments


def main():
    arguments = options()
    generator = random.Random(arguments.seed)
    seeds = {kind: [(p.name, p.read_bytes()) for p in sorted((arguments.seeds / kind).iterdir())]
             for kind in KINDS if (arguments.seeds / kind).is_dir()}
    end, runs, findings, codes = time.monotonic() + arguments.seconds, 0, 0, {}
    with tempfile.TemporaryDirectory(dir="/dev/shm" if os.path.isdir("/dev/shm") else None) as scratch:
        while runs < arguments.runs and time.monotonic() < end:
            runs += 1
            kind, words, code, err, found, log = one_run(arguments, seeds, generator, pathlib.Path(scratch))
            codes[(kind, code)] = codes.get((kind, code), 0) + 1
            if found:
                findings += 1
                keep(arguments, runs, found, words, log, err)
    print(f"seed {arguments.seed}: exit codes",
          ", ".join(f"{kind} {code}: {n}" for (kind, code), n in sorted(codes.items(), key=str)))
    print(f"stat::number_of_executed_units: {runs}\nfindings: {findings}")
    sys.exit(1 if findings else 0)


if __name__ == "__main__":
    main()
