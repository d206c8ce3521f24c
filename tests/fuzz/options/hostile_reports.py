#!/usr/bin/env python3
"""Reports that order things: hostile_reports.py PROGRAM [--runs 250] [--seed 1]

A report of characterize or replay gets another command and other lists of files: words with bundled flags,
options that write, that swallow the next word, that read elsewhere, by links, `..`, /proc, words of a shell.
`verify REPORT --rerun again` must write into `again` alone, open nothing of the folder `outside` without
--allow-read (strace sees it), keep the contract of option_contract.py, and end within its time."""
import argparse
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

import option_contract as contract
import option_inputs as inputs

FILES = ["x.csv", "arr.csv", "arr.scene.yaml", "limits.yaml", "mx/a.sensor.yaml", "mx", "n.npy", "raw.f64", "bag",
         "rep", "rr/report.json", "bag2", "far.scene.yaml", "deep.scene.yaml", "fl/plan.jsonl"]
FORMS = ["{top}/outside/{name}", "../outside/{name}", "linked/{name}", "./rep/../../outside/{name}", "{name}",
         "/proc/self/cwd/../outside/{name}", "/proc/self/root{top}/outside/{name}", "{top}/home/linked/{name}",
         "linked/../outside/{name}", "one_{name}", "file://{top}/outside/{name}", "$PWD/../outside/{name}",
         "~/outside/{name}", "`cat {name}`", "//{top}/outside/{name}", "rep/{name}"]
ALONE = ["/dev/zero", "/dev/stdin", "/proc/kmsg", "/proc/self/mem", "pipe", "-", "", "/", ".", "..", "/etc/shadow",
         "x" * 5000]
WRITING = ["-o {0}", "-o{0}", "--output={0}", "--output {0}", "-qo{0}", "-qqo {0}", "-fo{0}",
           "--force -o {0}", "--force=true -o{0}", "--write-scene {0}", "--write-scene={0}", "--csv={0}",
           "--models={0}", "--scene {0}",
           "--rerun={0}", "--out={0}", "-- -o {0}", "-- {0}", "--config={0}", "--estimates csv -o {0}",
           "--force --json"]
READING = ["{0}", "--limits {0}", "--limits={0}", "--model a={0}", "--model=a={0}", "--models {0}", "--models={0}",
           "--reference-log {0}", "--reference-log={0}", "-- {0}", "--temperature {0}", "--preset={0}", "-c{0}",
           "--set={0}", "--where a={0}", "--names {0}", "--allow-outside {0}", "--allow-outside=true {0}"]
SWALLOWS = ["--units", "--names", "--topic", "--preset", "--limits", "--missing", "--scale", "-c", "-o", "--model",
            "--", "--learning", "--where", "--output=", "--limits=", "-qc", "--help", "--list", "--explain", "--json",
            "--threads"]
LIKELY = {"characterize": ["{0}", "{0} --lot", "--limits {0}", "--limits={0} -o elsewhere", "-qo {0}"],
          "replay": ["{0}", "{0} --sensors a,b", "--reference-log {0}", "--model a={0}", "--models {0}", "-o {0}"]}
BASES = [["characterize", "x.csv"], ["characterize"], ["characterize", "x.csv", "x2.csv", "--lot"],
         ["replay", "arr.scene.yaml"], ["replay"], ["replay", "arr.csv", "--sensors", "a,b,c", "--reference", "ref"]]
OTHERS = [["convert", "x.csv"], ["fleet", "run", "fl3"], ["fit", "x.csv"], ["verify", "rep"], [], [7], "rm -rf .", None,
          ["-q", "characterize", "x.csv"], ["characterize\n", "x.csv"], ["characterize", ["x.csv"]]]


def prepare(program, top):
    home, outside = top / "home", top / "outside"
    inputs.make(program, home)
    for folder, log in (("bag", "../../outside/humble.db3"), ("bag2", "link.db3")):
        (home / folder).mkdir()
        (home / folder / "metadata.yaml").write_text(
            "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n  relative_file_paths:\n"
            f"    - {log}\n  topics_with_message_count: []\n")
    subprocess.run([program, "convert", "x.csv", "-o", "raw.f64", "-q"], cwd=home, check=True)
    shutil.copytree(home, outside)
    shutil.copy(contract.ROOT / "fixtures/ros/humble.db3", outside)
    scene = (home / "arr.scene.yaml").read_text()
    (home / "far.scene.yaml").write_text(scene.replace('"arr.csv"', '"../outside/arr.csv"'))
    (home / "deep.scene.yaml").write_text(scene.replace('- name: "a"', '- {name: "a", model: linked/mx/a.sensor.yaml}'))
    (home / "linked").symlink_to("../outside")
    (home / "bag2/link.db3").symlink_to(outside / "humble.db3")
    (home / "rep/x.csv").symlink_to(outside / "x.csv")
    for name in FILES:
        (home / f"one_{name.replace('/', '_')}").symlink_to(outside / name)
    shutil.move(home / "mx/a.sensor.yaml", home / "rep/mx_a.yaml")
    (home / "mx/a.sensor.yaml").symlink_to(outside / "mx/a.sensor.yaml")
    sidecar = next(path for path in home.glob("raw.*") if path.suffix != ".f64")
    sidecar.unlink()
    sidecar.symlink_to(outside / sidecar.name)
    os.mkfifo(home / "pipe")
    return home


