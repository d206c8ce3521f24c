#!/usr/bin/env python3
"""Binary and compressed logs cut at every 1000th byte, through the program: cut_files.py PROGRAM [--step 1000]

Every beginning of every binary fixture is inspected. Right is exit 0 with the loss said, or exit 3 with one
sentence that names a code, and for a whole file exit 0; wrong is anything else, and any report of a sanitizer
(`.ci/gates sanitize` runs it with them).
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

FIXTURES = pathlib.Path(__file__).resolve().parent.parent.parent / "fixtures"
SUFFIXES = {".mcap", ".bag", ".db3", ".ulg", ".bin", ".npz", ".npy", ".mat", ".h5", ".imu", ".gz", ".xz", ".zst"}
# A record after the other and no end mark: a cut between two of them leaves a whole file.
WITHOUT_END = {".ulg", ".bin", ".imu"}
OPTIONS = {"float.imu": ["--preset", "NAVCHIP_FLT"], "int.imu": ["--preset", "NAVCHIP_INT"],
           ".npy": ["--rate", "100Hz"], ".npz": ["--rate", "100Hz"],
           ".mat": ["--rate", "100Hz"], ".h5": ["--rate", "100Hz"]}
WITHOUT_LIBRARY = re.compile(r"this program (is|was) built without|this build cannot unpack")
SAID = re.compile(r": error E\d{4}: ")


def files():
    """(name, bytes) of what is cut."""
    for path in sorted(FIXTURES.rglob("*")):
        if path.suffix in SUFFIXES and "badinputs" not in path.parts:
            yield path.name, path.read_bytes()


def cuts(step, folder):
    """(name, size, path) of every beginning, the whole file last: sizes of whole steps."""
    for number, (name, data) in enumerate(files()):
        for size in [*range(0, len(data), step), len(data)]:
            # The suffix tells a reader what it is.
            path = folder / f"{number}_{size}_{name}"
            path.write_bytes(data[:size])
            yield name, size, size == len(data), path


def wrong(program, name, whole, path):
    """What is wrong with the answer, or nothing, and whether it was refused."""
    suffix = pathlib.Path(name).suffix
    words = OPTIONS.get(name) or OPTIONS.get(suffix, [])
    ran = subprocess.run([program, "inspect", path, *words, "--json", "--quiet"], capture_output=True,
                         stdin=subprocess.DEVNULL, timeout=120)
    said = ran.stderr.decode(errors="replace")
    path.unlink()
    if "Sanitizer" in said or "runtime error" in said:
        return "a sanitizer's report:\n" + said[:3000], False
    if ran.returncode == 3:
        if whole and not WITHOUT_LIBRARY.search(said):
            return "a whole file is refused: " + said, True
        lines = [line for line in said.splitlines() if ": warning: " not in line]
        return ("" if len(lines) == 1 and SAID.search(lines[0]) else "no single sentence: " + said), True
    if ran.returncode != 0:
        return f"exit code {ran.returncode}: {said}", False
    warnings = json.loads(ran.stdout)["findings"]
    return ("" if warnings or whole or suffix in WITHOUT_END else "exit code 0, and no word of the loss"), False


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=lambda path: str(pathlib.Path(path).resolve()))
    parser.add_argument("--step", type=int, default=1000)
    options = parser.parse_args()
    runs, refused, bad = 0, 0, 0
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as workers:
        todo = [(name, size, workers.submit(wrong, options.program, name, whole, path))
                for name, size, whole, path in cuts(options.step, pathlib.Path(folder))]
        for name, size, answer in todo:
            problem, no = answer.result()
            runs, refused = runs + 1, refused + no
            if problem:
                bad += 1
                print(f"{name} cut at {size}: {problem}")
    print(f"{runs} files inspected, {refused} refused with a sentence, {bad} wrong")
    sys.exit(1 if bad or not runs else 0)


if __name__ == "__main__":
    main()
