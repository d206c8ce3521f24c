"""Rates and missing samples that the program finds in stamps of known truth: jitter, delays, pauses, gaps, packets (of
one stamp, near stamps, random sizes), turns and coarse clocks in seven units and rates; then packets of which some are
lost. Prints each that is wrong: a rate off by a thousandth, missing samples off by more than a few. The rows hold white
noise, each time another one: prints how often the 95 % interval of N holds the truth, and each N that is further away
than three times its interval.

usage: stamp_patterns.py PROGRAM    (needs NumPy)
"""
import datetime
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

program = sys.argv[1]
here = tempfile.TemporaryDirectory()
log = pathlib.Path(here.name) / "log.csv"
HEADS = {"s": "t [s]", "ms": "time_ms", "us": "timestamp_us", "ns": "timestamp_ns", "iso": "time"}


def texts(times, unit):
    if unit == "iso":
        first = datetime.datetime(2024, 5, 1)
        return [(first + datetime.timedelta(seconds=float(t))).isoformat(timespec="milliseconds") for t in times]
    if unit == "s":
        return [f"{t:.6f}" for t in times]
    scale, zero = {"ms": (1e3, 0), "us": (1e6, 0), "ns": (1e9, 1700000000000000000)}[unit]
    return [str(zero + int(round(float(t) * scale))) for t in times]


SIGMA = 0.01  # of the noise


def written(times, unit, seed):
    noise = np.random.default_rng(seed).normal(0.2, SIGMA, len(times))
    log.write_text(HEADS[unit] + ",w [deg/s]\n" +
                   "".join(f"{t},{v:.5f}\n" for t, v in zip(texts(times, unit), noise)))


def found():
    """Rate and missing samples that inspect prints; None where it refuses."""
    out = subprocess.run([program, "inspect", log], capture_output=True, text=True).stdout
    said = re.search(r", ([0-9.e+-]+) (k?Hz)[^,]*, [^,]*, \d+ gaps?(?: \((\d+) missing)?", out)
    return (float(said[1]) * (1000 if said[2] == "kHz" else 1), int(said[3] or 0)) if said else None


def miss_of_noise(rate):
    """How far the true N is from the middle of its interval, in half widths; None where there is none."""
    out = subprocess.run([program, "fit", log, "--json"], capture_output=True, text=True).stdout
    term = json.loads(out)["channels"][0]["white_noise"] if out else {}
    if not term.get("ci95"):
        return None
    low, high = np.log(term["ci95"])
    return abs(np.log(SIGMA / np.sqrt(rate)) - (low + high) / 2) / ((high - low) / 2)


def causes(draw, rate, n):
    """name: stamps in s, missing samples (None: not judged)"""
    k, dt = np.arange(n), 1 / rate
    rising = np.maximum.accumulate
    ends = np.minimum(n, np.cumsum(draw.integers(3, 8, n)))
    ends = ends[np.searchsorted(ends, k, side="right")]
    lost = np.ones(n, bool)
    for at in draw.integers(10, n - 60, 12):
        lost[at:at + draw.integers(1, 30)] = False
    packet = (k // 8 + 1) * 8 * dt
    late = np.repeat(draw.gamma(2, 0.2 * dt, n // 8 + 1), 8)[:n]
    return {
        "even": (k * dt, 0),
        "jitter .1": (k * dt + draw.normal(0, 0.1 * dt, n), 0),
        "jitter .3, held back": (rising(k * dt + draw.normal(0, 0.3 * dt, n)), 0),
        "delays": (rising(k * dt + draw.gamma(1.0, 0.5 * dt, n)), 0),
        "a pause": (k * dt + (k >= n // 3) * 573 * dt, None),
        "gaps": ((k * dt)[lost], int((~lost).sum())),
        "packets of one stamp": (packet, 0),
        "packets of near stamps": (packet + (k % 8) * dt * 0.02, 0),
        "late packets": (packet + late + (k % 8) * dt * 0.02, 0),
        "packets of random size": (ends * dt, 0),
        "turns of two": (k * dt - (k % 2 == 1) * 0.37 * dt, 0),
        "turns of three": (k * dt - np.array([0, 0.6, 0.2])[k % 3] * dt, 0),
        "a clock of 7 samples": (np.floor(k / 7) * 7 * dt, 0),
        "a clock of 1.7 samples": (np.floor(k / 1.7) * 1.7 * dt, 0),
    }


def lost_packets(draw, rate, n, rows, jitter, share):
    k = np.arange(n)
    at = (k // rows + 1) * rows / rate + np.repeat(draw.gamma(2, jitter * rows / rate / 4, n // rows + 1), rows)[:n]
    gone = draw.choice(np.arange(5, n // rows - 5), int(share * n / rows), replace=False)
    keep = ~np.isin(k // rows, gone)
    return np.maximum.accumulate(at[keep]), int((~keep).sum())


wrong = tried = 0
misses = []


def judge(what, times, unit, rate, missing, margin):
    global wrong, tried
    tried += 1
    written(times, unit, tried)
    answer = found()
    if answer:
        misses.append(miss_of_noise(rate))
        if misses[-1] is None or misses[-1] > 3:
            print(f"{what}, {rate} Hz in {unit}: N is {misses[-1]} half intervals away")
    if answer and abs(answer[0] / rate - 1) < 1e-3 and (missing is None or abs(answer[1] - missing) <= margin):
        return
    wrong += 1
    print(f"{what}, {rate} Hz in {unit}: {answer}, right are {rate} Hz and {missing} missing")


for rate, unit in ((100.0, "s"), (100.0, "us"), (62.5, "ms"), (200.0, "ns"), (13.7, "iso"), (1.0, "s"), (833.0, "us")):
    for what, (times, missing) in causes(np.random.default_rng(int(rate * 10)), rate, 8000).items():
        judge(what, times, unit, rate, missing, 3)
for rows in (3, 5, 8, 10, 16, 32):
    for jitter in (0, 0.05, 0.15):
        for unit in ("ms", "us"):
            for share in (0.01, 0.03):
                draw = np.random.default_rng(rows * 100 + int(jitter * 100))
                times, missing = lost_packets(draw, 104.0, 20000, rows, jitter, share)
                what = f"packets of {rows}, {jitter} late, {share} lost"
                judge(what, times, unit, 104.0, missing, max(6, 0.1 * missing))
held = sum(miss is not None and miss <= 1 for miss in misses)
print(f"{tried} patterns, {wrong} wrong; N inside its interval in {held} of {len(misses)}")
