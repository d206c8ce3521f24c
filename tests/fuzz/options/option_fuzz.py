#!/usr/bin/env python3
"""Options in combination: option_fuzz.py PROGRAM [--seconds 60] [--runs N] [--seed 1] [--verb NAME] [--counts]
[--sanitized] [--server FORK_SERVER]

Draws a verb, one to five of its options and a value for each from the program's own description
(sensorchar --generate json), on a table of good inputs, and asks of every command what option_contract.py says.
What breaks it is printed once for each verb, option and kind; the exit code is 1 where anything did."""
import argparse
import collections
import json
import os
import pathlib
import random
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

import option_contract as contract
import option_inputs as inputs
import option_values as values
import program as programs

NOT_DRAWN = {"--help", "-h"}


def drawn(usage, generator, only):
    """A command: its words, the options that were drawn, and where it may write."""
    verb = generator.choice([v for v in usage["verbs"] if only in (None, v["name"])])
    words = list(generator.choice(inputs.ARGUMENTS[verb["name"]]))
    options = [o for o in verb["options"] if not NOT_DRAWN & set(o["flags"])]
    chosen = generator.sample(options, min(len(options), generator.choice([1, 1, 2, 2, 3, 4, 5])))
    for option in chosen:
        value = values.value_of(verb["name"], option, generator)
        flag = generator.choice(option["flags"])
        if value is None:
            words.append(flag)
        elif flag.startswith("--") and generator.random() < 0.5:
            words.append(f"{flag}={value}")
        else:
            words += [flag, value]
    command = verb["name"].split("-", 1) if verb["name"].startswith("fleet-") else [verb["name"]]
    flags = [(verb["name"], option["flags"][-1]) for option in chosen]
    return command + words, flags, places(words) + writes_itself(verb["name"])


def writes_itself(verb):
    return {"fleet-run": ["fl3"], "fleet-export": ["fl3"]}.get(verb, [])


def places(words):
    """Names that follow an option that writes, and what lies beside them."""
    out = []
    for i, word in enumerate(words):
        flag, sign, value = word.partition("=")
        if flag in values.WRITES:
            out.append(os.path.normpath(value if sign else words[i + 1] if i + 1 < len(words) else ""))
        if word.startswith("-o") and len(word) > 2:
            out.append(os.path.normpath(word[2:]))
    return out


def tidy(base, folder, before, after):
    """Back to the good inputs; cheap where nothing but new files came."""
    if any(after.get(name) != before[name] for name in before):
        shutil.rmtree(folder)
        shutil.copytree(base, folder)
        return contract.state(folder)
    for name in set(after) - set(before):
        os.unlink(folder / name)
    for root, folders, files in os.walk(folder, topdown=False):
        if not folders and not files and not os.path.exists(base / os.path.relpath(root, folder)):
            os.rmdir(root)
    return before


def options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--runs", type=int, default=10**9)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--verb")
    parser.add_argument("--server", type=os.path.abspath, help="libfork_server.so: the program is loaded once")
    parser.add_argument("--counts", action="store_true", help="print how often each option appeared")
    parser.add_argument("--sanitized", action="store_true", help="a program built with the sanitizers: slower, and its "
                        "shadow of the memory takes terabytes of addresses")
    return parser.parse_args()


def allow_sanitizers():
    programs.TIMEOUT, programs.MEMORY = 4 * programs.TIMEOUT, 0
    contract.SLOWEST_S *= 4
    contract.STRESS_S *= 4
    os.environ.setdefault("ASAN_OPTIONS", "detect_leaks=0:detect_odr_violation=0:allocator_may_return_null=1")


def say_counts(counts):
    for (verb, flag), n in sorted(counts.items(), key=lambda item: item[1]):
        print(f"  {n:6} {verb} {flag}")


def fuzz(arguments, usage, run, base, folder):
    generator = random.Random(arguments.seed)
    exits, found, counts = contract.exit_codes(), {}, collections.Counter()
    shutil.copytree(base, folder)
    before = contract.state(folder)
    end, runs, codes = time.monotonic() + arguments.seconds, 0, collections.Counter()
    while runs < arguments.runs and time.monotonic() < end:
        runs += 1
        words, flags, outputs = drawn(usage, generator, arguments.verb)
        counts.update(flags)
        done = run(words, folder)
        codes[done[0]] += 1
        after = contract.state(folder)
        problem = contract.wrong(words, done, folder, (before, after), outputs, exits)
        if problem:
            key = (words[0], problem[:24])
            found[key] = found.get(key, 0) + 1
            if found[key] <= 2:
                print(f"FOUND {problem}\n   {shlex.join(words)}", flush=True)
        before = tidy(base, folder, before, after)
    print(f"seed {arguments.seed}: {runs} commands, exit codes {dict(codes)}, "
          f"{sum(found.values())} break the contract, in {len(found)} ways; "
          f"every option drawn at least {min(counts.values(), default=0)} times")
    if arguments.counts:
        say_counts(counts)
    return bool(found)


def main():
    arguments = options()
    if arguments.sanitized:
        allow_sanitizers()
    usage = json.loads(subprocess.run([arguments.program, "--generate", "json"], capture_output=True,
        check=True).stdout)
    scratch = "/dev/shm" if os.path.isdir("/dev/shm") else None
    with tempfile.TemporaryDirectory(dir=scratch) as top:
        base = pathlib.Path(top) / "base"
        inputs.make(arguments.program, base)
        server = programs.Server(arguments.program, arguments.server, top) if arguments.server else None
        run = server.run if server else lambda words, folder: programs.run(arguments.program, words, folder)
        try:
            sys.exit(fuzz(arguments, usage, run, base, pathlib.Path(top) / "work"))
        finally:
            if server:
                server.stop()


if __name__ == "__main__":
    main()
