"""What alignment brings on recorded arrays: leave-one-out RMS of the mean, aligned ÷ as recorded
(docs/theory/alignment.md).

usage: align_bench.py SENSORCHAR
The scenes read recordings beside the checkout (fixtures/scenes/real/README.md).
"""
import json
import pathlib
import subprocess
import sys
import tempfile

SCENES = pathlib.Path(__file__).resolve().parents[2] / "fixtures/scenes/real"
ROWS = [(f"MIMU fast, {axis}", f"mimu-gyro-{axis}-aligned", []) for axis in "xyz"]
ROWS += [(f"MIMU slow turns, {axis}", f"mimu-gyro-{axis}-aligned", ["--evaluation", "12..490"]) for axis in "xyz"]
ROWS += [(f"DOT second half, {axis}", f"dot-gyro-{axis}-aligned", []) for axis in "xyz"]


def run(program, scene, options):
    with tempfile.TemporaryDirectory() as out:
        subprocess.run([program, "replay", SCENES / f"{scene}.yaml", "--allow-outside", "--algorithms", "mean", "-o",
                        out, *options],
                       check=True, capture_output=True)
        return json.loads((pathlib.Path(out) / "report.json").read_text())["alignment"]["budget"]


def main():
    print("| record | as recorded | aligned | ratio |\n|---|---|---|---|")
    for name, scene, options in ROWS:
        budget = run(sys.argv[1], scene, options)
        before, after = budget["rms_as_recorded"], budget["rms_aligned"]
        print(f"| {name} | {before:.4g} | {after:.4g} | {after / before:.3f} |")


if __name__ == "__main__":
    main()
