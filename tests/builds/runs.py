"""What compare_builds.py runs: names and command lines, in an order in which a run finds what earlier ones wrote."""

VERBS = (
    "inspect characterize allan psd fit model simulate replay fuse compare convert plot report verify bench "
    "fleet-plan fleet-run fleet-merge fleet-status fleet-export fleet-compare").split()
TARGETS = (
    "kalibr euroc openvins orbslam3 basalt vins gtsam ros sdf rotors airsim gnss-ins-sim gnss_ins_sim "
    "pegasus kf-gins navego matlab px4 json").split()
IMU = "fixtures/imu_at_rest.csv"
GYRO, ACCEL = "report/gyro_z.sensor.yaml", "report/accel_z.sensor.yaml"
LIMITS = """format: noise-limits
version: 1
sensor: a made-up sheet
limits:
  - kind: angular_rate
    density: one-sided
    white_noise: {value: 2, unit: deg/√h}
    bias_instability: {value: 25, unit: deg/h}
  - channels: [accel_z]
    density: one-sided
    white_noise: {value: 0.001, unit: mg/√Hz}
"""
CURVE = "x,y\n" + "".join(f"{0.1 * 1.5 ** k!r},{0.02 / (1.5 ** (k / 2)) + 0.001!r}\n" for k in range(20))
MANIFEST = """format: fleet-manifest
version: 1
defaults: {type: imu, limits: fleet-limits.yaml}
devices:
  - {device: A01, log: window.csv, batch: "1", temperature_c: 25}
  - {device: A02, log: later.csv, batch: "2"}
  - {device: A01, log: third.csv, batch: "1", temperature_c: 40}
  - {device: A03, log: fourth.csv, batch: "2"}
"""
# that a run finds
FILES = {"limits.yaml": LIMITS, "fleet-limits.yaml": LIMITS.split("  - channels")[0], "curve.csv": CURVE,
         "fleet.yaml": MANIFEST}


class Run:
    """`measured`: the outputs are times and memory, so only their words are compared."""

    def __init__(self, name, words, measured=False):
        self.name, self.words, self.measured = name, words, measured


def of_help():
    yield "version", ["--version"]
    yield "help", ["--help"]
    for verb in VERBS:
        words = verb.split("-", 1)
        yield f"help {verb}", [*words, "--help"]
        if verb != "bench":  # which then runs all of it
            yield f"nothing {verb}", words
        yield f"unknown option {verb}", [*words, "--no-such-option", "x"]
        yield f"man {verb}", ["--generate", "man", verb]
    yield "unknown verb", ["characterise"]
    for kind in ["man", "bash", "zsh", "fish", "json"]:
        yield f"generate {kind}", ["--generate", kind]


def of_curves():
    yield "allan", ["allan", IMU]
    for kind in ["adev", "oadev", "mdev", "tdev", "hdev", "ohdev", "totdev"]:
        yield f"allan {kind}", ["allan", IMU, "-c", "gyro_z", "--type", kind, "--json"]
    yield "allan dense", ["allan", IMU, "-c", "accel_z", "--taus", "dense"]
    yield "allan bad type", ["allan", IMU, "--type", "odev"]
    yield "allan plot", ["allan", IMU, "--plot"]
    yield "allan dynamic", ["allan", IMU, "-c", "gyro_z", "--dynamic", "200s", "--json"]
    for scaling in ["psd", "ps", "lsd", "ls"]:
        yield f"psd {scaling}", ["psd", IMU, "--scaling", scaling]
    yield "psd two", ["psd", IMU, "--sides", "two", "--json"]
    yield "psd segment", ["psd", IMU, "--segment", "4096", "--window", "blackman_harris", "-c", "gyro_z"]
    yield "psd lines", ["psd", IMU, "--lines"]
    yield "psd bins", ["psd", IMU, "--log-bins", "30", "--json", "--lines"]
    yield "psd plot", ["psd", IMU, "--log-bins", "60", "--plot"]
    yield "psd cross", ["psd", IMU, "--cross", "gyro_z,accel_z", "--json"]
    yield "psd coherence", ["psd", IMU, "--coherence", "gyro_z,accel_z", "-o", "coherence.csv"]
    yield "psd spectrogram", ["psd", IMU, "-c", "gyro_z", "--spectrogram", "100s", "--json"]
    yield "fit", ["fit", IMU]
    yield "fit json", ["fit", IMU, "--json", "-o", "fit.json"]
    terms = "white_noise,bias_instability,random_walk,rate_ramp"
    yield "fit terms", ["fit", IMU, "--terms", terms, "-c", "gyro_z"]
    yield "fit streamed", ["fit", IMU, "--memory", "64k", "--json"]
    yield "fit Allan curve", ["fit", "curve.csv", "--curve", "allan", "--duration", "600", "--json"]
    yield "fit spectrum", ["fit", "curve.csv", "--curve", "psd", "--quantity", "root"]


