"""Whole jobs of the program, and what people run today for the same where it is installed: wall time,
processor time, peak memory.

    python3 tests/bench/jobs_bench.py [--build build] [--rounds 5] [--only WORD] [--folder FOLDER]

Jobs of a round are interleaved with their peers. A ratio is the peer's time over ours, the median of the
rounds with the least and the largest. Peers: R's data.table (r-cran-data.table) for reading, Python
(python3-pandas, python3-scipy; /usr/bin/python3) for the whole. One that is not installed is left out and
said. Inputs are made once, 3 GB in --folder (default: a temporary one). Nothing is asserted.
"""
import argparse
import os
import pathlib
import shutil
import statistics
import subprocess
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent

MAKE = """
import sys
import numpy as np
kind, path = sys.argv[1:]
rng = np.random.default_rng(1)
if kind == "npy7":
    np.save(path, rng.standard_normal(10**7) + 1e-4 * np.cumsum(rng.standard_normal(10**7)))
elif kind == "npy8":
    out = np.lib.format.open_memmap(path, "w+", np.float64, (10**8,))
    walk = 0.0
    for k in range(100):
        steps = 1e-5 * np.cumsum(rng.standard_normal(10**6))
        out[k * 10**6:(k + 1) * 10**6] = rng.standard_normal(10**6) + walk + steps
        walk += steps[-1]
else:
    values = rng.standard_normal((14442, 40)) + 0.01 * np.cumsum(rng.standard_normal((14442, 40)), axis=0)
    table = np.column_stack((np.arange(14442) / 100, values))
    np.savetxt(path, table, fmt="%.6f", delimiter=",", header="t[s]," + ",".join(f"s{k}" for k in range(40)), comments="")
"""
FREAD = "library(data.table); setDTthreads({threads}); x <- fread('{file}'); cat(nrow(x))"


def peers_installed():
    def works(*words):
        try:
            return subprocess.run(words, capture_output=True).returncode == 0
        except OSError:
            return False
    return {"fread": works("Rscript", "-e", "library(data.table)"),
            "python": works("/usr/bin/python3", "-c", "import pandas, scipy")}


def jobs(program, cores, python):
    """(name, input, our words, peer's name, peer's words)"""
    def fread(name):
        return ["Rscript", "-e", FREAD.format(threads=cores, file=name)]
    return [
        ("inspect, 10⁷ × 7 CSV", "csv7", [program, "inspect", "csv7.csv"], "fread", fread("csv7.csv")),
        ("characterize, 10⁷ × 7 CSV, segments of 65536", "csv7",
         [program, "characterize", "csv7.csv", "-o", "out", "--force", "--quiet", "--segment", "65536"], "python",
         [*python, "csv7.csv", "65536"]),
        ("characterize, 10⁷ × 7 CSV, segments of N/4", "csv7",
         [program, "characterize", "csv7.csv", "-o", "out", "--force", "--quiet"], "python",
         [*python, "csv7.csv", "0"]),
        ("characterize, 40 × 14,442 CSV", "csv40",
         [program, "characterize", "csv40.csv", "-o", "out", "--force", "--quiet"], "python",
         [*python, "csv40.csv", "0"]),
        ("characterize, 10⁸ samples .npy, segments of N/4", "npy8",
         [program, "characterize", "npy8.npy", "--rate", "100", "-o", "out", "--force", "--quiet"], "", []),
        ("characterize, 10⁸ samples .npy, segments of 65536", "npy8",
         [program, "characterize", "npy8.npy", "--rate", "100", "-o", "out", "--force", "--quiet", "--segment",
          "65536"], "", []),
        ("allan --taus dense, 10⁷ samples, 1,740 times", "npy7",
         [program, "allan", "npy7.npy", "--rate", "100", "--taus", "dense", "-o", "out.csv", "--force", "--quiet"],
         "", []),
        ("the same with --full-overlap", "npy7",
         [program, "allan", "npy7.npy", "--rate", "100", "--taus", "dense", "--full-overlap", "-o", "out.csv",
          "--force", "--quiet"], "", []),
    ]


def make(kind, folder, build):
    name = folder / {"csv7": "csv7.csv", "csv40": "csv40.csv", "npy7": "npy7.npy", "npy8": "npy8.npy"}[kind]
    if name.exists():
        return
    if kind == "csv7":
        subprocess.run([str(build / "tests/bench/make_log_bench"), str(name)], check=True, stdout=subprocess.DEVNULL)
    else:
        subprocess.run(["/usr/bin/python3", "-c", MAKE, kind, str(name)], check=True)


def timed(words, folder):
    """Wall seconds, processor seconds, peak MB."""
    begin = time.perf_counter()
    process = subprocess.Popen(words, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        raise SystemExit(f"{' '.join(words)} failed")
    return time.perf_counter() - begin, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def ratio(theirs, ours, which):
    found = [t[which] / o[which] for t, o in zip(theirs, ours)]
    return f"{statistics.median(found):.1f} ({min(found):.1f}–{max(found):.1f})"


def row(name, ours, peer, theirs):
    wall, cpu, peak = (statistics.median(run[k] for run in ours) for k in range(3))
    cells = [name, f"{wall:.2f}", f"{cpu:.2f}", f"{peak:.0f}"]
    cells += [peer, ratio(theirs, ours, 0), ratio(theirs, ours, 1)] if theirs else ["–"] * 3
    return "| " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=HERE.parent.parent / "build")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--only", default="", help="jobs whose name has this word")
    parser.add_argument("--folder", type=pathlib.Path)
    options = parser.parse_args()
    build = options.build.resolve()
    folder = options.folder.resolve() if options.folder else pathlib.Path(tempfile.mkdtemp(prefix="jobs-bench-"))
    folder.mkdir(parents=True, exist_ok=True)
    python = ["/usr/bin/python3", str(HERE / "python_pipeline.py")]
    there = peers_installed()
    try:
        print("| job | wall s | CPU s | peak MB | against | wall ratio | CPU ratio |\n|---|---|---|---|---|---|---|")
        for name, kind, ours, peer, theirs in jobs(str(build / "tools/sensorchar"), len(os.sched_getaffinity(0)),
                                                   python):
            if options.only not in name:
                continue
            make(kind, folder, build)
            mine, others = [], []
            for _ in range(options.rounds):
                mine.append(timed(ours, folder))
                if there.get(peer):
                    others.append(timed(theirs, folder))
            print(row(name, mine, peer, others), flush=True)
        missing = [name for name, installed in there.items() if not installed]
        if missing:
            print(f"\nNot installed, left out: {', '.join(missing)}.")
    finally:
        if not options.folder:
            shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
