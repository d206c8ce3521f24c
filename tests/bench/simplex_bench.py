"""neural-simplex against its baseline (minque) on arrays that nobody wrote for it: sensors of eight kinds, with faults,
with and without a reference, n = 3, 4, 6, 12, made here and not by the program. Prints one line per kind, and in how
many arrays it is worse than the baseline by more than 1 % (must be none).

usage: simplex_bench.py PROGRAM [SEEDS [KIND…]]      needs NumPy
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

RATE, N = 100.0, 24000


def filtered(x, corner):
    a = 1 - np.exp(-2 * np.pi * corner / RATE)
    out, y = np.empty_like(x), x[0]
    for k, v in enumerate(x):
        y += a * (v - y)
        out[k] = y
    return out


def signal(rng):
    """The true input: sines, noise of a band, or moves and stops; standard deviation about one."""
    t = np.arange(N) / RATE
    kind = rng.integers(4)
    if kind == 0:
        f = rng.uniform(0.05, 3, 4)
        return sum(np.sin(2 * np.pi * (v * t + rng.uniform())) for v in f) / np.sqrt(2)
    if kind == 1:
        x = filtered(filtered(rng.normal(size=N), rng.uniform(0.3, 5)), 5)
        return x / x.std()
    if kind == 2:
        x = np.repeat(rng.normal(size=N // 200), 200)
        return filtered(x, 1.0)
    x = rng.normal(size=N)
    return x


def play(x, width):
    """Backlash: the output follows when the input has crossed the gap."""
    y, out = x[0], np.empty_like(x)
    for k, v in enumerate(x):
        y = min(max(y, v - width), v + width)
        out[k] = y
    return out


def linear(x, i, rng):
    return x


def uncalibrated(x, i, rng):
    return (1 + 0.1 * rng.normal()) * x + 0.2 * rng.normal()


def nonlinear(x, i, rng):
    return x + rng.uniform(-0.15, 0.15) * x ** 2 + rng.uniform(-0.08, 0.08) * x ** 3


def saturating(x, i, rng):
    limit = rng.uniform(0.8, 2.5)
    return limit * np.tanh(x / limit)


def clipped(x, i, rng):
    return np.clip(x, -rng.uniform(0.7, 2), rng.uniform(0.7, 2))


def hysteretic(x, i, rng):
    return play(x, rng.uniform(0.1, 0.5)) * (1 + 0.02 * rng.normal())


def lagging(x, i, rng):
    return filtered(x, rng.uniform(2, 20))


def drifting(x, i, rng):
    return x + 0.002 * np.cumsum(rng.normal(size=N))


KINDS = [linear, uncalibrated, nonlinear, saturating, clipped, hysteretic, lagging, drifting]
NONLINEAR = {"uncalibrated", "nonlinear", "saturating", "clipped", "hysteretic", "lagging"}


def fault(y, which, rng):
    """Something happens to one sensor in the second half."""
    at = int(rng.integers(14000, 20000))
    y = y.copy()
    if which == 1:
        y[at:] += 0.5
    elif which == 2:
        y[at:] *= 0.8
    elif which == 3:
        y[at:] = y[at]
    elif which == 4:
        y[at:] += 0.5 * rng.normal(size=N - at)
    elif which == 5:
        y[at:at + 2000] = np.nan
    elif which == 6:
        y[at:] += 0.6 * np.minimum(1, np.arange(N - at) / 4000)
    return y


def array(kind, n, seed):
    rng = np.random.default_rng(seed)
    x = signal(rng)
    sensors = []
    for i in range(n):
        white = 0.05 * np.exp(rng.normal())
        sensors.append(kind(x, i, rng) + white * rng.normal(size=N))
    which = seed % 7
    if which:
        j = int(rng.integers(n))
        sensors[j] = fault(sensors[j], which, rng)
    names = ["t_s"] + ["s%d" % (i + 1) for i in range(n)] + ["truth"]
    out = np.zeros(N, dtype=[(name, "<f8") for name in names])
    out["t_s"] = np.arange(N) / RATE
    out["truth"] = x
    for i, y in enumerate(sensors):
        out["s%d" % (i + 1)] = y
    return out


def replay(program, made, n, reference):
    with tempfile.TemporaryDirectory() as folder:
        log = pathlib.Path(folder) / "array.npy"
        np.save(log, made)
        learning = ["--learning", "0..120" if reference else "none", "--evaluation", "120..240"]
        command = [program, "replay", str(log), "--sensors", ",".join("s%d" % (i + 1) for i in range(n)),
                   "--reference", "truth", "--algorithms", "minque,neural-simplex", "-o", folder + "/r",
                   "--json", "--quiet", "--no-allan"] + learning
        run = subprocess.run(command, capture_output=True, text=True)
        if "E0905" in run.stderr:
            return None  # a sensor that is frozen is left out, and two are too few for the baseline
        if run.returncode != 0:
            sys.exit("%s\n%s" % (" ".join(command), run.stderr))
        report = json.loads(run.stdout)
    found = {a["name"]: a for a in report["algorithms"]}
    one = found["neural-simplex"]
    return found["minque"]["rmse"], one["rmse"], one.get("hand_overs") or 0, one["ns_per_sample"]


def main():
    program, seeds = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 4
    wanted = sys.argv[3:]
    worse, all_arrays, gains = [], 0, {}
    print("%-13s %-4s %9s %9s %9s %9s" % ("kind", "ref", "arrays", "median", "worst", "switches"))
    for kind in KINDS:
        if wanted and kind.__name__ not in wanted:
            continue
        for reference in (True, False):
            ratios, switches = [], 0
            for n in (3, 4, 6, 12):
                for seed in range(seeds):
                    key = (kind.__name__, n, 1000 * n + seed)
                    found = replay(program, array(kind, n, key[2]), n, reference)
                    if found is None:
                        continue
                    before, after, handed, _ = found
                    ratios.append(after / before)
                    switches += handed
                    if after > 1.01 * before:
                        worse.append(key + (reference, round(after / before, 3)))
            all_arrays += len(ratios)
            gains.setdefault((kind.__name__ in NONLINEAR, reference), []).extend(ratios)
            print("%-13s %-4s %9d %9.3f %9.3f %9d" % (kind.__name__, "yes" if reference else "no", len(ratios),
                                                      np.median(ratios), max(ratios), switches), flush=True)
    for (bent, reference), ratios in sorted(gains.items()):
        print("%s, %s reference: RMSE / baseline median %.3f, best %.3f, worst %.3f" % (
            "not calibrated or not linear" if bent else "linear", "with" if reference else "without",
            np.median(ratios), min(ratios), max(ratios)))
    print("arrays: %d, worse than the baseline by more than 1 %%: %d" % (all_arrays, len(worse)))
    for row in worse:
        print("  ", row)
    sys.exit(6 if worse else 0)


main()
