"""How time and memory grow with what is given: growth_bench.py PROGRAM [--only WORD] [--scale 1]

Each row is one command with ever more samples, channels, sensors, points, devices or files. Time is the processor's
(user and system), memory the peak. The exponent is the slope of the logarithms of what was added to the smallest size,
by least squares: 1 is linear, 2 quadratic. Prints a table in Markdown; asserts nothing.
"""
import argparse
import math
import os
import pathlib
import random
import shutil
import statistics
import struct
import subprocess
import sys
import tempfile


def measured(words, folder):
    """Processor seconds and peak MB of a command that must succeed."""
    process = subprocess.Popen(words, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    said = process.stderr.read()
    _, status, used = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(map(str, words))}: {said.decode()[-300:]}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def noise(folder, name, *shape, seed=7):
    """White noise of whole numbers. Written in pieces: a child's peak begins with the memory of this process."""
    with open(folder / name, "wb") as file:
        head = f"{{'descr': '<i2', 'fortran_order': False, 'shape': {shape}, }}"
        head += " " * (-(len(head) + 11) % 64) + "\n"
        file.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode())
        numbers, left = random.Random(seed), 2 * math.prod(shape)
        while left > 0:
            left -= file.write(numbers.randbytes(min(left, 1 << 16)))


def samples(folder, n):
    noise(folder, "a.npy", n, 3)
    return ["characterize", "a.npy", "--rate", "100", "-o", "out"]


def channels(folder, n):
    noise(folder, "a.npy", 2000, n)
    return ["characterize", "a.npy", "--rate", "100", "-o", "out"]


def sensors(folder, n):
    noise(folder, "a.npy", 2000, n)
    return ["replay", "a.npy", "--sensors", "c*", "--rate", "100", "--algorithms",
            "mean,median,inverse-variance,best-sensor", "-o", "out"]


def points(folder, n):
    with open(folder / "curve.csv", "w") as file:
        file.write("tau_s,adev\n")
        for k in range(n):
            file.write(f"{0.01 * 10**(6 * k / n)},{10**(-3 * k / n)}\n")
    return ["plot", "curve.csv", "-o", "out.svg"]


def logs(folder, n):
    (folder / "logs").mkdir()
    for k in range(n):
        noise(folder, f"logs/d{k:05}.npy", 500, seed=k)


def devices(folder, n):
    logs(folder, n)
    measured([PROGRAM, "fleet", "plan", "logs/*.npy", "--rate", "100", "--no-reports", "-o", "fleet"], folder)
    measured([PROGRAM, "fleet", "run", "fleet", "--quiet"], folder)
    return ["fleet", "merge", "fleet", "-o", "out"]


def files(folder, n):
    logs(folder, n)
    return ["inspect", *(f"logs/d{k:05}.npy" for k in range(n)), "--rate", "100"]


ROWS = [("samples (of 3 channels)", samples, "characterize", [250_000, 500_000, 1_000_000, 2_000_000, 4_000_000]),
        ("channels (of 2,000 samples)", channels, "characterize", [125, 250, 500, 1000, 2000]),
        ("sensors (of 2,000 samples)", sensors, "replay, four methods", [50, 100, 200, 400, 800]),
        ("points of a curve", points, "plot", [12_500, 25_000, 50_000, 100_000, 200_000]),
        ("devices (of 500 samples)", devices, "fleet merge", [125, 250, 500, 1000, 2000]),
        ("files (of 500 samples)", files, "inspect", [125, 250, 500, 1000, 2000])]


def exponent(sizes, values):
    """What grows by less than a quarter over all sizes has none."""
    if values[-1] < 1.25 * values[0]:
        return "–"
    x = [math.log(size - sizes[0]) for size in sizes[1:]]
    y = [math.log(max(value - values[0], 1e-3)) for value in values[1:]]
    return f"{statistics.linear_regression(x, y).slope:.2f}"


def main():
    global PROGRAM
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--scale", type=float, default=1, help="of all sizes")
    options = parser.parse_args()
    PROGRAM = str(options.program.resolve())
    print("| more | command | from | to | CPU s | exponent | peak MB | exponent |\n|---|---|---|---|---|---|---|---|")
    for name, prepare, command, sizes in ROWS:
        if options.only not in name:
            continue
        sizes, rows = [round(size * options.scale) for size in sizes], []
        for size in sizes:
            folder = pathlib.Path(tempfile.mkdtemp(prefix="growth-"))
            try:
                words = prepare(folder, size)
                rows.append(measured([PROGRAM, *words], folder))
            finally:
                shutil.rmtree(folder)
        seconds, peaks = zip(*rows)
        print(f"| {name} | {command} | {sizes[0]:,} | {sizes[-1]:,} | {seconds[0]:.2f} … {seconds[-1]:.2f} | "
              f"{exponent(sizes, seconds)} | {peaks[0]:.0f} … {peaks[-1]:.0f} | {exponent(sizes, peaks)} |",
              flush=True)


if __name__ == "__main__":
    main()
