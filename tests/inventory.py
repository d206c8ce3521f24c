"""What a built program offers, one line per thing, sorted: `diff` of two builds' inventories shows what was
lost or added.

usage: inventory.py PROGRAM [--python DIR]
Verbs, arguments, options and their words (statistics, scalings, windows, formats), fusion algorithms with
their options, export targets, figures, kinds of signals and faults, ways of the bench, completions and man
pages; with --python names and parameters of the module in DIR (PYTHONPATH).
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

MODEL = "format: sensor-model\nversion: 1\nunit: deg/s\nrate_hz: 100\ndensity: two-sided\nwhite_noise: {value: 0.01}\n"
SIGNATURES = """
import inspect, libchar
for name in libchar.__all__:
    thing = getattr(libchar, name)
    print("python", name)
    if inspect.isfunction(thing):
        for parameter in inspect.signature(thing).parameters:
            print("python", name, parameter)
    elif inspect.isclass(thing):
        for member in dir(thing):
            if not member.startswith("_"):
                print("python", name, member)
        for member in getattr(thing, "__dataclass_fields__", {}):
            print("python", name, member)
"""


def output(program, *words, **more):
    return subprocess.run([program, *words], capture_output=True, text=True, check=True, **more).stdout


def of_usage(program):
    usage = json.loads(output(program, "--generate", "json"))
    for option in usage["options"]:
        yield f"option {' '.join(option['flags'])}"
    for verb in usage["verbs"]:
        name = verb["name"]
        yield f"verb {name}"
        output(program, "--generate", "man", name)
        yield f"man {name}"
        for argument in verb["arguments"]:
            yield f"verb {name} argument {argument['value']}"
        for option in verb["options"]:
            flags = ", ".join(option["flags"])
            yield f"verb {name} {flags} ({option['kind']})"
            yield from (f"verb {name} {flags} word {word}" for word in option["words"])
    for kind in ["man", "bash", "zsh", "fish", "json"]:
        if output(program, "--generate", kind):
            yield f"generate {kind}"


def of_lists(program):
    for algorithm in json.loads(output(program, "replay", "--list", "--json"))["algorithms"]:
        yield f"algorithm {algorithm['name']}"
        yield from (f"algorithm {algorithm['name']} option {option['name']}" for option in algorithm["options"])
    for target in json.loads(output(program, "model", "--list", "--json"))["targets"]:
        yield f"target {target['name']}"
    for line in output(program, "plot", "--list").splitlines():
        yield f"figure {line.split()[0]}"


def of_model(program):
    """What a program says when it is given a model, and a word that it does not know."""
    with tempfile.TemporaryDirectory() as folder:
        model = pathlib.Path(folder) / "made.sensor.yaml"
        model.write_text(MODEL)
        bench = output(program, "bench", model, "--parts", "characterization", "--records", "2", "--samples", "512",
                       "--json")
        for signal in json.loads(bench)["characterization"]:
            yield from (f"bench method {method['name']}" for method in signal["methods"])
        for what, words in {"signal": ["--truth", "nothing"], "fault": ["--fault", "made:nothing=1@1..2"]}.items():
            out = str(pathlib.Path(folder) / "never.csv")
            refused = subprocess.run([program, "simulate", model, "--duration", "9s", "-o", out, *words],
                                     capture_output=True, text=True)
            listed = re.search(r"expected one of (.*?);", refused.stderr)
            if not listed:
                sys.exit(f"inventory.py: kinds of a {what} were expected: {refused.stderr}")
            yield from (f"{what} {word}" for word in listed[1].split(", "))


def main():
    program = sys.argv[1]
    lines = {*of_usage(program), *of_lists(program), *of_model(program)}
    if "--python" in sys.argv:
        module = os.environ | {"PYTHONPATH": sys.argv[sys.argv.index("--python") + 1]}
        lines |= set(output(sys.executable, "-c", SIGNATURES, env=module).splitlines())
    print("\n".join(sorted(lines)))


if __name__ == "__main__":
    main()