def of_logs(root):
    yield "inspect", ["inspect", IMU]
    yield "inspect json", ["inspect", IMU, "--json"]
    for npy in sorted((root / "fixtures/npy").glob("*.npy")):
        name = f"fixtures/npy/{npy.name}"
        yield f"inspect {npy.name}", ["inspect", name]
        yield f"inspect json {npy.name}", ["inspect", name, "--json", "--rate", "100"]
        yield f"convert {npy.name}", ["convert", name, "--rate", "100", "-o", f"{npy.stem}.csv"]
        yield f"convert raw {npy.name}", ["convert", name, "--rate", "100", "-o", f"{npy.stem}.f64"]
    for folder in ["arrays", "flight", "packed", "ros"]:
        for log in sorted((root / "fixtures" / folder).iterdir()):
            if log.suffix not in (".py", ".mjs", ".md"):
                yield f"inspect {folder}/{log.name}", ["inspect", f"fixtures/{folder}/{log.name}"]
    yield "inspect imu", ["inspect", "fixtures/arrays/float.imu", "--preset", "IXSEA"]
    yield "convert npy", ["convert", IMU, "-o", "imu.npy"]
    yield "convert raw", ["convert", IMU, "-o", "imu.f64"]
    yield "convert csv", ["convert", IMU, "-o", "imu.csv"]
    yield "convert window", ["convert", IMU, "--from", "10s", "--to", "20s", "-c", "gyro_z", "-o", "window.csv"]
    yield "convert later", ["convert", IMU, "--from", "20s", "--to", "30s", "-c", "gyro_z", "-o", "later.csv"]
    yield "convert third", ["convert", IMU, "--from", "30s", "--to", "45s", "-c", "gyro_z", "-o", "third.csv"]
    yield "convert fourth", ["convert", IMU, "--from", "45s", "--to", "60s", "-c", "gyro_z", "-o", "fourth.csv"]
    yield "inspect raw", ["inspect", "imu.f64"]


def of_characterizations():
    yield "characterize", ["characterize", IMU, "-o", "report", "--force"]
    yield "characterize json", ["characterize", IMU, "-o", "report2", "--json", "--verify"]
    yield "characterize options", [
        "characterize", IMU, "-o", "report3", "--segment", "2048", "--window", "flat_top", "--sides", "two",
        "--scaling", "lsd",
        "--terms", "white_noise,bias_instability", "--no-remedies", "--no-second-opinion", "--taus", "decade"]
    yield "characterize streamed", ["characterize", IMU, "-o", "report4", "--memory", "64k"]
    yield "characterize limits", ["characterize", IMU, "-o", "judged", "--limits", "limits.yaml"]
    yield "characterize pool", ["characterize", "window.csv", "later.csv", "-o", "pooled", "--pool"]
    yield "characterize lot", ["characterize", "window.csv", "later.csv", "third.csv", "-o", "lot", "--lot"]
    yield "compare characterizations", ["compare", "report", "judged"]
    yield "compare characterizations json", ["compare", "report", "judged", "--json"]
    yield "characterize again", ["characterize", IMU, "-o", "report"]
    yield "verify", ["verify", "report"]
    yield "verify json", ["verify", "report2", "--json"]
    yield "verify rerun", ["verify", "report", "--rerun", "rerun"]
    yield "verify nothing", ["verify", "fixtures"]
    for name in ["report", "judged", "report4", "pooled", "fit.json", "lot"]:
        for form in ["markdown", "latex", "csv"]:
            yield f"report {form} {name}", ["report", name, f"--{form}"]
    yield "report channel", ["report", "report", "-c", "gyro*", "-o", "table.md"]


