"""Runs of every verb that prints or writes documents, for tests of what they hold. usage: see schema_test.py"""
import hashlib
import json
import pathlib
import shutil
import subprocess

root = pathlib.Path(__file__).resolve().parent.parent.parent
LIMITS = """format: noise-limits
version: 1
sensor: a made-up sheet
limits:
  - kind: angular_rate
    white_noise: {value: 2, unit: deg/√h}
    bias_instability: {value: 25, unit: deg/h}
  - channels: [accel_z]
    density: one-sided
    white_noise: {value: 0.001, unit: mg/√Hz}
"""
CURVE = "x,y\n" + "".join(f"{0.1 * 1.5 ** k!r},{0.02 / (1.5 ** (k / 2)) + 0.001!r}\n" for k in range(20))
IMU = "imu.csv"
RUNS = [
    ["inspect", IMU], ["inspect", IMU, "dirty.csv"], ["inspect", "noisy.npy", "--rate", "10"],
    ["allan", IMU], ["allan", IMU, "-c", "gyro_z", "--type", "mdev", "--taus", "dense"],
    ["allan", IMU, "--data", "phase"],
    ["allan", IMU, "--type", "oadev,mtotdev,mtie", "--taus", "1s,10s"], ["allan", IMU, "--dynamic", "100s,300s"],
    ["psd", IMU, "--coherence", "gyro_z,accel_z", "--segment", "1000"],
    ["psd", IMU, "--average", "median", "--segment", "1000"],
    ["psd", IMU, "--spectrogram", "100s", "--overlap", "0"],
    ["psd", IMU], ["psd", IMU, "--lines", "--sides", "two", "--scaling", "lsd"],
    ["psd", IMU, "--log-bins", "30", "--lines"],
    ["fit", IMU], ["fit", IMU, "--terms", "N,B,K,R,quantization", "--still", "10..500"],
    ["fit", "curve.csv", "--curve", "allan", "--duration", "600"],
    ["fit", "curve.csv", "--curve", "psd"], ["fit", IMU, "--data", "phase"],
    ["characterize", IMU, "-o", "report", "--verify"],
    ["characterize", IMU, "-o", "judged", "--limits", "limits.yaml", "--still", "auto"],
    ["characterize", "warm.csv", "-o", "warm", "--temperature", "temp"], ["characterize", "dirty.csv", "-o", "dirty"],
    ["characterize", IMU, "-o", "streamed", "--memory", "64k", "--no-timing"],
    ["characterize", "first.csv", "second.csv", "-o", "pooled", "--pool"],
    ["characterize", "first.csv", "second.csv", IMU, "-o", "lot", "--lot"],
    ["characterize", "first.csv", "second.csv", "-o", "several"],
    ["model", "report/gyro_z.sensor.yaml", "report/accel_z.sensor.yaml"], ["model", "--list"],
    ["model", "report/gyro_z.sensor.yaml", "--to", "matlab", "--axes", "z"],
    ["simulate", "report/gyro_z.sensor.yaml", "--devices", "3", "--duration", "2min", "--truth",
     "sine,amplitude=5,frequency_hz=0.01", "--fault",
     "gyro_z2:bias=0.3@20..60", "-o", "array.csv"],
    ["allan", "array.csv", "--hat", "-c", "gyro*"],
    ["simulate", "report/gyro_z.sensor.yaml", "--duration", "2min", "--no-scene", "-o", "one.f64"],
    ["replay", "array.csv", "--sensors", "gyro*", "--reference", "truth", "--learning", "0..60", "-o", "replay",
     "--write-scene", "said.yaml"],
    ["replay", "array.scene.yaml", "-o", "replay-scene", "--no-timing"],
    ["replay", "scenes/rv-2.5-tilt.yaml", "-o", "tilt"], ["replay", "scenes/rv-2.5-tilt.yaml", "--explain"],
    ["replay", "--list"], ["explain", "stuck", "E0304"],
    ["replay", "array.csv", "--sensors", "gyro*", "--write-scene", "written.scene.yaml"],
    ["fuse", "array.csv", "--with", "replay", "-o", "fused.csv"],
    ["model", "replay", "--to", "c", "--algorithm", "minque", "--dtype", "f32"],
    ["compare", "report", "judged"], ["compare", "replay", "replay"], ["compare", "pooled", "pooled"],
    ["convert", IMU, "-o", "imu.npy"], ["convert", IMU, "-o", "imu.f64"],
    ["verify", "report"], ["verify", "report", "--rerun", "again"],
    ["fleet", "plan", "first.csv", "second.csv", "-o", "fleet"], ["fleet", "run", "fleet"],
    ["fleet", "status", "fleet"],
    ["fleet", "export", "fleet", "--to", "slurm"], ["fleet", "merge", "fleet", "-o", "fleet-report"],
    ["fleet", "plan", "first.csv", "second.csv", "--sums", "SHA256SUMS", "-o", "stated"],
    ["fleet", "plan", "first.csv", "gone.csv", "--skip-unreadable", "-o", "stated"],
    ["fleet", "plan", "fleet.yaml", "-o", "batches"], ["fleet", "run", "batches"],
    ["fleet", "status", "batches", "fleet"], ["fleet", "compare", "batches", "--batches", "b1,b2"],
    ["bench", "report/gyro_z.sensor.yaml", "scenes/rv-5.1-faults.yaml", "--quick", "--records", "3", "--runs", "2",
     "--samples", "4096", "--parts",
     "characterization,design,fusion", "--algorithms", "mean,median"],
]


