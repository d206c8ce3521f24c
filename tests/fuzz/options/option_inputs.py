"""Good inputs for commands: logs, curves, models, reports, a replay, fleets, a scene. make(PROGRAM, FOLDER)."""
import array
import math
import os
import pathlib
import random
import struct
import subprocess

SAMPLES = 2000


def table(path, head, *columns):
    path.write_text(head + "\n" + "".join(",".join(f"{x:.7g}" for x in row) + "\n" for row in zip(*columns)))


def npy(path, columns):
    rows = array.array("d", [x for row in zip(*columns) for x in row])
    head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({len(columns[0])}, {len(columns)}), }}"
    head += " " * (-(len(head) + 11) % 64) + "\n"
    path.write_bytes(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode() + rows.tobytes())


def logs(folder):
    r = random.Random(1)
    t = [i / 100 for i in range(SAMPLES)]

    def noise(sd):
        return [r.gauss(0, sd) for _ in t]

    truth = [2 * math.sin(1.3 * x) for x in t]
    table(folder / "x.csv", "t[s],a[deg/s],b[deg/s]", t, noise(.1), noise(.1))
    table(folder / "x2.csv", "t[s],a[deg/s],b[deg/s]", t, noise(.1), noise(.1))
    table(folder / "temp.csv", "t[s],a[V],temp[degC]", t, noise(.1), [25 + 5 * math.sin(x / 7) for x in t])
    table(folder / "arr.csv", "t[s],a[deg/s],b[deg/s],c[deg/s],ref[deg/s]", t,
          *([u + v for u, v in zip(truth, noise(sd))] for sd in (.1, .2, .3)), truth)
    faulty = [[u + v + fault for u, v, fault in zip(truth, noise(sd), faults)]
              for sd, faults in ((.1, [5.0 * (1200 < i < 1600) for i in range(SAMPLES)]), (.2, [0] * SAMPLES),
                                 (.3, [0] * SAMPLES))]
    table(folder / "faulty.csv", "t[s],a[deg/s],b[deg/s],c[deg/s],ref[deg/s]", t, *faulty, truth)
    table(folder / "loud.csv", "t[s],a[deg/s],b[deg/s]", t, noise(.5), noise(.1))
    table(folder / "rad.csv", "t[s],g[rad/s]", t, noise(.05))
    table(folder / "acc.csv", "t[s],z[m/s^2]", t, noise(.02))
    table(folder / "rate.csv", "p,q", noise(1), noise(2))
    table(folder / "gap.csv", "t[s],a[V]", t, noise(.1))
    lines = (folder / "gap.csv").read_text().split("\n")
    lines[500] = lines[500].split(",")[0] + ","
    (folder / "gap.csv").write_text("\n".join(lines))
    (folder / "edge.csv").write_text("a\n" + "".join(f"{int(i >= 8)}\n" for i in range(12)))
    (folder / "odd.csv").write_text("t[s],\x1b[31mred,＝1+1\n" + "".join(f"{x},{x % 7},{x % 5}\n" for x in range(60)))
    table(folder / "curve.csv", "tau[s],adev", [.1 * 2 ** k for k in range(9)],
          [.1 / math.sqrt(.1 * 2 ** k) * (1 + .002 * 2 ** k) for k in range(9)])
    table(folder / "pcurve.csv", "f[Hz],psd", [k / 12 for k in range(1, 60)], [.01 * (1 + 6 / k) for k in range(1, 60)])
    npy(folder / "n.npy", [noise(1), noise(1)])
    table(folder / "wide.csv", "t[s]," + ",".join(f"c{k}" for k in range(20)), t, *(noise(1) for _ in range(20)))


