#!/usr/bin/env python3
"""Every option with and without: option_effects.py PROGRAM [--verb NAME]

An option that is accepted has an effect on what is printed or written, or it is refused. Each option of each verb
is added to the good commands of option_inputs.py with its good values; one that is accepted somewhere and changes
nothing anywhere is named, and the exit code is 1. PERMISSIONS change what may happen, not what is computed. How a
log is read is left out: its words may confirm what would be found anyway, and the library refuses what a format
does not have."""
import argparse
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

import option_contract as contract
import option_fuzz as fuzz
import option_inputs as inputs
import program as programs
import option_values as values

PERMISSIONS = {"--quiet", "--color", "--threads", "--memory", "--strict", "--force", "--allow-outside", "--allow-read",
               "--no-skip", "--budget", "--skip-unreadable", "--stretch", "--split-above", "--partial", "--overflow",
               "--repeated-header", "--full-overlap", "--markdown"}  # the last is the default by name
MEASURED = re.compile(r'"(?:command|measured|seconds|bytes|sha256|files_sha256|path|ns_per_sample|peak_bytes)"')


def seen(program, words, base, folder):
    """What a command prints and writes, without what is measured; None where it is refused."""
    before = contract.state(folder)
    code, out, err, _ = programs.run(program, words, folder)
    after = contract.state(folder)
    fresh = sorted(set(after) - set(before))
    text = out.decode(errors="replace") + err.decode(errors="replace")
    for name in fresh:
        text += f"{name}:" + (folder / name).read_bytes().decode("latin-1")
    changed = any(after.get(name) != before[name] for name in before)
    fuzz.tidy(base, folder, before, after)
    if code in (1, 2, 3, 4, 5) or code is None:
        return None
    return changed, "\n".join(line for line in text.splitlines() if not MEASURED.search(line))


def good_values(option):
    flag = option["flags"][-1]
    if not option["value"]:
        return [None]
    if flag in values.WRITES:
        return ["OUT9"]
    if option["words"]:
        return [word for word in option["words"] if word not in ("auto", "none")][:5]
    if option["kind"] in ("file", "folder"):
        return ["limits.yaml", "x.csv", "rep", "bn/bench.json"]
    known = values.SPECIAL.get(flag, []) + values.GOOD.get(option["value"], [])
    return known + values.BY_NAME.get(option["value"], [])[:6]


def without_effect(program, verb, option, base, folder, plain):
    """Commands that accept the option and are the same as without it; [] where one is not, or none accepts it."""
    command = verb["name"].split("-", 1) if verb["name"].startswith("fleet-") else [verb["name"]]
    same = []
    for arguments in inputs.ARGUMENTS[verb["name"]]:
        words = command + arguments
        key = tuple(words)
        if key not in plain:
            plain[key] = seen(program, words, base, folder)
        for value in good_values(option):
            flag = option["flags"][-1]
            if flag in arguments:
                continue
            now = seen(program, words + ([flag] if value is None else [f"{flag}={value}"]), base, folder)
            if now is None:
                continue
            if now != plain[key]:
                return []
            same.append(shlex.join(words + [flag] + ([] if value is None else [value])))
    return same


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("--verb")
    arguments = parser.parse_args()
    described = subprocess.run([arguments.program, "--generate", "json"], capture_output=True, check=True)
    usage = json.loads(described.stdout)
    wrong = count = 0
    with tempfile.TemporaryDirectory() as top:
        base, folder, plain = pathlib.Path(top) / "base", pathlib.Path(top) / "work", {}
        inputs.make(arguments.program, base)
        shutil.copytree(base, folder)
        for verb in usage["verbs"]:
            for option in verb["options"]:
                flag = option["flags"][-1]
                wanted = arguments.verb in (None, verb["name"]) and not option["group"].startswith("Reading")
                if flag in PERMISSIONS or flag == "--help" or not wanted:
                    continue
                count += 1
                same = without_effect(arguments.program, verb, option, base, folder, plain)
                if same:
                    wrong += 1
                    print(f"NO EFFECT {verb['name']} {flag}, as in {same[0]} ({len(same)} commands)", flush=True)
    print(f"{count} options, {wrong} without an effect")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
