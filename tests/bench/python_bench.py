"""What Python adds to a call of the library: wall time of the function over that of the C++ call inside it, in the same run.

usage: PYTHONPATH=build/python tests/bench/python_bench.py [--samples 1000000] [--rounds 7]
"""
import argparse
import statistics
import time

import numpy as np

from libchar import _libchar, functions

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--samples", type=int, default=1_000_000)
parser.add_argument("--rounds", type=int, default=7)
options = parser.parse_args()
record = np.random.default_rng(1).normal(size=options.samples)
inside = []
call = _libchar.characterize_columns


def timed(*arguments):
    made = call(*arguments)
    inside.append(made.seconds())
    return made


functions._libchar.characterize_columns = timed
print(f"{options.samples} samples, median of {options.rounds}: seconds of the Python function, of the C++ call, ratio")
for name in ("allan", "fit", "characterize"):
    function, walls = getattr(functions, name), []
    inside.clear()
    for _ in range(options.rounds):
        begin = time.perf_counter()
        function(record, 100.0)
        walls.append(time.perf_counter() - begin)
    ratios = [wall / own for wall, own in zip(walls, inside)]
    print(f"{name:14} {statistics.median(walls):8.4f} {statistics.median(inside):8.4f} {statistics.median(ratios):6.3f}")
