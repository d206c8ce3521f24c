"""What Python adds to a call of the library: wall time of the function over that of the C++ call inside it,
in the same run.

usage: PYTHONPATH=build/python tests/bench/python_bench.py [--samples 1000000] [--rounds 7]
"""
import argparse
import pathlib
import statistics
import tempfile
import time

import numpy as np

import libchar
from libchar import _libchar, functions

MODEL = ("format: sensor-model\nversion: 1\nchannel: gyro\nunit: deg/s\nrate_hz: 100\ndensity: two-sided\n"
         "white_noise: {value: 0.01}\n")
inside = []
characterize_columns = _libchar.characterize_columns


def timed(*arguments):
    made = characterize_columns(*arguments)
    inside.append(made.seconds())
    return made


def calls(samples, folder):
    """(name, what Python calls): a record in memory; a simulation of as many samples; a replay of a recording
    of five channels in a file."""
    record = np.random.default_rng(1).normal(size=samples)
    for name in ("allan", "fit", "characterize", "psd"):
        yield name, lambda name=name: getattr(functions, name)(record, 100.0)
    yield "simulate", lambda: functions.simulate(MODEL, duration_s=samples / 100)
    log = str(pathlib.Path(folder) / "log.f64")
    array = libchar.simulate(MODEL, duration_s=samples / 500, devices=4, truth="sine,amplitude=2,frequency_hz=0.1")
    libchar.write(log, array)
    yield "replay", lambda: functions.replay(log, sensors=["gyro*"], reference="truth", learning=(0, samples / 1500))


def measure(call, rounds):
    """Seconds of each round: of the function, and of the library in it."""
    walls, own = [], []
    for _ in range(rounds):
        inside.clear()
        begin = time.perf_counter()
        call()
        walls.append(time.perf_counter() - begin)
        own.append(inside[0] if inside else _libchar.library_seconds())
    return walls, own


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--samples", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=7)
    options = parser.parse_args()
    functions._libchar.characterize_columns = timed
    print(f"{options.samples} samples, median of {options.rounds}: seconds of the Python function, of the C++ call, "
          f"ratio")
    with tempfile.TemporaryDirectory() as folder:
        for name, call in calls(options.samples, folder):
            walls, own = measure(call, options.rounds)
            ratio = statistics.median(wall / one for wall, one in zip(walls, own))
            print(f"{name:14} {statistics.median(walls):8.4f} {statistics.median(own):8.4f} {ratio:6.3f}")


if __name__ == "__main__":
    main()