def place(generator, top):
    if generator.random() < 0.15:
        return generator.choice(ALONE)
    name = generator.choice(FILES)
    return name if generator.random() < 0.4 else generator.choice(FORMS).format(top=top, name=name)


def command(generator, top):
    if generator.random() < 0.06:
        return generator.choice(OTHERS)
    words = ["sensorchar", *generator.choice(BASES)]
    if generator.random() < 0.4:  # a command that its verb accepts, but for the place
        return words + generator.choice(LIKELY[words[1]]).format(place(generator, top)).split(" ")
    for _ in range(generator.choice([1, 1, 2, 3])):
        kind = generator.choice([WRITING, READING, READING])
        where = place(generator, top) if kind is READING or generator.random() < 0.5 else generator.choice(
            ["elsewhere", "../elsewhere", f"{top}/elsewhere", "x.csv", "../outside/x.csv", "linked/new", "rep"])
        words += [word.format(where) for word in generator.choice(kind).split(" ")]
    if generator.random() < 0.3:
        words.append(generator.choice(SWALLOWS))
    return words


def hostile(generator, top, home):
    """Writes one report; returns its words and its place."""
    where = generator.choice(["rep", "rr"]) + "/report.json"
    document = json.loads((home / where).read_text())
    document["command"] = command(generator, top)
    paths = [place(generator, top) for _ in range(generator.choice([0, 1, 3]))]
    if paths:
        document["input"] = [{"path": path, "sha256": "0" * 64, "bytes": 1} for path in paths]
        document["files"] = [*document["files"], *paths]
        document["files_sha256"].update({path: "0" * 64 for path in paths})
    (home / "results").mkdir(exist_ok=True)
    (home / "results/report.json").write_text(json.dumps(document))
    return document["command"]


def opened_outside(trace, top):
    """Names that were opened and lie in the folder `outside` ("AT_FDCWD<...>, "name", flags) = 3</resolved>")."""
    return sorted(set(re.findall(rf"= \d+<({re.escape(str(top))}/outside[^>]*)>", trace)))


def wrong(program, words, top, home, before, exits):
    trace = top / "trace"
    done = subprocess.run(["strace", "-f", "-y", "-qq", "-e", "trace=openat,open,creat", "-o", trace, program, "verify",
                           "results/report.json", "--rerun", "again", "-q"],
                          cwd=home, capture_output=True, stdin=subprocess.DEVNULL, timeout=60, check=False)
    shutil.rmtree(home / "again", ignore_errors=True)
    opened = opened_outside(trace.read_text(errors="replace"), top)
    trace.unlink()
    after = contract.state(top)
    if after != before:
        return f"files: {sorted(name for name in set(after) | set(before) if after.get(name) != before.get(name))}"
    if opened:
        return f"read without --allow-read (exit {done.returncode}): {opened[:3]}"
    return contract.wrong_errors(done.returncode, done.stderr.decode(errors="replace"), exits) or contract.wrong_texts(
        [str(word) for word in words or []], done.stdout, done.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("--runs", type=int, default=250)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    traces = ["strace", "-qq", "-o", "/dev/null", "true"]
    if not shutil.which("strace") or subprocess.run(traces, check=False).returncode:
        print("SKIPPED: no strace, or it may not trace")
        sys.exit(77)
    generator, exits, found = random.Random(arguments.seed), contract.exit_codes(), 0
    with tempfile.TemporaryDirectory() as name:
        top = pathlib.Path(name).resolve()
        home = prepare(arguments.program, top)
        for _ in range(arguments.runs):
            words = hostile(generator, top, home)
            try:
                problem = wrong(arguments.program, words, top, home, contract.state(top), exits)
            except subprocess.TimeoutExpired:
                problem = "does not end"
            if problem:
                found += 1
                print(f"FOUND {problem}\n   {words}", flush=True)
    print(f"seed {arguments.seed}: {arguments.runs} reports, {found} did what they may not")
    sys.exit(bool(found))


if __name__ == "__main__":
    main()
