"""Simulated noise against numpy and scipy: flicker + white + random walk of one length, CPU time, interleaved
in one run.

    /usr/bin/python3 tests/bench/noise_bench.py [--build build] [--samples 8388608] [--rounds 3]

Needs python3-numpy and python3-scipy from Debian. Prints the best of the rounds and ratios; asserts nothing.
The program's own table also has the same methods in C++ with FFTW.
"""
import argparse
import pathlib
import re
import subprocess
import sys
import time

import numpy as np
import scipy.fft
import scipy.signal

here = pathlib.Path(__file__).resolve().parent
options = argparse.ArgumentParser()
options.add_argument("--build", default=str(here.parent.parent / "build"))
options.add_argument("--samples", type=int, default=1 << 23)
options.add_argument("--rounds", type=int, default=3)
options = options.parse_args()
n = options.samples
generator = np.random.Generator(np.random.PCG64(1))  # numpy's default and fastest


def with_white_and_walk(flicker):
    white = 0.07 * generator.standard_normal(flicker.size)
    return 1e-3 * flicker + white + np.cumsum(7e-6 * generator.standard_normal(flicker.size))


def shaped_spectrum():
    """The usual recipe for 1/f noise: normal spectrum times f^-1/2, one inverse transform (wraps around)."""
    k = np.arange(1, n // 2 + 1)
    spectrum = np.zeros(n // 2 + 1, complex)
    spectrum[1:] = (generator.standard_normal(k.size) + 1j
                    * generator.standard_normal(k.size)) / np.sqrt(4 * np.sin(np.pi * k / n))
    return with_white_and_walk(scipy.fft.irfft(spectrum, n) * np.sqrt(n)), n


def exact_convolution():
    """Kasdin's response convolved with the record, padded so that nothing wraps around."""
    k = np.arange(1, n)
    response = np.concatenate([[1.0], np.cumprod((k - 0.5) / k)])
    return with_white_and_walk(scipy.signal.fftconvolve(response, generator.standard_normal(n))[:n]), n


def truncated_filter():
    """Recursive filter of 1000 coefficients, on an eighth of the record."""
    k = np.arange(1, 1001)
    coefficients = np.concatenate([[1.0], np.cumprod((k - 1.5) / k)])
    return with_white_and_walk(scipy.signal.lfilter([1.0], coefficients, generator.standard_normal(n // 8))), n // 8


def three_deviates():
    """White noise alone costs this much, three times."""
    for _ in range(3):
        last = generator.standard_normal(n)
    return last, n


def ours():
    """User CPU of the program, from its own report."""
    text = subprocess.run([f"{options.build}/tests/bench/noise_bench", "--memory", str(n)], check=True,
                          capture_output=True, text=True).stdout
    found = re.search(r"([\d.]+) ns/sample", text)
    if not found:
        sys.exit("noise_bench printed: " + text)
    return float(found[1])


ways = (shaped_spectrum, exact_convolution, truncated_filter, three_deviates)
best = {"sensorchar": float("inf")} | {way.__name__: float("inf") for way in ways}
for _ in range(options.rounds):
    best["sensorchar"] = min(best["sensorchar"], ours())
    for way in ways:
        start = time.process_time()
        samples = way()[1]
        best[way.__name__] = min(best[way.__name__], (time.process_time() - start) / samples * 1e9)
print(f"{n} samples, CPU time, best of {options.rounds} interleaved; numpy {np.__version__}")
for name, value in best.items():
    print(f"{value:10.2f} ns/sample   x {value / best['sensorchar']:6.2f}   {name}")