def of_models():
    yield "model", ["model", GYRO, ACCEL]
    yield "model json", ["model", GYRO, "--json"]
    yield "model list", ["model", "--list"]
    yield "model list json", ["model", "--list", "--json"]
    for target in TARGETS:
        to = ["--to", target]
        yield f"export {target}", ["model", GYRO, ACCEL, *to]
        yield f"export {target} rms", ["model", GYRO, ACCEL, *to, "--axes", "rms", "--inflate", "2", "-o",
                                       f"{target}.out"]
        yield f"export {target} older", ["model", GYRO, ACCEL, *to, "--older"]
        yield f"export {target} gyro", ["model", GYRO, *to, "--topic", "/imu7"]
        yield f"export {target} json", ["model", GYRO, ACCEL, *to, "--json"]


def of_arrays():
    yield "simulate", [
        "simulate", GYRO, "--devices", "3", "--duration", "2min", "--truth", "sine,amplitude=5,frequency_hz=0.01",
        "--fault", "gyro_z2:bias=0.3@20..60", "-o", "array.csv"]
    yield "simulate npy", ["simulate", GYRO, "--duration", "10min", "--seed", "7", "-o", "one.npy"]
    yield "simulate json", ["simulate", GYRO, "--duration", "1min", "-o", "short.csv", "--json"]
    yield "allan hat", ["allan", "array.csv", "--hat", "-c", "gyro_z*", "--json"]
    yield "replay simulated", ["replay", "array.scene.yaml", "-o", "array-replay", "--quiet"]
    yield "replay untimed", ["replay", "array.scene.yaml", "-o", "untimed", "--no-timing"]
    yield "replay explain simulated", ["replay", "array.scene.yaml", "--explain"]
    yield "fuse", ["fuse", "array.csv", "--with", "array-replay", "-o", "fused.csv"]
    yield "fuse json", ["fuse", "array.csv", "--with", "array-replay", "-o", "fused.f64", "--algorithm", "mean",
                        "--json"]
    yield Run("compare", ["compare", "array-replay", "array-replay"], measured=True)
    yield "compare untimed", ["compare", "untimed", "untimed", "--markdown"]
    yield "verify replay", ["verify", "untimed", "--json"]
    for form in ["markdown", "latex", "csv"]:
        yield f"report {form} replay", ["report", "untimed", f"--{form}"]
    yield "replay list", ["replay", "--list"]
    yield "replay list json", ["replay", "--list", "--json"]


def of_figures():
    yield "plot list", ["plot", "--list"]
    for kind in ["allan", "psd", "residuals", "trace"]:
        for source, channel in [("report", "gyro_z"), ("report2", "accel_z"), ("judged", "gyro*")]:
            out = f"{kind}-{source}"
            yield f"plot {kind} {source}", ["plot", source, "--kind", kind, "-c", channel, "-o", f"{out}.svg",
                                            "--csv", f"{out}.csv", "--gnuplot", f"{out}.gp"]
        yield f"plot {kind} all", ["plot", "report", "--kind", kind, "-o", "-"]
    for kind in ["ranking", "timeline", "error", "window", "weights", "variances", "faults", "error-allan"]:
        out = f"replay-{kind}"
        yield f"plot {kind}", [
            "plot", "untimed", "--kind", kind, "-o", f"{out}.svg", "--csv", f"{out}.csv", "--gnuplot", f"{out}.gp"]
    for kind in ["front", "memory"]:
        yield Run(f"plot {kind}", ["plot", "array-replay", "--kind", kind, "--csv", "-"], measured=True)
    yield "plot model", ["plot", GYRO, "-o", "model.svg", "--grey", "--title", "a model"]
    yield "plot curves", ["plot", "report/curves.csv", GYRO, "-c", "gyro_z", "--label", "measured,model", "-o",
                          "both.svg"]
    yield "plot fit", ["plot", "fit.json", "-o", "fit.svg"]
    yield "plot ranges", ["plot", "report", "-c", "gyro_z", "-o", "-", "--x-range", "0.1..10", "--y-range",
                          "1e-4..1", "--width",
                          "two-columns"]
    yield "plot bad range", ["plot", "report", "-o", "-", "--x-range", "10..1"]
    yield "plot pdf", ["plot", "report", "-c", "gyro_z", "-o", "figure.pdf"]
    yield "plot png", ["plot", "report", "-c", "gyro_z", "-o", "figure.png", "--dpi", "72"]
    yield "plot log", ["plot", IMU, "-o", "-"]


