#!/usr/bin/env python3
"""The processor time of the page's program under node beside the native one's by one thread: a row per log and verb.

usage: speed.py PROGRAM BUILD FILE... [--rounds N] [-- OPTION...]
BUILD: build-page; OPTION: of inspect and characterize, such as --rate 200Hz.

Of the page, the thread that runs the command counts: a browser compiles in others. `beside`: without the digest, which
a second worker takes of a large recording. The least of the rounds, which take turns.
"""
import argparse
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile

RUN = pathlib.Path(__file__).resolve().parent.parent.parent / "tools/page/build/run.js"
AIM = 2.5


def native_seconds(command, folder):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([*command, "--threads", "1"], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                   check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def page_seconds(command, folder, digest=""):
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False,
                          env={**os.environ, "CPU": "1", "DIGEST": digest})
    said = re.search(r"^cpu ([0-9.]+)$", done.stderr, re.M)
    if not said:
        sys.exit(f"{command}: {done.stderr.strip()[-300:]}")
    return float(said[1])


def row(arguments, folder, log, words):
    native = [str(arguments.program.resolve()), *words]
    page = ["node", "--no-experimental-fetch", str(RUN), str(arguments.build.resolve()), *words]
    rounds = []
    for _ in range(arguments.rounds):
        seconds = []
        for take, *more in ((native_seconds, native), (page_seconds, page), (page_seconds, page, log)):
            shutil.rmtree(folder / "report", ignore_errors=True)
            seconds.append(take(more[0], folder, *more[1:]))
        rounds.append(seconds)
    own, whole, beside = (min(seconds) for seconds in zip(*rounds))
    numbers = (own, whole, beside, whole / own, beside / own)
    print(log, words[0], *(f"{number:.2f}" for number in numbers), sep="\t", flush=True)
    return beside / own


def main():
    words = sys.argv[1:]
    at = words.index("--") if "--" in words else len(words)
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("files", nargs="+", type=pathlib.Path)
    parser.add_argument("--rounds", type=int, default=3)
    arguments = parser.parse_intermixed_args(words[:at])
    options, ratios = words[at + 1:], []
    print("log\tverb\tnative s\tpage s\tbeside s\tpage / native\tbeside / native")
    for file in arguments.files:
        with tempfile.TemporaryDirectory(dir=file.resolve().parent) as name:
            folder = pathlib.Path(name)
            os.link(file.resolve(), folder / file.name)  # NODEFS sees what is below the folder
            for verb, *more in (("inspect", "--json", "--preview"), ("characterize", "-q", "-o", "report")):
                ratios.append(row(arguments, folder, file.name, [verb, file.name, *options, *more]))
    print(f"the largest: {max(ratios):.2f}; the aim is {AIM}")


if __name__ == "__main__":
    main()