def prepare(folder):
    """The inputs that the runs name."""
    shutil.copy(root / "fixtures/imu_at_rest.csv", folder / IMU)
    shutil.copytree(root / "fixtures/scenes", folder / "scenes")
    (folder / "limits.yaml").write_text(LIMITS)
    (folder / "fleet.yaml").write_text("format: fleet-manifest\nversion: 1\ndefaults: {options: "
                                       "{reading: {channels: [gyro_z]}}}\ndevices:\n" + "".join(
        f"  - {{device: d{k}, log: part{k}.csv, batch: b{1 + k % 2}, temperature_c: 2{k}}}\n" for k in range(4)))
    (folder / "curve.csv").write_text(CURVE)
    lines = (folder / IMU).read_text().splitlines()
    head = next(k for k, line in enumerate(lines) if not line.startswith("#")) + 1
    first, rows = lines[:head], lines[head:]
    (folder / "first.csv").write_text("\n".join(first + rows[:20000]) + "\n")
    (folder / "second.csv").write_text("\n".join(first + rows[25000:45000]) + "\n")
    (folder / "SHA256SUMS").write_text(hashlib.sha256((folder / "first.csv").read_bytes()).hexdigest()
                                       + "  first.csv\n")
    for k in range(4):
        (folder / f"part{k}.csv").write_text("\n".join(first + rows[12000 * k:12000 * (k + 1)]) + "\n")
    dirty = rows[:3000] + rows[3200:9000] + rows[8990:20000]
    (folder / "dirty.csv").write_text("\n".join([first[-1]] + [line if k % 997 else line.split(",")[0] + ",,"
                                                               for k, line in enumerate(dirty)]) + "\n")
    with open(folder / "warm.csv", "w") as warm:
        warm.write("t[s],gyro[deg/s],temp[degC]\n")
        for k in range(20000):
            temperature = 20 + 10 * k / 20000
            warm.write(f"{k / 50},{float(rows[k].split(',')[1]) + 0.02 * temperature},{temperature:.4f}\n")
    shutil.copy(root / "fixtures/npy/c_order.npy", folder / "noisy.npy")


def run_all(program, folder, say=print):
    """Yields (words, what was printed as JSON); the files stay in `folder`."""
    prepare(folder)
    for words in RUNS:
        ran = subprocess.run([program, *words, "--json", "--quiet"], cwd=folder, capture_output=True,
                             stdin=subprocess.DEVNULL)
        if not ran.stdout:
            say(f"{' '.join(words)}: code {ran.returncode}: {ran.stderr.decode()}")
            continue
        yield words, json.loads(ran.stdout)
