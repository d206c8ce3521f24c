#!/usr/bin/env python3
"""Commands of each kind that options in combination got wrong: option_cases.py PROGRAM [CASES.tsv]

Each runs on its own copy of the good inputs and must end as its line says, and keep the contract as every command
does. CASES.tsv (kind, command, what is right), where it is there, adds commands of which only the contract is asked."""
import csv
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile

import option_contract as contract
import option_fuzz as fuzz
import option_inputs as inputs
import program as programs

# Exit code, what standard error or output must say ("" nothing in particular), the command.
CASES = [
    (2, "E0201", "psd x.csv --spectrogram -0"),
    (2, "E0201", "psd x.csv --segment 0s"),
    (2, "E0875", "characterize x.csv -o o --segment 9223372036854775808"),
    (2, "longest that fits has 2000", "psd x.csv --segment 100000000"),
    (2, "longest that fits has 2000", "characterize x.csv -o o --segment 100000000"),
    (0, "does not determine rate ramp R", "fit x.csv --terms R"),
    (0, "undetermined", "fit temp.csv -c a --terms R"),
    (0, "", "characterize x.csv -o o --still 1.."),
    (0, "", "fleet plan x.csv -o o --still 1.."),
    (2, "E0939", "replay arr.csv --sensors a,b --reference ref --learning 0..8 --high-pass 0.1 --align gain -o o"),
    (2, "E0939", "replay arr.csv --sensors a,b --reference ref --high-pass 0.1 --align gain@0..5 -o o"),
    (2, "E0938", "replay arr.csv --sensors a,b --model a=ma/z.sensor.yaml --reference ref -o o"),
    (2, "E0721", "simulate mx/a.sensor.yaml mr/g.sensor.yaml --samples 50 --truth 100 -o s.csv"),
    (2, "E0721", "simulate mx/a.sensor.yaml --samples 5 --truth sine -o s.csv"),
    (2, "E0722", "simulate mx/a.sensor.yaml --samples 300 --fault a:noise=1e308@1..2 -o s.csv"),
    (5, "E0504", "plot rep -c a -o rep/report.json --format svg --force"),
    (5, "E0504", "plot rep -c a --csv rep/curves.csv --force"),
    (5, "E0504", "plot rep -c a --gnuplot rep/report.html --force"),
    (5, "E0504", "fleet compare fl fl2 -o fl/plan.jsonl --force"),
    (5, "E0504", "fleet compare fl fl2 -o fl2/plan.jsonl --force"),
    (5, "E0504", "bench mx/a.sensor.yaml --quick --parts design --against bn/bench.json -o bn --force"),
    (5, "E0504", "fuse arr.csv --with rr --as csv -o rr/report.json --force"),
    (5, "E0505", "plot rep -c a -o p.svg --csv p.svg"),
    (5, "E0504", "report rr --csv --force -o rr/fusion.yaml"),
    (2, "E0319", "replay arr.csv --sensors a,b -o o --from 20"),
    (5, "E0505", "fit x.csv -o m --models m"),
    (5, "E0505", "simulate mx/a.sensor.yaml --samples 5 -o q.csv --scene ./q.csv"),
    (4, "E0711", "fit x.csv --scale *=1e78"),
    (4, "E0711", "fit x.csv --scale *=1e-78"),
    (0, "", "fit edge.csv --rate 100"),
    (0, "", "replay arr.csv --sensors a,b --reference ref --to 0.05 -o o"),
    (2, "E0201", "replay arr.csv --sensors a,b --from 5 --to 1 -o o"),
    (2, "E0201", "fleet plan x.csv --from 5 --to 1 -o P"),
    (2, "E0702", "fleet plan x.csv --temperature nope -o P"),
    (2, "E0201", "fleet plan x.csv --taus 0 -o P"),
    (2, "E0201", "allan x.csv --tau-max 0"),
    (5, "E0502", "characterize x.csv -o ''"),
    (5, "E0502", "fit x.csv --output="),
    (2, "E0207", "characterize x.csv --limits '' -o o"),
    (2, "E0207", "verify rep --rerun ''"),
    (2, "E0207", "fit ''"),
    (2, "E0207", "inspect x.csv --preset= --json"),
    (2, "E0207", "bench --quick --parts design --against ''"),
    (3, "E0206", "characterize gap.csv --strict -o o"),
    (3, "E0206", "fit gap.csv --strict --models o"),
    (3, "E0206", "allan gap.csv --strict -o o.csv"),
    (4, "stamps", "fit odd.csv --group-by c0 --no-remedies"),
    (3, "E0968", "bench mx/a.sensor.yaml --quick --parts design -o o --against bn/bench.json"),
    (2, "E0205", "simulate mx/a.sensor.yaml --samples 5 -o q.csv --scene -"),
    (0, "scene-written", "replay arr.csv --sensors a,b --write-scene w.yaml --json"),
    (2, "E0205", "fuse arr.csv --with rr --map a=a,a=b -o f.csv"),
    (2, "E0205", "inspect x.csv --scale a=2,a=3"),
    (2, "E0205", "inspect x.csv --unit a=V --unit a=A"),
    (2, "E0205", "inspect x.csv -c a,a"),
    (2, "E0209", "psd x.csv --cross a,b --average median"),
    (2, "E0209", "psd x.csv --cross a,b --lines"),
    (2, "E0209", "psd x.csv --cross a,b --log-bins 10"),
    (2, "E0209", "psd x.csv --cross a,b --scaling ls"),
    (2, "E0209", "psd x.csv --coherence a,b --sides two"),
    (2, "E0209", "psd x.csv --spectrogram 64 --segment 32"),
    (2, "E0209", "psd x.csv --lines --log-bins 5"),
    (2, "E0209", "fit x.csv --sides two"),
    (2, "E0209", "fit x.csv --duration 5"),
    (2, "E0209", "fit x.csv --quantity power"),
    (2, "E0209", "fit curve.csv --curve allan --from 1"),
    (2, "E0336", "fit curve.csv --curve allan --scale adev=100"),
    (2, "E0209", "fit curve.csv --curve allan --frozen 3"),
    (2, "E0336", "inspect x.csv --topic nope"),
    (2, "E0336", "inspect x.csv --time-source header"),
    (2, "E0336", "inspect x.csv --preset LN200"),
    (2, "E0336", "inspect n.npy --rate 100 --delimiter tab"),
    (2, "E0336", "inspect n.npy --rate 100 --where a=1"),
    (2, "E0978", "plot rep -c a --algorithm nope -o p.svg"),
    (2, "E0978", "plot rep -c a --input nope -o p.svg"),
    (2, "E0209", "plot rep -c a --dpi 100 -o p.svg"),
    (2, "E0209", "plot rep -c a --csv p.csv --grey"),
    (2, "E0209", "convert x.csv -o o.csv --dtype f32"),
    (2, "E0209", "convert x.csv -o o.csv --order planar"),
    (2, "E0209", "convert x.csv -o o.csv --endian big"),
    (2, "E0209", "convert x.csv -o o.npy --no-time-column"),
    (2, "E0209", "allan arr.csv --hat --frozen 3"),
    (2, "E0209", "characterize x.csv -o o --seed 5"),
    (2, "E0209", "model mx/a.sensor.yaml --axes max"),
    (2, "E0209", "model mx/a.sensor.yaml --to kalibr --airsim-tau 5"),
    (2, "E0209", "replay --list --sensors a"),
    (2, "E0209", "replay arr.csv --sensors a,b --explain -o o"),
    (2, "E0209", "bench --quick --parts design --tolerance 5"),
]


