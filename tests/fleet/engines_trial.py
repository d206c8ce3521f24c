#!/usr/bin/env python3
"""A fleet on a real engine, with workers killed at random, against one process alone: the merged reports have
to be the same bytes.

usage: engines_trial.py PROGRAM FOLDER --engine slurm|snakemake|parallel [--devices N] [--samples S] [--kills
       K] [--recordings DIR] [--seed X] [--job S]

Writes N simulated logs (three channels of white noise at 100 Hz) into FOLDER/logs, plans them with the
recordings of DIR (those that can be read without options), runs the plan in one process (FOLDER/alone) and on
the engine (FOLDER/ENGINE), kills K of its workers (kill -9), exports again what is missing until nothing is,
merges both, and compares. Prints the figures; exit 1 where something differs. An engine of that name must be
installed and, for Slurm, its daemons running with the partitions `short` and `long`.
"""

import argparse
import array
import filecmp
import os
import pathlib
import random
import resource
import shutil
import signal
import struct
import subprocess
import sys
import time


def write_npy(path, columns):
    header = f"{{'descr': '<f8', 'fortran_order': True, 'shape': ({len(columns[0])}, {len(columns)}), }}".encode()
    header += b" " * ((64 - (11 + len(header)) % 64) % 64) + b"\n"
    with open(path, "wb") as out:
        out.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header)
        for column in columns:
            column.tofile(out)


def simulate(folder, devices, samples, seed):
    folder.mkdir(parents=True, exist_ok=True)
    rng = random.Random(seed)
    rows = ["device,log,type,batch"]
    for d in range(devices):
        path = folder / f"sim{d:05d}.npy"
        sigma, bias = 0.01 * rng.lognormvariate(0, 0.1), rng.gauss(0, 0.01)
        if not path.exists():
            own = random.Random(f"{seed}-{d}")
            write_npy(path, [array.array("d", [bias + own.gauss(0, sigma) for _ in range(samples)]) for _ in range(3)])
        rows.append(f"sim{d:05d},{path.name},simulated,b{d % 4}")
    return rows


def call(words, **options):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, **options)
    return done.returncode, done.stdout + done.stderr


def workers(fleet):
    """Processes that run units of this fleet (its folder is where they work)."""
    found = []
    for entry in os.listdir("/proc"):
        if not entry.isdigit():
            continue
        try:
            words = pathlib.Path("/proc", entry, "cmdline").read_bytes().split(b"\0")
            if b"run" in words[:3] and b"fleet" in words[:3] and os.readlink(f"/proc/{entry}/cwd") == str(fleet):
                found.append(int(entry))
        except OSError:
            continue
    return found


def start(engine, fleet):
    if engine == "slurm":
        return ["sh", "fleet.slurm.sh", "--partition=short,long"]
    if engine == "snakemake":
        return ["snakemake", "--cores", "all", "--quiet", "--rerun-incomplete", "--keep-going"]
    return ["sh", "fleet.parallel.sh"]


def under_way(engine, process):
    if process.poll() is None:
        return True
    return engine == "slurm" and subprocess.run(["squeue", "-h"], capture_output=True, text=True).stdout.strip() != ""


def on_engine(options, fleet, rng):
    kills, rounds, begun = 0, 0, time.time()
    while True:
        code, text = call([options.program, "fleet", "export", fleet, "--to", options.engine, "--job",
                           f"{options.job}s", "--program", options.program])
        assert code == 0, text
        if subprocess.run([options.program, "fleet", "status", fleet, "--list"], capture_output=True,
                          text=True).stdout == "":
            return kills, rounds, time.time() - begun
        assert rounds < 20, "the engine does not get to an end"
        rounds += 1
        process = subprocess.Popen(start(options.engine, fleet), cwd=fleet, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        time.sleep(1)
        while under_way(options.engine, process):
            time.sleep(rng.uniform(0.1, 0.6))
            alive = workers(fleet)
            if kills < options.kills and alive:
                try:
                    os.kill(rng.choice(alive), signal.SIGKILL)
                    kills += 1
                except ProcessLookupError:
                    pass


def same(a, b):
    names = sorted(p.name for p in a.iterdir())
    if names != sorted(p.name for p in b.iterdir()):
        return False
    return all(filecmp.cmp(a / n, b / n, shallow=False) for n in names)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=lambda p: str(pathlib.Path(p).resolve()))
    parser.add_argument("folder", type=lambda p: pathlib.Path(p).resolve())
    parser.add_argument("--engine", required=True, choices=["slurm", "snakemake", "parallel"])
    parser.add_argument("--recordings", type=lambda p: pathlib.Path(p).resolve())
    for name, value in (("devices", 2000), ("samples", 4096), ("kills", 0), ("seed", 1), ("job", 5)):
        parser.add_argument("--" + name, type=int, default=value)
    options = parser.parse_args()
    rows = simulate(options.folder / "logs", options.devices, options.samples, options.seed)
    if options.recordings:
        rows += [f"{p.stem},{p},recorded,real" for p in sorted(options.recordings.iterdir())
                 if p.suffix in (".csv", ".npy")]
    manifest = options.folder / "logs/manifest.csv"
    manifest.write_text("\n".join(rows) + "\n")
    # One folder after the other has the same name: what a report says of its fleet is the same then.
    reports, seconds = [], []
    for way in ("alone", options.engine):
        place = options.folder / way
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir()
        begun = time.time()
        code, text = call([options.program, "fleet", "plan", manifest, "-o", "fleet", "--rate", "100",
                           "--skip-unreadable"], cwd=place)
        assert code == 0, text
        seconds.append(time.time() - begun)
        if way == "alone":
            print(text.strip().splitlines()[0])
            begun = time.time()
            code, text = call([options.program, "fleet", "run", "fleet"], cwd=place)
            assert code == 0, text
            seconds.append(time.time() - begun)
        else:
            kills, rounds, engine_s = on_engine(options, place / "fleet", random.Random(options.seed))
        begun = time.time()
        code, text = call([options.program, "fleet", "merge", "fleet", "-o", "report"], cwd=place)
        assert code == 0, text
        seconds.append(time.time() - begun)
        reports.append(place / "report")
    left = [p for p in (options.folder / options.engine / "fleet/results").glob("*/.*")]
    equal = same(*reports)
    print(f"planned in {seconds[0]:.1f} s, run by one process in {seconds[1]:.1f} s, merged in {seconds[2]:.1f} s: "
          f"planning and merging are {100 * (seconds[0] + seconds[2]) / seconds[1]:.1f} % of the work")
    print(f"{options.engine}: {engine_s:.1f} s in {rounds} round{'s' * (rounds != 1)}, {kills} workers killed, "
          f"{len(left)} folders left of them")
    print("the merged reports are " + ("the same bytes" if equal else "NOT the same"))
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    print(f"largest process: {peak:.0f} MB")
    return 0 if equal else 1


if __name__ == "__main__":
    sys.exit(main())
