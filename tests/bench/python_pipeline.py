"""The pipeline that an engineer types in Python today, as a baseline for speed: pandas.read_csv, an overlapping Allan
deviation in NumPy at octaves, scipy.signal.welch. Prints wall seconds, CPU seconds, peak memory.

    /usr/bin/python3 tests/bench/python_pipeline.py LOG.csv [SEGMENT]      (SEGMENT 0 = a quarter of the record)
"""
import os
import resource
import sys
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")
import numpy as np
import pandas as pd
from scipy import signal


def overlapping_allan(y, dt):
    x = np.concatenate(([0.0], np.cumsum(y - y.mean()))) * dt
    out, m = [], 1
    while 2 * m <= len(y):
        d = x[2 * m:] - 2 * x[m:-m] + x[:-2 * m]
        out.append((m * dt, np.sqrt(np.mean(d * d) / 2) / (m * dt)))
        m *= 2
    return out


start, path = time.perf_counter(), sys.argv[1]
segment = int(sys.argv[2]) if len(sys.argv) > 2 else 65536
table = pd.read_csv(path)
parsed = time.perf_counter()
t = table.iloc[:, 0].to_numpy()
dt = (t[-1] - t[0]) / (len(t) - 1)
for name in table.columns[1:]:
    y = table[name].to_numpy()
    curve = overlapping_allan(y, dt)
    f, p = signal.welch(y, 1 / dt, nperseg=segment or len(y) // 4)
    print(name, curve[0][1], curve[-1][1], p[1], file=sys.stderr)
usage = resource.getrusage(resource.RUSAGE_SELF)
print(f"wall {time.perf_counter() - start:.2f} s (parsing {parsed - start:.2f}), "
      f"cpu {usage.ru_utime + usage.ru_stime:.2f} s, peak {usage.ru_maxrss / 1024:.0f} MB")
