#!/usr/bin/env python3
"""Every verb at a long job, interrupted at several moments: it ends by the signal's code, says one sentence
and leaves nothing behind.

usage: interrupt.py PROGRAM [--moments S,S…] [--times]

A job that has not ended five seconds after the signal hangs. --times prints how long each took instead of
nothing: for a quiet machine, never asserted. Exit 1 where something is wrong.
"""

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HANG_S = 5


def text_log(path, rows, columns, seed):
    rng = random.Random(seed)
    with open(path, "w") as file:
        file.write("t," + ",".join(f"s{k}" for k in range(columns)) + "\n")
        for r in range(rows):
            file.write(f"{r / 100:.2f}," + ",".join(f"{rng.gauss(0, 1):.5f}" for _ in range(columns)) + "\n")


def endless_log(path, names):
    """Zeros without end, of which the disk holds none: 16 GB by their length."""
    with open(path, "w") as file:
        file.truncate(16 << 30)
    channels = [{"name": name} for name in names]
    Path(f"{path}.json").write_text(json.dumps({"dtype": "f64", "endian": "little", "rate_hz": 100,
                                                "channels": channels}))


def prepare(folder, program):
    endless_log(folder / "long.f64", ["a", "b"])
    text_log(folder / "wide.csv", 400, 200, 1)
    (folder / "gyro.sensor.yaml").write_text(
        "format: sensor-model\nversion: 1\nchannel: gyro\nunit: rad/s\ndensity: two-sided\nrate_hz: 100\n"
        "white_noise: {value: 0.1}\nbias_instability: {value: 0.01}\n"
    )
    text_log(folder / "small.csv", 400, 3, 2)
    learn = [program, "replay", "small.csv", "--sensors", "s0,s1", "--reference", "s2", "--learning", "0..2", "-o",
             "learnt", "-q"]
    subprocess.run(learn + ["--algorithms", "mean"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    endless_log(folder / "long3.f64", ["s0", "s1", "s2"])


JOBS = {
    "inspect": ["inspect", "long.f64"],
    "inspect, nothing comes": ["inspect", "-"],
    "allan": ["allan", "long.f64"],
    "psd": ["psd", "long.f64"],
    "fit": ["fit", "long.f64"],
    "characterize": ["characterize", "long.f64", "-o", "out"],
    "convert": ["convert", "long.f64", "-o", "out/long.npy"],
    "simulate": ["simulate", "gyro.sensor.yaml", "--samples", "2000000000", "-o", "out/simulated.f64"],
    "replay": ["replay", "wide.csv", "--sensors", "s*", "--budget", "1000s", "--published", "-o", "out"],
    "fuse": ["fuse", "--with", "learnt/fusion.yaml", "long3.f64", "--algorithm", "mean", "-o", "out/fused.f64"],
}


def interrupted(program, folder, words, moment):
    """(what is wrong or "", seconds from signal to end or None where it had ended before)"""
    out = folder / "out"
    out.mkdir()
    try:
        job = subprocess.Popen([program, *words], cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE)
        time.sleep(moment)
        over = job.poll() is not None
        sent = time.monotonic()
        if not over:
            job.send_signal(signal.SIGINT)
        # Its standard input stays open: the end of it would be an end of the waiting.
        os.set_blocking(job.stdout.fileno(), False)
        while job.poll() is None and time.monotonic() - sent < HANG_S:
            job.stdout.read()
            time.sleep(0.002)
        took = time.monotonic() - sent
        if job.poll() is None:
            job.kill()
            job.wait()
            return f"still runs {HANG_S} s after the signal", took
        said = job.stderr.read().decode(errors="replace")
        for pipe in (job.stdin, job.stdout, job.stderr):
            pipe.close()
        if over:
            return (f"ended by itself with {job.returncode}: {said[-200:]}" if job.returncode != 0 else ""), None
        left = sorted(path.name for path in out.iterdir())
        if job.returncode == -signal.SIGINT and not said and not left:
            return "", took  # it had not begun: a busy machine
        if job.returncode != 130:
            return f"exit code {job.returncode}: {said[-200:]}", took
        if said.count("stopped") != 1 or "internal" in said or "terminate" in said:
            return f"says {said!r}", took
        return (f"leaves {left}" if left else ""), took
    finally:
        for path in out.iterdir():
            path.unlink()
        out.rmdir()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("--moments", default="0.1,0.6")
    parser.add_argument("--times", action="store_true")
    arguments = parser.parse_args()
    program = str(Path(arguments.program).resolve())
    moments = [float(word) for word in arguments.moments.split(",")]
    wrong = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        prepare(folder, program)
        for job, words in JOBS.items():
            for moment in moments:
                problem, took = interrupted(program, folder, words, moment)
                if problem:
                    wrong += 1
                    print(f"{job}, interrupted after {moment} s: {problem}")
                elif arguments.times:
                    print(f"{job:24} after {moment} s: " + ("over before" if took is None else f"{took:.3f} s"))
    print(f"interrupted: {len(JOBS) * len(moments)} runs, {wrong} of them wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
