"""Runs every verb of two builds of the program on every fixture and shipped scene and compares what they print, write and return.

usage: compare_builds.py OLD NEW [--quick] [--only WORD] [--listed FILE]
Runs both programs in folders that look alike, masks what is measured or names the build (run times, memory, the version's commit), and
prints a line for each run that differs, with the first differing lines. FILE lists differences that are meant, a line each:
`PATTERN<tab>reason`; PATTERN is a regular expression searched in "RUN: FILE: -old line / +new line". Ends with 1 when a difference is
not listed. --quick leaves out replays of whole scenes.
"""
import argparse
import difflib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

root = pathlib.Path(__file__).resolve().parent.parent
arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("old")
arguments.add_argument("new")
arguments.add_argument("--quick", action="store_true")
arguments.add_argument("--only", default="", help="only runs whose name holds this")
arguments.add_argument("--listed", default=str(root / "tests/listed_differences.txt"))
options = arguments.parse_args()

MASKS = [
    (re.compile(r'"(seconds|ns_per_sample|ns_per_sample_ci95|peak_bytes|bytes_per_second|own_bytes|resident_bytes|learning_s|run_s)": *(\[[^\]]*\]|[^,}\n]*)'), r'"\1": MASKED'),
    (re.compile(r'"build": *"[^"]*"'), '"build": MASKED'),
    (re.compile(r"^(sensorchar \S+) \(.*\)$", re.M), r"\1"),
    (re.compile(r'("[a-z]+\.(html|md)"): *"[0-9a-f]{64}"'), r"\1: MASKED"),  # of a page that says when it was made and by which build
    (re.compile(r'"measured": *\{[^{}]*\}', re.S), '"measured": MASKED'),
    (re.compile(r"^[WE]\d{8} [\d:.]+ +\d+ ", re.M), "W "),  # a warning of Ceres: time and thread
]
# Replays measure time and memory, and show them in many ways.
REPLAY_MASKS = [
    (re.compile(r"\b[\d.]+ (ns|µs|ms|s)\b"), "# s"),
    (re.compile(r"\b[\d.]+ (B|kB|MB|GB)\b"), "# B"),
    (re.compile(r'data-value="[^"]*">[^<]*'), 'data-value="">#'),  # report.json has the same numbers
    (re.compile(r"(%|-|x) +[\d.e+]+ +# (B|kB|MB|GB) *\*? *"), r"\1 # # "),
    (re.compile(r"Of these \S+ is the cheapest"), "Of these # is the cheapest"),
    (re.compile(r"fronts?: [a-z, ]*"), "fronts: "),
    (re.compile(r'("pareto_front"|"front[a-z_]*"): *(\{[^{}]*\}|\[[^\[\]]*\]|\w+)'), r"\1: MASKED"),
]


