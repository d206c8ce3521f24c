#!/usr/bin/env python3
"""Good documents with one part that is huge: document_bombs.py PROGRAM [--only WORD] [--seconds S] [--megabytes M]
[--seed N] [--runs N] [--verbose]

Reports, models, scenes, limits, manifests, plans, curves, sidecars and journals of the program's own making. At each
place that a document has, once: a list gets its elements again and again, a map so many keys, a text so many letters,
a number another size, so that the file has some 9 MB or declares what no machine has. Every verb that reads the
document has to end as size_bombs.py expects it."""
import copy
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

import yaml

import size_bombs as bombs

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "options"))
import option_inputs as inputs  # noqa: E402

BYTES = 9_000_000
VALUES = 490_000  # of a document; more than 500,000 are refused
NUMBERS = (2**62, 10**9, 1e308, -1, 1e-308)

# What reads a document: words, "OUT…" is new in each run.
READ_BY = {
    "rep/report.json": [["report", "rep"], ["compare", "rep", "loud"], ["plot", "rep", "-c", "a", "-o", "OUT.svg"],
                        ["verify", "rep"]],
    "rr/report.json": [["report", "rr"], ["compare", "rr", "unlike"], ["plot", "rr", "-o", "OUT.svg"],
                       ["fuse", "arr.csv", "--with", "rr", "-o", "OUT.csv"]],
    "rr/fusion.yaml": [["fuse", "arr.csv", "--with", "rr", "-o", "OUT.csv"], ["model", "rr/fusion.yaml", "--to", "c"]],
    "mx/a.sensor.yaml": [["model", "mx/a.sensor.yaml"], ["model", "mx/a.sensor.yaml", "--to", "gtsam"],
                         ["simulate", "mx/a.sensor.yaml", "--samples", "300", "-o", "OUT.csv"],
                         ["plot", "mx/a.sensor.yaml", "-o", "OUT.svg"]],
    "arr.scene.yaml": [["replay", "arr.scene.yaml", "--explain"], ["replay", "arr.scene.yaml", "-o", "OUT"]],
    "sim.scene.yaml": [["replay", "sim.scene.yaml", "--explain"], ["simulate", "sim.scene.yaml", "-o", "OUT.csv"]],
    "limits.yaml": [["characterize", "x.csv", "--limits", "limits.yaml", "-o", "OUT"]],
    "manifest.yaml": [["fleet", "plan", "manifest.yaml", "-o", "OUT"]],
    "bn/bench.json": [["bench", "mx/a.sensor.yaml", "--quick", "--parts", "design", "--against", "bn/bench.json"]],
    "raw.f64.json": [["inspect", "raw.f64"], ["characterize", "raw.f64", "-o", "OUT"]],
    "bag/metadata.yaml": [["inspect", "bag"]],
    "done/.libchar-outputs.json": [["convert", "x.csv", "-o", "done/OUT.csv"]],
    "fl/plan.jsonl": [["fleet", "status", "fl"], ["fleet", "merge", "fl", "-o", "OUT"]],
    "fl3/tasks/000001.json": [["fleet", "run", "fl3/tasks/000001.json"]],
}
TABLES = {  # rows that come again and again behind those that are there
    "allan.csv": [["plot", "allan.csv", "-o", "OUT.svg"], ["fit", "allan.csv", "--curve", "allan"],
                  ["compare", "allan.csv", "allan.csv"]],
    "psd.csv": [["plot", "psd.csv", "-o", "OUT.svg"], ["fit", "psd.csv", "--curve", "psd"]],
    "rep/curves.csv": [["plot", "rep/curves.csv", "-o", "OUT.svg"]],
    "fleet.csv": [["fleet", "plan", "fleet.csv", "-o", "OUT"]],
}


def prepare(program, home):
    inputs.make(program, home)
    run = lambda *words: subprocess.run([program, *words, "-q"], cwd=home, check=True)
    run("convert", "x.csv", "-o", "raw.f64")
    (home / "manifest.yaml").write_text(
        "format: fleet-manifest\nversion: 1\ndefaults: {type: imu, batch: b, options: {reading: {rate_hz: 100}}}\n"
        "devices:\n- {device: A, log: x.csv, temperature_c: 25, batch: c}\n- {device: B, log: x2.csv}\n")
    (home / "sim.scene.yaml").write_text(
        "format: scene\nversion: 1\nname: s\nsimulate: {rate_hz: 100, samples: 300, truth: {name: l, kind: sine, "
        "amplitude: 1, frequency_hz: 1}}\nsensors:\n- {name: a, model: {unit: m, white_noise: {value: 1}, density: "
        "two-sided}}\n- {name: b, model: {unit: m, white_noise: {value: 1}, density: two-sided}}\nlearning: [0, 1]\n"
        "faults:\n- {sensor: a, kind: bias, value: 1, from_s: 1, to_s: 2}\n")
    (home / "bag").mkdir()
    shutil.copy(bombs.FIXTURES / "ros/humble.db3", home / "bag/a.db3")
    (home / "bag/metadata.yaml").write_text(
        "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n  relative_file_paths: [a.db3]\n"
        "  topics_with_message_count:\n  - topic_metadata: {name: /imu0, type: sensor_msgs/msg/Imu}\n"
        "    message_count: 3\n")
    (home / "done").mkdir()
    (home / "done/.libchar-outputs.json").write_text(
        '{"format":"outputs","version":1,"rename":[["a","b"]],"remove":["c"]}')