def make(program, folder):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    logs(folder)
    (folder / "limits.yaml").write_text("format: noise-limits\nversion: 1\n"
                                        "channels:\n  a: {white_noise: 1 deg/s/√Hz}\n")
    (folder / "fleet.csv").write_text("device,log\none,x.csv\ntwo,x2.csv\n")

    def run(*words):
        done = subprocess.run([program, *words, "-q"], cwd=folder, capture_output=True, check=False)
        if done.returncode:
            raise SystemExit(f"inputs: {' '.join(words)}: {done.stderr.decode()}")

    run("characterize", "x.csv", "-o", "rep", "--no-timing")
    run("characterize", "loud.csv", "-o", "loud", "--no-timing")
    for log, models in (("x", "mx"), ("rad", "mr"), ("acc", "ma")):
        run("fit", log + ".csv", "--models", models)
    run("replay", "arr.csv", "--sensors", "a,b,c", "--reference", "ref", "--learning", "0..8", "-o", "rr",
        "--no-timing")
    run("replay", "arr.csv", "--sensors", "a,b,c", "--reference", "ref", "--learning", "0..8",
        "--write-scene", "arr.scene.yaml")
    run("replay", "faulty.csv", "--sensors", "a,b,c", "--reference", "ref", "-o", "unlike", "--no-timing")
    run("allan", "x.csv", "-o", "allan.csv")
    run("psd", "x.csv", "-o", "psd.csv")
    run("simulate", "mx/a.sensor.yaml", "--samples", "500", "-o", "sim.csv")
    run("fleet", "plan", "x.csv", "-o", "fl")
    run("fleet", "run", "fl")
    run("fleet", "plan", "x2.csv", "-o", "fl2")
    run("fleet", "run", "fl2")
    run("fleet", "plan", "gap.csv", "-o", "fl3")
    # Of so many channels that a thousand times its cost is minutes on any processor.
    run("fleet", "plan", "x.csv", "wide.csv", "-o", "fl4")
    run("bench", "--quick", "--parts", "design", "mx/a.sensor.yaml", "-o", "bn")


# What stands without a flag, and what is needed beside it.
LOGS = ["x.csv", "arr.csv", "temp.csv", "gap.csv", "n.npy", "rate.csv", "sim.csv", "edge.csv", "odd.csv"]
ARGUMENTS = {
    "inspect": [[log] for log in LOGS],
    "allan": [[log] for log in LOGS],
    "psd": [[log] for log in LOGS],
    "fit": [[log] for log in LOGS] + [["curve.csv", "--curve", "allan"], ["pcurve.csv", "--curve", "psd"]],
    "characterize": [[log, "-o", "OUT"] for log in LOGS] + [["x.csv", "x2.csv", "-o", "OUT"]],
    "model": [["mx/a.sensor.yaml"], ["mr/g.sensor.yaml", "--to", "kalibr"], ["ma/z.sensor.yaml", "--to", "gazebo"]],
    "simulate": [["mx/a.sensor.yaml", "--samples", "300", "-o", "OUT.csv"],
                 ["mr/g.sensor.yaml", "--duration", "3", "-o", "OUT.npy"],
                 ["mx/a.sensor.yaml", "ma/z.sensor.yaml", "--samples", "50", "-o", "OUT.csv"]],
    "replay": [["arr.csv", "--sensors", "a,b,c", "--reference", "ref", "-o", "OUT"],
               ["arr.csv", "--sensors", "a,b", "-o", "OUT"], ["arr.scene.yaml", "-o", "OUT"],
               ["arr.scene.yaml", "--explain"]],
    "fuse": [["arr.csv", "--with", "rr", "-o", "OUT.csv"],
             ["faulty.csv", "--with", "rr", "--algorithm", "minque", "-o", "OUT.csv"]],
    "compare": [["rep", "rep"], ["rr", "rr"], ["rep", "loud"], ["rr", "unlike"]],
    "report": [["rep"], ["rr"]],
    "plot": [["rep", "-o", "OUT.svg"], ["rr", "-o", "OUT.svg"], ["allan.csv", "-o", "OUT.svg"],
             ["psd.csv", "-o", "OUT.png"], ["mx/a.sensor.yaml", "--csv", "OUT.csv"]],
    "convert": [[log, "-o", out] for log in LOGS for out in ("OUT.csv", "OUT.npy", "OUT.f64")],
    "verify": [["rep"], ["rr"]],
    "explain": [[], ["held_values"]],
    "bench": [["mx/a.sensor.yaml", "--quick", "--parts", "design"]],
    "fleet-plan": [["x.csv", "-o", "OUT"], ["x.csv", "x2.csv", "-o", "OUT"], ["fleet.csv", "-o", "OUT"]],
    "fleet-run": [["fl3"]],
    "fleet-status": [["fl"], ["fl3"]],
    "fleet-merge": [["fl", "-o", "OUT"], ["fl", "fl2", "-o", "OUT"]],
    "fleet-export": [["fl3", "--to", "parallel"], ["fl4", "--to", "slurm"]],
    "fleet-compare": [["fl", "fl2"]],
    "page": [["-o", "OUT.html"]],  # of a build that found one
}