def of_fleets():
    yield "fleet plan", ["fleet", "plan", "fleet.yaml", "-o", "fleet"]
    yield "fleet plan json", ["fleet", "plan", "window.csv", "later.csv", "--by-channel", "--no-reports", "-o",
                              "fleet2", "--json"]
    yield "fleet plan bad", ["fleet", "plan", "limits.yaml", "-o", "fleet3"]
    yield "fleet status before", ["fleet", "status", "fleet", "--list"]
    yield "fleet merge early", ["fleet", "merge", "fleet", "-o", "early"]
    for engine in ["slurm", "snakemake", "parallel"]:
        yield f"fleet export {engine}", ["fleet", "export", "fleet", "--to", engine]
    yield "fleet export json", ["fleet", "export", "fleet2", "--to", "parallel", "--json", "--program",
                                "apptainer exec"]
    yield "fleet run", ["fleet", "run", "fleet"]
    yield "fleet run json", ["fleet", "run", "fleet2", "--json"]
    yield "fleet status", ["fleet", "status", "fleet", "fleet2"]
    yield "fleet status json", ["fleet", "status", "fleet", "--json"]
    yield "fleet merge", ["fleet", "merge", "fleet", "-o", "merged"]
    yield "fleet merge json", ["fleet", "merge", "fleet2", "-o", "merged2", "--name", "two", "--json"]
    yield "fleet compare", ["fleet", "compare", "fleet", "--batches", "1,2"]
    yield "fleet compare json", ["fleet", "compare", "fleet", "--batches", "1,2", "--json"]
    yield "report of a lot", ["report", "merged"]


def of_benchmarks(quick):
    bench = ["bench", "--seed", "3", "--json"]
    yield Run("bench characterization",
              [*bench, GYRO, "--parts", "characterization", "--records", "2", "--samples", "2048"])
    yield Run("bench design", [*bench, GYRO, "--parts", "design", "--records", "2", "--samples", "2048", "--quick"])
    yield Run("bench fusion", [*bench, "array.scene.yaml", "--parts", "fusion", "--runs", "2", "--algorithms",
                               "mean,inverse-variance"])
    yield Run("bench wrong option", ["bench", GYRO, "--runs", "2"])
    if not quick:
        yield Run("bench stress", ["bench", "--stress", "--quick", "--json"])
        yield Run("bench text", ["bench", "--quick", "-o", "bench"], measured=True)


def of_scenes(root, quick):
    scenes = sorted(p.relative_to(root).as_posix() for p in (root / "fixtures/scenes").rglob("*.yaml"))
    for scene in scenes:
        stem = scene.rsplit("/", 1)[-1].removesuffix(".yaml")
        yield f"explain {scene}", ["replay", scene, "--explain", "--allow-outside"]
        yield f"explain json {scene}", ["replay", scene, "--explain", "--json", "--allow-outside"]
        if not quick:
            yield f"replay {scene}", [
                "replay", scene, "--allow-outside", "-o", f"replay-{stem}", "--quiet", "--estimates",
                f"{stem}-estimates.csv"]


def of_bad_inputs(root):
    for folder in ["csv", "npy", "raw", "json"]:
        for bad in sorted((root / "fixtures/known/badinputs" / folder).iterdir()):
            name = f"fixtures/known/badinputs/{folder}/{bad.name}"
            yield f"bad inspect {folder}/{bad.name}", ["inspect", name]
            yield f"bad fit {folder}/{bad.name}", ["fit", name, "--json"]
            yield f"bad allan {folder}/{bad.name}", ["allan", name, "--rate", "10"]
            if folder == "json":
                yield f"bad model {folder}/{bad.name}", ["model", name]
                yield f"bad replay {folder}/{bad.name}", ["replay", name, "--explain"]
                yield f"bad plot {folder}/{bad.name}", ["plot", name, "-o", "-"]
                yield f"bad report {folder}/{bad.name}", ["report", name]
                yield f"bad verify {folder}/{bad.name}", ["verify", name]


def of_recordings(root, quick):
    data = root.parent / "shared/data"
    for log in sorted(data.glob("*.csv")) + sorted(data.glob("*.npy")):
        if log.stat().st_size < 60e6:
            yield f"data inspect {log.name}", ["inspect", f"../shared/data/{log.name}", "--json"]
            if not quick:
                yield f"data fit {log.name}", ["fit", f"../shared/data/{log.name}", "--rate", "100", "--json"]


def all_runs(root, quick):
    for group in (of_help(), of_curves(), of_logs(root), of_characterizations(), of_models(), of_arrays(),
                  of_figures(), of_fleets(),
                  of_benchmarks(quick), of_scenes(root, quick), of_bad_inputs(root), of_recordings(root, quick)):
        for run in group:
            yield run if isinstance(run, Run) else Run(*run)