def runs():
    """name, words, files that must exist beforehand (produced by an earlier run of the same program)."""
    yield "version", ["--version"]
    yield "help", ["--help"]
    verbs = ["inspect", "characterize", "allan", "psd", "fit", "model", "simulate", "replay", "fuse", "compare", "convert"]
    for verb in verbs:
        yield f"help {verb}", [verb, "--help"]
        yield f"nothing {verb}", [verb]
        yield f"unknown option {verb}", [verb, "--no-such-option", "x"]
    yield "unknown verb", ["characterise"]
    imu = "fixtures/imu_at_rest.csv"
    yield "allan", ["allan", imu]
    for kind in ["adev", "oadev", "mdev", "tdev", "hdev", "ohdev", "totdev"]:
        yield f"allan {kind}", ["allan", imu, "-c", "gyro_z", "--type", kind, "--json"]
    yield "allan dense", ["allan", imu, "-c", "accel_z", "--taus", "dense"]
    yield "allan bad type", ["allan", imu, "--type", "odev"]
    for scaling in ["psd", "ps", "lsd", "ls"]:
        yield f"psd {scaling}", ["psd", imu, "--scaling", scaling]
    yield "psd two", ["psd", imu, "--sides", "two", "--json"]
    yield "psd segment", ["psd", imu, "--segment", "4096", "--window", "blackman_harris", "-c", "gyro_z"]
    yield "psd lines", ["psd", imu, "--lines"]
    yield "psd bins", ["psd", imu, "--log-bins", "30", "--json", "--lines"]
    yield "fit", ["fit", imu]
    yield "fit json", ["fit", imu, "--json"]
    yield "fit terms", ["fit", imu, "--terms", "white_noise,bias_instability,random_walk,rate_ramp", "-c", "gyro_z"]
    yield "fit Allan curve", ["fit", "curve.csv", "--curve", "allan", "--duration", "600", "--json"]
    yield "fit spectrum", ["fit", "curve.csv", "--curve", "psd", "--quantity", "root"]
    yield "inspect", ["inspect", imu]
    yield "inspect json", ["inspect", imu, "--json"]
    for npy in sorted((root / "fixtures/npy").glob("*.npy")):
        name = f"fixtures/npy/{npy.name}"
        yield f"inspect {npy.name}", ["inspect", name]
        yield f"inspect json {npy.name}", ["inspect", name, "--json", "--rate", "100"]
        yield f"convert {npy.name}", ["convert", name, "--rate", "100", "-o", f"{npy.stem}.csv"]
        yield f"convert raw {npy.name}", ["convert", name, "--rate", "100", "-o", f"{npy.stem}.f64"]
    yield "convert npy", ["convert", imu, "-o", "imu.npy"]
    yield "convert raw", ["convert", imu, "-o", "imu.f64"]
    yield "convert csv", ["convert", imu, "-o", "imu.csv"]
    yield "convert window", ["convert", imu, "--from", "10s", "--to", "20s", "-c", "gyro_z", "-o", "window.csv"]
    yield "convert later", ["convert", imu, "--from", "20s", "--to", "30s", "-o", "later.csv"]
    yield "inspect raw", ["inspect", "imu.f64"]
    yield "characterize", ["characterize", imu, "-o", "report", "--force"]
    yield "characterize json", ["characterize", imu, "-o", "report2", "--json", "--verify"]
    yield "characterize options", ["characterize", imu, "-o", "report3", "--segment", "2048", "--window", "flat_top", "--sides", "two",
                                   "--scaling", "lsd", "--terms", "white_noise,bias_instability", "--no-remedies", "--no-second-opinion", "--taus", "decade"]
    yield "characterize streamed", ["characterize", imu, "-o", "report4", "--memory", "64k"]
    yield "characterize limits", ["characterize", imu, "-o", "judged", "--limits", "limits.yaml"]
    yield "characterize pool", ["characterize", "window.csv", "later.csv", "-o", "pooled", "--pool"]
    yield "characterize lot", ["characterize", "window.csv", "later.csv", imu, "-o", "lot", "--lot"]
    yield "compare characterizations", ["compare", "report", "judged"]
    yield "compare characterizations json", ["compare", "report", "judged", "--json"]
    yield "characterize again", ["characterize", imu, "-o", "report"]
    yield "model", ["model", "report/gyro_z.sensor.yaml", "report/accel_z.sensor.yaml"]
    yield "model json", ["model", "report/gyro_z.sensor.yaml", "--json"]
    yield "model list", ["model", "--list"]
    targets = "kalibr euroc openvins orbslam3 basalt vins gtsam ros sdf rotors airsim gnss-ins-sim gnss_ins_sim pegasus kf-gins navego matlab px4 json".split()
    for target in targets:
        yield f"export {target}", ["model", "report/gyro_z.sensor.yaml", "report/accel_z.sensor.yaml", "--to", target]
        yield f"export {target} rms", ["model", "report/gyro_z.sensor.yaml", "report/accel_z.sensor.yaml", "--to", target, "--axes", "rms",
                                       "--inflate", "2", "-o", f"{target}.out"]
        yield f"export {target} older", ["model", "report/gyro_z.sensor.yaml", "report/accel_z.sensor.yaml", "--to", target, "--older"]
        yield f"export {target} gyro", ["model", "report/gyro_z.sensor.yaml", "--to", target, "--topic", "/imu7"]
    yield "simulate", ["simulate", "report/gyro_z.sensor.yaml", "--devices", "3", "--duration", "2min", "--truth", "sine,amplitude=5,frequency_hz=0.01",
                       "--fault", "gyro_z2:bias=0.3@20..60", "-o", "array.csv"]
    yield "simulate npy", ["simulate", "report/gyro_z.sensor.yaml", "--duration", "10min", "--seed", "7", "-o", "one.npy"]
    yield "replay simulated", ["replay", "array.scene.yaml", "-o", "array-replay", "--quiet"]
    yield "replay explain simulated", ["replay", "array.scene.yaml", "--explain"]
    yield "fuse", ["fuse", "array.csv", "--with", "array-replay", "-o", "fused.csv"]
    yield "fuse json", ["fuse", "array.csv", "--with", "array-replay", "-o", "fused.f64", "--algorithm", "mean", "--json"]
    yield "compare", ["compare", "compared", "compared"]
    yield "replay list", ["replay", "--list"]
    yield "replay list json", ["replay", "--list", "--json"]
    scenes = sorted(p.relative_to(root).as_posix() for p in (root / "fixtures/scenes").rglob("*.yaml"))
    for scene in scenes:
        yield f"explain {scene}", ["replay", scene, "--explain", "--allow-outside"]
        yield f"explain json {scene}", ["replay", scene, "--explain", "--json", "--allow-outside"]
        if not options.quick:
            yield f"replay {scene}", ["replay", scene, "--allow-outside", "-o", f"replay-{pathlib.Path(scene).stem}", "--quiet",
                                      "--estimates", f"{pathlib.Path(scene).stem}-estimates.csv"]
    for folder in ["csv", "npy", "raw", "json"]:
        for bad in sorted((root / "fixtures/known/badinputs" / folder).iterdir()):
            name = f"fixtures/known/badinputs/{folder}/{bad.name}"
            yield f"bad inspect {folder}/{bad.name}", ["inspect", name]
            yield f"bad fit {folder}/{bad.name}", ["fit", name, "--json"]
            yield f"bad allan {folder}/{bad.name}", ["allan", name, "--rate", "10"]
            if folder == "json":
                yield f"bad model {folder}/{bad.name}", ["model", name]
                yield f"bad replay {folder}/{bad.name}", ["replay", name, "--explain"]
    shared = root.parent / "shared"
    for log in sorted((shared / "data").glob("*.csv")) + sorted((shared / "data").glob("*.npy")):
        if log.stat().st_size < 60e6:
            yield f"data inspect {log.name}", ["inspect", f"../shared/data/{log.name}", "--json"]
            if not options.quick:
                yield f"data fit {log.name}", ["fit", f"../shared/data/{log.name}", "--rate", "100", "--json"]


