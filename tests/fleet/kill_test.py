"""Workers of a fleet that are killed, that work on the same units, that have no room to write: in the end the
results are those of one process.

usage: kill_test.py PROGRAM
"""
import os
import pathlib
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time

program = os.path.abspath(sys.argv[1])
rng = random.Random(5)
faults = []


def expect(holds, what):
    if not holds:
        faults.append(what)


def log_text(seed, rows):
    own = random.Random(seed)
    return "t[s],gx[deg/s],gy[deg/s]\n" + "".join(f"{k / 100:.2f},{own.gauss(0, 1):.6f},{own.gauss(0, 2):.6f}\n"
                                                  for k in range(rows))


def call(*words, limit=None):
    before = (lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))) if limit else None
    return subprocess.run([program, "fleet", *words], capture_output=True, text=True, preexec_fn=before)


def results(fleet):
    """Content of every published result by its path."""
    return {p.relative_to(fleet).as_posix(): p.read_bytes() for p in sorted((fleet / "results").rglob("*"))
            if p.is_file()}


with tempfile.TemporaryDirectory(prefix="libchar-kill-") as name:
    folder = pathlib.Path(name)
    logs = []
    for d in range(8):
        logs.append(str(folder / f"d{d}.csv"))
        pathlib.Path(logs[-1]).write_text(log_text(d, 4000))
    alone, many, full = folder / "alone", folder / "many", folder / "full"
    for fleet in (alone, many, full):
        ran = call("plan", *logs, "-o", str(fleet))
        expect(ran.returncode == 0, ran.stderr)
    expect(call("run", str(alone)).returncode == 0, "one process alone fails")
    wanted = results(alone)
    expect(len([f for f in wanted if f.endswith("device.record")]) == 8, "one process alone leaves no results")

    kills = 0
    while kills < 12:
        workers = [subprocess.Popen([program, "fleet", "run", str(many)], stdout=subprocess.DEVNULL,
                                    stderr=subprocess.DEVNULL) for _ in range(3)]
        time.sleep(rng.uniform(0.01, 0.25))
        for worker in workers:
            kills += worker.poll() is None
            worker.send_signal(signal.SIGKILL)
            worker.wait()
        found = results(many)
        for path, content in found.items():
            if "/." not in "/" + path.split("results/")[1]:
                expect(wanted.get(path) == content, f"after a kill {path} is there and is not whole")
        if call("status", str(many), "--list").stdout == "":
            break
    ran = call("run", str(many))
    expect(ran.returncode == 0, f"after kills: {ran.stderr}")
    # What killed workers left of units that others finished first stays until somebody looks: it is told.
    told = call("status", str(many)).stdout
    left = [p for p in (many / "results").glob("*/.*")]
    expect(not left or "begun and not ended" in told, told)
    found = {p: c for p, c in results(many).items() if "/." not in p}
    expect(found == wanted, "after kills the results are others than those of one process")

    ran = call("run", str(full), limit=20000)
    expect(ran.returncode == 75, f"no room to write: exit code {ran.returncode}: {ran.stderr}")
    expect(not list((full / "results").glob("*/*")), "no room to write: something is left")
    expect(call("run", str(full)).returncode == 0 and results(full) == wanted,
           "where there was no room before the results are others")

print("\n".join(faults) or f"{kills} workers killed, the same results")
sys.exit(bool(faults))
