"""What is known travels: records with a fault of each kind through every verb. Each says the finding (inspect,
characterize in text and JSON, allan, the model file, the page), exports refuse or say it, and the remedy that the
terminal prints, pasted as it stands, makes it go and gives the right number.

usage: findings_matrix.py PROGRAM
"""
import json
import math
import pathlib
import random
import re
import shlex
import struct
import subprocess
import sys
import tempfile

program = sys.argv[1]
RATE, N = 100.0, 0.02  # Hz, U·√s
draw = random.Random(20261126)
SD = N * math.sqrt(RATE)


def noise(n, sd=SD):
    return [draw.gauss(0, sd) for _ in range(n)]


def marks():
    x = [round(v, 4) + 3 for v in noise(30000)]
    for i in range(500, 30000, 400):
        x[i] = -999.0
    return {"gyro": ("deg/s", x)}


def motion():
    x = noise(30000)
    for i in range(8000, 22000):
        x[i] += 60 * math.sin(i / 9) * math.sin(i / 700)
    return {"gyro": ("deg/s", x)}


def gravity():
    axes = {name: ("m/s^2", noise(30000, SD / 9.80665)) for name in ("acc_x", "acc_y", "acc_z")}
    axes["acc_z"] = ("m/s^2", [v + 1 for v in axes["acc_z"][1]])
    return axes


def wraps():
    phase, turn = [], 0.0
    for v in noise(30000):
        turn += 0.1 + v / RATE
        phase.append(turn % 50.0)
    return {"angle": ("deg", phase)}


def frozen():
    x = noise(30000)
    for start in range(1000, 30000, 5000):
        x[start:start + 300] = [x[start]] * 300
    return {"gyro": ("deg/s", x)}


def dead():
    return {"gyro": ("deg/s", [0.0 if abs(v) < 1.5 * SD else v for v in noise(30000)])}


def cut():
    return {"gyro": ("deg/s", [max(-1.5 * SD, min(v, 1.5 * SD)) for v in noise(30000)])}


def outliers():
    return {"gyro": ("deg/s", [v + (draw.choice((-6, 6)) * SD if draw.random() < 0.006 else 0) for v in noise(60000)])}


def coupled():
    keep, last, out = math.exp(-2 * math.pi * 0.3 / RATE), 0.0, []
    white = noise(61001)
    for before, v in zip(white, white[1:]):
        last = keep * last + v - before
        out.append(last)
    return {"gyro": ("deg/s", out[1000:])}  # settled


# kind: record, code, options of the analysis, whether options mend it, whether it is bad, true N of the first channel
KINDS = [
    ("marks", marks, "missing_mark", [], True, True, N),
    ("motion", motion, "motion", [], True, True, N),
    ("gravity", gravity, "not_gravity", [], True, True, N),
    ("wraps", wraps, "phase_wraps", ["--data", "phase"], True, True, N),
    ("frozen", frozen, "stuck", [], True, True, N),
    ("dead", dead, "dead_band", [], False, True, None),
    ("cut", cut, "much_saturated", [], False, True, None),
    ("outliers", outliers, "outliers_in_n", [], False, False, None),
    ("coupled", coupled, "high_passed", [], False, False, None),
]
OF_THE_FIT = {"motion", "outliers_in_n", "high_passed"}  # what samples alone do not show
faults = []


def run(*arguments, code=(0,)):
    ran = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    if ran.returncode not in code:
        faults.append(f"{shlex.join(map(str, arguments))}: exit {ran.returncode}: {ran.stderr.strip()[-300:]}")
    return ran


def expect(holds, what):
    if not holds:
        faults.append(what)


def codes(findings):
    return [one["code"] for one in findings]


