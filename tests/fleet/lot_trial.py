#!/usr/bin/env python3
"""Lots of devices with known coefficients, from a generator that shares nothing with the library: are their
means and spreads in the intervals of the lot's report?

usage: lot_trial.py PROGRAM FOLDER --generator make_records.py [--lots 20] [--devices 200] [--samples 131072]
       [--spread lognormal|normal] [--seed 0]

N is 5e-3 and its spread 10 %, B 5e-3 and 20 %, K 1.5e-3 and 30 %, at 100 Hz. Each lot is written to FOLDER,
planned, run and merged by the program, and removed. The generator is a Python file with `Scene(options,
rng).noise()` (../shared/oracle/records has it). Prints how many lots hold each truth: the geometric mean and
the spread of the logarithm for a lognormal spread, the arithmetic mean and the standard deviation for both.
Needs python3-numpy and what the generator needs.
"""

import argparse
import importlib.util
import json
import pathlib
import shutil
import subprocess
import types

import numpy as np

TRUTH = {"white_noise": ("Q", 5e-3, 0.10), "bias_instability": ("B", 5e-3, 0.20), "random_walk": ("K", 1.5e-3, 0.30)}


def write_lot(folder, generator, lot, options):
    folder.mkdir(parents=True)
    own = np.random.default_rng([options.seed, lot])
    rows = ["device,log,type"]
    for device in range(options.devices):
        coefficients = {}
        for letter, mean, spread in TRUTH.values():
            z = spread * own.standard_normal()
            coefficients[letter] = mean * (np.exp(z) if options.spread == "lognormal" else max(0.05, 1 + z))
        scene = generator.Scene(types.SimpleNamespace(samples=options.samples, rate=100.0, **coefficients),
                                np.random.default_rng([options.seed, lot, device]))
        np.save(folder / f"d{device:04d}.npy", scene.noise())
        rows.append(f"d{device:04d},d{device:04d}.npy,made")
    (folder / "lot.csv").write_text("\n".join(rows) + "\n")


def merged(program, folder):
    for words in (["plan", folder / "lot.csv", "--rate", "100", "-o", folder / "fleet", "--no-reports"],
                  ["run", folder / "fleet", "--quiet"], ["merge", folder / "fleet", "-o", folder / "report"]):
        subprocess.run([program, "fleet", *map(str, words)], check=True, capture_output=True)
    return json.loads((folder / "report" / "lot.json").read_text())


def held(quantity, mean, spread, lognormal):
    plain = quantity["arithmetic"] or {}
    of = {
        "arithmetic mean": (plain.get("mean_ci95"), mean * np.exp(spread**2 / 2) if lognormal else mean),
        "standard deviation": (plain.get("sd_ci95"), mean * np.exp(spread**2 / 2) * np.sqrt(np.expm1(spread**2))
                               if lognormal else mean * spread),
    }
    if lognormal:
        of = {"mean": (quantity["mean_ci95"], mean), "spread": (quantity["spread_ci95"], spread), **of}
    return {what: interval is not None and interval[0] <= truth <= interval[1]
            for what, (interval, truth) in of.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--generator", required=True)
    parser.add_argument("--lots", type=int, default=20)
    parser.add_argument("--devices", type=int, default=200)
    parser.add_argument("--samples", type=int, default=131072)
    parser.add_argument("--spread", choices=["lognormal", "normal"], default="lognormal")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    spec = importlib.util.spec_from_file_location("generator", options.generator)
    generator = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(generator)
    tally, detected = {}, {}
    for lot in range(options.lots):
        folder = options.folder / f"lot{lot}"
        write_lot(folder, generator, lot, options)
        for quantity in merged(options.program, folder)["quantities"]:
            if quantity["what"] not in TRUTH or quantity["of_kind"]:
                continue
            letter, mean, spread = TRUTH[quantity["what"]]
            detected.setdefault(letter, []).append(quantity["counted"] / quantity["members"])
            for what, good in held(quantity, mean, spread, options.spread == "lognormal").items():
                tally.setdefault((letter, what), []).append(good)
        shutil.rmtree(folder)
    for (letter, what), good in tally.items():
        print(f"{letter}, detected in {100 * np.mean(detected[letter]):.0f} %: {what} in its interval in "
              f"{sum(good)} of {len(good)} lots")


if __name__ == "__main__":
    main()