def masked(data, replay):
    text = data.decode("utf-8", "surrogateescape")
    for pattern, to in MASKS + (REPLAY_MASKS if replay else []):
        text = pattern.sub(to, text)
    return text


LIMITS = """format: noise-limits
version: 1
sensor: a made-up sheet
limits:
  - kind: angular_rate
    white_noise: {value: 2, unit: deg/√h}
    bias_instability: {value: 25, unit: deg/h}
  - channels: [accel_z]
    white_noise: {value: 0.001, unit: mg/√Hz}
"""
CURVE = "x,y\n" + "".join(f"{0.1 * 1.5 ** k!r},{0.02 / (1.5 ** (k / 2)) + 0.001!r}\n" for k in range(20))


class Side:
    """One program with a folder in which relative paths are the same as on the other side."""

    def __init__(self, program, work):
        self.program, self.folder = os.path.abspath(program), work / "main"
        self.folder.mkdir(parents=True)
        shutil.copytree(root / "fixtures", self.folder / "fixtures")
        if (root.parent / "shared").is_dir():
            (work / "shared").symlink_to(root.parent / "shared")
        (self.folder / "limits.yaml").write_text(LIMITS)
        (self.folder / "curve.csv").write_text(CURVE)
        (self.folder / "bin").mkdir()
        (self.folder / "bin/sensorchar").symlink_to(self.program)
        self.seen = self.stamps()

    def stamps(self):
        return {p: p.stat().st_mtime_ns for p in self.folder.rglob("*") if p.is_file()}

    def run(self, words):
        replay = words[0] in ("replay", "compare")
        ran = subprocess.run(["bin/sensorchar", *words], cwd=self.folder, capture_output=True, stdin=subprocess.DEVNULL)
        found = {"exit code": str(ran.returncode), "stdout": masked(ran.stdout, replay), "stderr": masked(ran.stderr, replay)}
        now = self.stamps()
        for path in sorted(now):
            if self.seen.get(path) != now[path]:
                found[path.relative_to(self.folder).as_posix()] = masked(path.read_bytes(), replay)
        self.seen = now
        return found


