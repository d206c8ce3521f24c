"""Writes docs/performance.md: what every program of tests/bench says on this machine, with the commands. Best
on a quiet machine; about 15 min.

    python3 tests/bench/performance_page.py [--build build] [--rounds 5] [--output docs/performance.md]

A program that needs what is not installed is left out, and the page says so.
"""
import argparse
import os
import pathlib
import platform
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent

# Title, what is to be known beforehand, words of the command ({build}, {rounds}, {folder}), a table in
# Markdown already.
SECTIONS = [
    ("Whole jobs", "Medians of rounds in which our job and its peer take turns; in brackets the least and the "
                   "largest. Python does no hash, fit, quality or report.",
     ["python3", "tests/bench/jobs_bench.py", "--build", "{build}", "--rounds", "{rounds}", "--folder", "{folder}"],
     True),
    ("Reading CSV", "`parse/from_ch.`: our parser over a plain loop of `std::from_chars` on the same bytes. "
                    "`comma`: decimal commas.",
     ["{build}/tests/bench/csv_bench", "100"], False),
    ("Allan deviation", "Speed compared with memcpy, and the largest relative error against 128-bit fixed point under "
                        "offsets and drifts.",
     ["{build}/tests/bench/allan_bench", "7"], False),
    ("Spectrum", "", ["{build}/tests/bench/spectrum_bench"], False),
    ("Simulation", "Flicker, white noise and random walk.", ["{build}/tests/bench/noise_bench"], False),
    ("Simulation in Python", "The same with NumPy and SciPy.", ["/usr/bin/python3", "tests/bench/noise_bench.py"],
     False),
    ("Replay", "Every algorithm on 12 sensors of 10⁶ samples that stream from CSV.",
     ["python3", "tests/bench/replay_bench.py", "--program", "{build}/tools/sensorchar"], False),
    ("Growth", "Processor time and peak memory of one command with ever more of something; 1 is linear.",
     ["python3", "tests/bench/growth_bench.py", "{build}/tools/sensorchar"], True),
]


def output(*words):
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    return done.stdout.strip() if done.returncode == 0 else ""


def processor():
    facts = [line.split(":", 1) for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines() if ":" in line]
    about = {key.strip(): value.strip() for key, value in reversed(facts)}
    if "model name" not in about:
        return platform.machine()
    return f"{about['model name']} (family {about.get('cpu family', '?')}, model {about.get('model', '?')})"


def machine(build):
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    version = output(str(build / "tools/sensorchar"), "--version").splitlines()[0]
    return (f"{version}; {processor()}, {len(os.sched_getaffinity(0))} cores, {memory:.0f} GB, "
            f"{output('uname', '-sr')}, "
            f"{output('c++', '--version').splitlines()[0]}; {time.strftime('%d %B %Y', time.gmtime()).lstrip('0')}")


def section(title, about, words, is_table, values):
    command = [word.format(**values) for word in words]
    shown = " ".join(words).format(**{**values, "build": "build", "folder": "FOLDER"})
    print(f"{title}: {shown}", file=sys.stderr, flush=True)
    begin, load = time.monotonic(), os.getloadavg()[0]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    lines = [f"## {title}"] + ([about] if about else []) + ["", f"    {shown}", ""]
    if done.returncode != 0:
        last = (done.stderr.strip().splitlines() or ["?"])[-1]
        return lines + [f"Left out: {last}", ""]
    said = done.stdout.rstrip().splitlines()
    lines += said if is_table else ["```text", *(line.rstrip() for line in said), "```"]
    return lines + ["", f"{time.monotonic() - begin:.0f} s; load of the machine before it {load:.1f}.", ""]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--folder", help="where the inputs of whole jobs are, or will be (3 GB)")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "docs" / "performance.md")
    options = parser.parse_args()
    build = options.build.resolve()
    with tempfile.TemporaryDirectory() as scratch:
        values = {"build": str(build), "rounds": str(options.rounds), "folder": options.folder or scratch}
        page = ["# Performance", "",
                "Written by `.ci/figures performance`: the programs of `tests/bench`, as they print. Where the time "
                "of the main job goes, and what was tried: "
                "[dev/speed.md](dev/speed.md). Error against time: [accuracy.md](accuracy.md).", "",
                machine(build) + ".", ""]
        for row in SECTIONS:
            page += section(*row, values)
    options.output.write_text("\n".join(page).rstrip() + "\n")


if __name__ == "__main__":
    main()