with tempfile.TemporaryDirectory() as folder:
    here = pathlib.Path(folder)
    for kind, make, code, options, mends, bad, truth in KINDS:
        channels = make()
        log = here / f"{kind}.f64"
        columns = [values for _, values in channels.values()]
        log.write_bytes(b"".join(struct.pack(f"<{len(columns)}d", *row) for row in zip(*columns)))
        (here / f"{kind}.f64.json").write_text(json.dumps({
            "dtype": "f64", "endian": "little", "rate_hz": RATE,
            "channels": [{"name": name, "unit": unit} for name, (unit, _) in channels.items()]}))
        # inspect sees samples alone; what only the analysis sees is asked of that.
        if code not in OF_THE_FIT:
            seen = json.loads(run("inspect", log, "--json").stdout)["recordings"][0]["channels"][0]["findings"]
            expect(code in codes(seen), f"{kind}: inspect --json does not have {code}")
        out = here / f"{kind}-report"
        said = run("characterize", log, *options, "-o", out, code=(0, 4)).stdout
        report = json.loads((out / "report.json").read_text())
        found = [one for one in report["summary"]["channels"][0]["findings"] if one["code"] == code]
        expect(found, f"{kind}: report.json does not have {code}")
        if not found:
            continue
        expect((found[0]["severity"] == "bad") == bad, f"{kind}: {code} is {found[0]['severity']}")
        first = found[0]["sentence"].split(":")[0][:40]
        expect(first in said, f"{kind}: the terminal does not say {first!r}")
        page = (out / "report.html").read_text()
        expect(f'title="{code}"' in page, f"{kind}: the page does not have {code}")
        model = next(iter(sorted(out.glob("*.sensor.yaml"))), None)
        if model is not None:
            expect(f'code: "{code}"' in model.read_text(), f"{kind}: the model file does not have {code}")
            models = sorted(out.glob("*.sensor.yaml"))
            export = run("model", *models, "--to", "ros", code=(0, 3))
            expect((export.returncode == 3) == bad, f"{kind}: export of a model with {code}: exit {export.returncode}")
            anyway = run("model", *models, "--to", "ros", "--anyway")
            expect(first in anyway.stdout, f"{kind}: the exported file does not say {code}")
        if code not in OF_THE_FIT | {"not_gravity"}:
            curve = run("allan", log, *options, "-o", here / f"{kind}.csv")
            expect(first in curve.stderr, f"{kind}: allan does not say {code}")
        lot = here / f"{kind}-lot"
        run("characterize", log, *options, "--lot", "-o", lot, code=(0, 4, 3))
        if not mends:
            continue
        remedy = re.search(r"\((--[^)]*)\)", said)
        expect(remedy, f"{kind}: no remedy is printed")
        if not remedy:
            continue
        mended = here / f"{kind}-mended"
        run("characterize", log, *options, *shlex.split(remedy[1]), "-o", mended)
        report = json.loads((mended / "report.json").read_text())
        left = codes(report["summary"]["channels"][0]["findings"])
        expect(code not in left, f"{kind}: {code} is still there after {remedy[1]}")
        white = report["fit"]["channels"][0]["white_noise"]
        low, high = white["ci95"]
        wider = (high - low) / 2
        expect(low - wider <= truth <= high + wider,
               f"{kind}: N {white['value']} [{low}, {high}] after {remedy[1]}, true {truth}")

    # What to type next is a command that runs: an option that was given is not given twice, marks stand together.
    marked = here / "two.csv"
    values = [-999 if i % 400 == 7 else 9999 if i % 500 == 3 else v for i, v in enumerate(noise(20000))]
    marked.write_text("t[s],w[deg/s]\n" + "".join(f"{i / RATE:.2f},{v:.4f}\n" for i, v in enumerate(values)))
    said = run("characterize", marked, "-o", here / "two").stdout.splitlines()[-1]
    expect(said.startswith("next: sensorchar ") and said.count("--missing") == 1, f"next: {said}")
    run(*shlex.split(said)[2:])
    said = run("characterize", marked, "-o", here / "half", "--missing=9999").stdout.splitlines()[-1]
    expect(said.count("--missing") == 1 and "--missing=9999,-999" in said, f"next: an option twice: {said}")
    run(*shlex.split(said)[2:])

    # A slow channel beside a fast one has a rate of its own in every verb: what it gives is what it gives alone.
    slow = noise(1500, N)  # at 1 Hz: the white noise of all others
    table, alone = here / "slow.csv", here / "alone.csv"
    fast = noise(150000)
    table.write_text("t[s],gyro[deg/s],temp[degC]\n" + "".join(
        f"{i / RATE:.2f},{v:.5f},{f'{slow[i // 100]:.6f}' if i % 100 == 0 else ''}\n" for i, v in enumerate(fast)))
    alone.write_text("t[s],temp[degC]\n" + "".join(f"{i},{v:.6f}\n" for i, v in enumerate(slow)))
    run("characterize", table, "-o", here / "slow")
    run("characterize", alone, "-o", here / "alone")
    both = json.loads((here / "slow" / "report.json").read_text())
    single = json.loads((here / "alone" / "report.json").read_text())
    term = both["fit"]["channels"][1]["white_noise"]
    expect(term == single["fit"]["channels"][0]["white_noise"], f"slow channel: N {term} is not that of it alone")
    expect("own_grid" in codes(both["findings"]), "slow channel: its own grid is not said")
    for file in ("slow/temp.sensor.yaml", "alone/temp.sensor.yaml"):
        text = (here / file).read_text()
        expect("rate_hz: 1\n" in text or "rate_hz: 1.0\n" in text, f"{file}: its rate")
    fitted = json.loads(run("fit", table, "--json").stdout)["channels"][1]["white_noise"]["value"]
    expect(fitted == term["value"], f"slow channel: fit says {fitted}, characterize {term['value']}")

    # What makes samples worthless, and a sensor that freezes, are known to the replay of an array.
    three = [[v + math.sin(i / 50) for i, v in enumerate(noise(6000))] for _ in range(3)]
    array = here / "array.csv"

    def replay(*options):
        array.write_text("t[s],a,b,c\n" + "".join(
            f"{i / RATE:.2f},{a:.4f},{b:.4f},{c:.4f}\n" for i, (a, b, c) in enumerate(zip(*three))))
        ran = run("replay", array, "--sensors", "a,b,c", "--algorithms", "mean,median", "-o", here / "array", "--force",
                  *options)
        return ran.stderr, codes(json.loads((here / "array" / "report.json").read_text())["findings"])

    expect(replay()[1] == [], f"array: a sound one has findings: {replay()}")
    three[2][3000:] = [three[2][3000]] * 3000
    said, found = replay()
    expect(found == ["frozen_sensor"] and "c from 30" in said, f"array: a frozen sensor is not said: {said}")
    expect('code: "frozen_sensor"' in (here / "array" / "fusion.yaml").read_text(), "fusion.yaml does not have it")

    # What a log is fused from is said too, and what a sensor repeats while it hangs has no weight.
    frozen_at = three[2][3000]
    three[2][3000:] = [v + math.sin((3000 + i) / 50) for i, v in enumerate(noise(3000))]
    replay()
    three[2][3000:] = [frozen_at] * 3000
    array.write_text("t[s],a,b,c\n" + "".join(
        f"{i / RATE:.2f},{a:.4f},{b:.4f},{c:.4f}\n" for i, (a, b, c) in enumerate(zip(*three))))
    fused = run("fuse", array, "--with", here / "array", "--algorithm", "mean", "-o", here / "fused.csv", "--force")
    expect("c from 30" in fused.stderr, f"fuse: a frozen sensor is not said: {fused.stderr}")
    errors = [float(row.split(",")[1]) - math.sin(i / 50)
              for i, row in enumerate((here / "fused.csv").read_text().splitlines()[1:])]
    rms = math.sqrt(sum(e * e for e in errors) / len(errors))
    expect(rms < SD, f"fuse: RMSE {rms} with a frozen sensor, one alone has {SD}")
    three[0][::40] = [-999.0] * len(three[0][::40])
    said, found = replay()
    expect("missing_mark" in found and "--missing -999" in said, f"array: marks are not said: {said}")
    three[1][::60] = [-999.0] * len(three[1][::60])
    said, found = replay()
    expect("a: -999 occurs 150 times" in said and "b: -999 occurs 100 times" in said,
           f"array: each sensor has its own count: {said}")
    said, found = replay("--missing", "-999")
    expect("missing_mark" not in found and "missing_value" in found, f"array: --missing is not heard: {said}")

print("\n".join(faults) or f"findings: {len(KINDS)} kinds travel, each remedy works")
sys.exit(bool(faults))