NUMBER = re.compile(r"-?\d+\.?\d*(?:e[+-]?\d+)?")
LAST_DIGITS = 2e-13  # the probability of a chi-square far out in its tail has chi2/2 times the rounding of chi2


def differs_in_last_digits(a, b):
    """The same text but for numbers, and these are equal to LAST_DIGITS of their size."""
    if NUMBER.sub("#", a) != NUMBER.sub("#", b):
        return False
    pairs = zip(NUMBER.findall(a), NUMBER.findall(b))
    return all(x == y or abs(float(x) - float(y)) <= LAST_DIGITS * max(abs(float(x)), abs(float(y))) for x, y in pairs)


def different_lines(a, b):
    for kind, a_from, a_to, b_from, b_to in difflib.SequenceMatcher(None, a, b, autojunk=False).get_opcodes():
        if kind == "equal":
            continue
        pairs = list(zip(a[a_from:a_to], b[b_from:b_to])) if a_to - a_from == b_to - b_from else []
        close = [differs_in_last_digits(*pair) for pair in pairs]
        if any(close):
            yield "~", "last digits of numbers"
        yield from (("-", line) for k, line in enumerate(a[a_from:a_to]) if not (close and close[k]))
        yield from (("+", line) for k, line in enumerate(b[b_from:b_to]) if not (close and close[k]))


def differences(a, b):
    for part in sorted(set(a) | set(b)):
        if part not in a or part not in b:
            yield part, "-" if part in a else "+", "file only in one"
        elif a[part] != b[part] and differs_in_last_digits(a[part], b[part]):
            yield part, "~", "last digits of numbers"
        elif a[part] != b[part]:
            yield from ((part, sign, line) for sign, line in different_lines(a[part].splitlines(), b[part].splitlines()))


listed = []
if pathlib.Path(options.listed).exists():
    for line in pathlib.Path(options.listed).read_text().splitlines():
        if line and not line.startswith("#"):
            pattern, _, reason = line.partition("\t")
            listed.append([re.compile(pattern), reason, 0])

with tempfile.TemporaryDirectory() as folder:
    work = pathlib.Path(folder)
    (work / "old").mkdir(), (work / "new").mkdir()
    old, new = Side(options.old, work / "old"), Side(options.new, work / "new")
    count = same = 0
    unlisted = []
    for name, words in runs():
        if options.only not in name:
            continue
        count += 1
        if name == "compare":  # of the same two reports
            for side in (old, new):
                shutil.copytree(old.folder / "array-replay", side.folder / "compared", dirs_exist_ok=True)
                side.seen = side.stamps()
        found = list(differences(old.run(words), new.run(words)))
        same += not found
        strange = []
        for part, sign, text in found:
            row = f"{name}: {part}: {sign}{text[:300]}"
            match = next((entry for entry in listed if entry[0].search(row)), None)
            if match:
                match[2] += 1
            else:
                strange.append(row)
        if strange:
            unlisted.append(name)
            print(f"DIFFERS {name} ({len(strange)} lines)")
            for row in strange[:6]:
                print("   ", row[:240])
            sys.stdout.flush()
print(f"{count} runs, {same} with the same bytes, {count - same - len(unlisted)} with listed differences only, {len(unlisted)} with others")
for pattern, reason, hits in listed:
    if hits or not (options.quick or options.only):
        print(f"  listed, {hits} lines: {reason}" + ("" if hits else f" [{pattern.pattern} is met by nothing: drop it]"))
sys.exit(bool(unlisted))