def parsed(path):
    text = path.read_text()
    return json.loads(text.splitlines()[0]) if path.suffix == ".jsonl" else (
        json.loads(text) if path.suffix == ".json" else yaml.safe_load(text))


def places(value, path=(), kinds=()):
    """The first place of each kind: elements of one list are alike."""
    yield path, kinds, value
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from places(inner, (*path, key), (*kinds, str(key)))
    if isinstance(value, list):
        for index, inner in enumerate(value):
            yield from places(inner, (*path, index), (*kinds, "[]"))


def values_in(value):
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return 1 + sum(values_in(one) for one in inner)


def again(piece, value, beside):
    """How often a piece makes a file of BYTES, of which it takes `beside` more."""
    return max(1, min(BYTES // (len(json.dumps(piece)) + beside), VALUES // values_in(value)))


def many_keys(value):
    piece = next(iter(value.values()), 0)
    return {**value, **{f"k{k}": piece for k in range(again(piece, piece, 12))}}


def growths(value):
    """(what grows, how it is made)"""
    if isinstance(value, list):
        yield "a long list", lambda v: (v or [0]) * again(v or [0], v or [0], 2)
        yield "lists in lists", lambda v: json.loads("[" * 60 + "]" * 60)
    if isinstance(value, dict):
        yield "many keys", many_keys
    if isinstance(value, str):
        yield "a long text", lambda v: v + "x" * BYTES
        yield "lines", lambda v: v + "\n" * (BYTES // 2)
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        for number in NUMBERS:
            yield f"number {number:g}", lambda v, n=number: n


def replaced(tree, path, value):
    if not path:
        return value
    tree = copy.copy(tree)
    tree[path[0]] = replaced(tree[path[0]], path[1:], value)
    return tree


def lines_of(value, pad=""):
    """As YAML in lines, since lists in brackets have a limit of their own."""
    pairs = value.items() if isinstance(value, dict) else ((None, one) for one in value)
    for key, inner in pairs:
        lead = pad + ("-" if key is None else f"{json.dumps(key)}:")
        if isinstance(inner, (dict, list)) and inner:
            yield lead
            yield from lines_of(inner, pad + "  ")
        else:
            yield f"{lead} {json.dumps(inner)}"


def written(name, document):
    in_lines = name.endswith(".yaml") and isinstance(document, (dict, list)) and document
    return "\n".join(lines_of(document)) if in_lines else json.dumps(document)


def grown_documents(home):
    """(name of the file, its new text, what grew, words of a command)"""
    for name, commands in READ_BY.items():
        document, seen = parsed(home / name), set()
        for path, kinds, value in places(document):
            for what, grow in growths(value):
                if (kinds, what) in seen:
                    continue
                seen.add((kinds, what))
                for words in commands:
                    yield name, (lambda n=name, d=document, p=path, v=value, g=grow: written(
                        n, replaced(d, p, g(v)))), f"{what} at {'.'.join(kinds)}", words
    for name, commands in TABLES.items():
        lines = (home / name).read_text().splitlines(keepends=True)
        rows = "".join(lines[1:])
        numbered = lambda k, line: f"{k}".join(line.rsplit(line.strip()[-1:], 1))
        for what, text in (("rows again", lambda r=rows, l=lines: l[0] + r * (BYTES // len(r))),
                           ("rows that differ", lambda l=lines: l[0] + "".join(
                               numbered(k, l[1 + k % (len(l) - 1)]) for k in range(BYTES // (len(l[1]) + 6))))):
            for words in commands:
                yield name, text, what, words


def chosen(cases, runs, seed):
    """So many of them, in their order."""
    return [cases[k] for k in sorted(random.Random(seed).sample(range(len(cases)), min(runs, len(cases))))]


def tidy(home):
    for left in [*home.rglob("OUT*")]:
        shutil.rmtree(left) if left.is_dir() else left.unlink(missing_ok=True)


def main():
    parser = bombs.arguments(__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--runs", type=int, default=10**9, help="so many of all, chosen by the seed")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as top:
        home = pathlib.Path(top) / "home"
        prepare(options.program, home)
        cases = [case for case in grown_documents(home) if options.only in f"{case[0]}: {case[2]}: {case[3][0]}"]
        tally, runner = bombs.Tally(options), bombs.Runner(options.program, home)
        for name, text, what, words in chosen(cases, options.runs, options.seed):
            path = home / name
            good = path.read_bytes()
            size = path.write_text(text())
            tally.add(f"{name}: {what}: {' '.join(words[:2])}", size, runner.measured(words))
            path.write_bytes(good)
            tidy(home)
        sys.exit(tally.end())


if __name__ == "__main__":
    main()
