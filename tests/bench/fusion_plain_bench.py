"""MINQUE with a matrix for everything at every instant, as [RV 4, 5] writes it, in interpreted code; against
`fusion_bench matrices`.

    /usr/bin/python3 tests/bench/fusion_plain_bench.py [--build build] [--rounds 20]

Needs python3-numpy from Debian. Every instant builds H of the sensors that are not flagged, P = I - H
(H'H)^-1 H', P o P and its inverse, the moments of the residuals, the variances, R, R^-1 and the weighted
mean: what the text says, with numpy's inv or pinv, no use of H = 1 or of R being diagonal. Prints the best of
the rounds and ratios; asserts nothing.
"""
import argparse
import pathlib
import re
import subprocess
import time

import numpy as np

options = argparse.ArgumentParser()
options.add_argument("--build", default=str(pathlib.Path(__file__).resolve().parents[2] / "build"))
options.add_argument("--rounds", type=int, default=20)
options = options.parse_args()


def plain_minque(y, invert, gamma=0.999, threshold=1e4):
    n, instants = y.shape
    mean, moment, variances = np.zeros(n), np.zeros(n), np.zeros(n)
    healthy = np.arange(n)
    estimates = np.empty(instants)
    for k in range(instants):
        m = len(healthy)
        h = np.ones((m, 1))
        samples = y[healthy, k]
        p = np.eye(m) - h @ np.linalg.inv(h.T @ h) @ h.T
        delta = p @ samples - mean[healthy]
        moment[healthy] = gamma * (moment[healthy] + (1 - gamma) * delta * delta)
        mean[healthy] += (1 - gamma) * delta
        variances[healthy] = np.maximum(np.abs(invert(p * p) @ moment[healthy]), 1e-12)
        r_inverse = np.linalg.inv(np.diag(variances[healthy]))
        estimates[k] = (np.linalg.inv(h.T @ r_inverse @ h) @ h.T @ r_inverse @ samples)[0]
        healthy = np.flatnonzero(variances < threshold)
    return estimates


ours = subprocess.run([f"{options.build}/tests/bench/fusion_bench", "matrices"], check=True, capture_output=True,
                      text=True).stdout
ours = {int(n): float(ns) for n, ns in re.findall(r"n = (\d+) +([0-9.]+)", ours)}
generator = np.random.default_rng(3)
print(f"MINQUE, ns a step; numpy {np.__version__}")
print(f"{'':>8}{'minque':>10}{'numpy, inv (ratio)':>24}{'numpy, pinv (ratio)':>24}")
for n, ns in ours.items():
    noise = np.sqrt(np.linspace(1, 7, n))[:, None]
    y = 2 * generator.standard_normal(100) + noise * generator.standard_normal((n, 100))
    line = f"n = {n:<4}{ns:>10.1f}"
    for invert in (np.linalg.inv, np.linalg.pinv):
        best = float("inf")
        for _ in range(options.rounds):
            start = time.perf_counter()
            estimates = plain_minque(y, invert)
            best = min(best, 1e9 * (time.perf_counter() - start) / y.shape[1])
        assert np.isfinite(estimates).all()
        line += f"{f'{best:.0f} ({best / ns:.0f})':>24}"
    print(line)