def says(words, done, expected):
    code, needle = expected
    text = (done[1] + done[2]).decode(errors="replace")
    if done[0] != code:
        return f"exit code {done[0]}, expected {code}: {text[-200:]}"
    return "" if needle in text else f"does not say {needle}: {text[-300:]}"


def main():
    program = os.path.abspath(sys.argv[1])
    cases = [(shlex.split(command), (code, needle)) for code, needle, command in CASES]
    if len(sys.argv) > 2 and pathlib.Path(sys.argv[2]).is_file():
        with open(sys.argv[2]) as file:
            rows = csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE)
            cases += [(shlex.split(row["command"]), None) for row in rows]
    exits, wrong = contract.exit_codes(), 0
    with tempfile.TemporaryDirectory() as top:
        base, folder = pathlib.Path(top) / "base", pathlib.Path(top) / "work"
        inputs.make(program, base)
        shutil.copytree(base, folder)
        before = contract.state(folder)
        for words, expected in cases:
            done = programs.run(program, words, folder)
            problem = says(words, done, expected) if expected else ""
            after = contract.state(folder)
            problem = problem or contract.wrong(words, done, folder, (before, after), fuzz.places(words), exits)
            if problem:
                wrong += 1
                print(f"WRONG {problem}\n   {shlex.join(words)}")
            before = fuzz.tidy(base, folder, before, after)
    print(f"{len(cases)} commands, {wrong} wrong")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
