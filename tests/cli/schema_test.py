"""Every document that the program prints and writes, and every file that it reads, against its schema (docs/schema,
--generate schema), by a validator that is not ours.

usage: schema_test.py PROGRAM MAKE_FLEET       exits with 77 where jsonschema or yaml is not installed

- every schema is a schema of draft 2020-12, and the documents of every verb (documents.py) pass it;
- models, scenes, what a replay learnt and limits, written by the program or shipped, pass theirs as YAML;
- what the library writes of a fleet (MAKE_FLEET) passes its own;
- each schema says something: a document without a key that it requires, or with another type, is refused;
- what a later version may add is accepted.
"""
import copy
import json
import os
import pathlib
import subprocess
import sys
import tempfile

try:
    import jsonschema
    import yaml
except ImportError as missing:
    print(f"SKIPPED: {missing}")
    sys.exit(77)
import documents

root = documents.root
program = os.path.abspath(sys.argv[1])
schemas = json.loads(subprocess.run([program, "--generate", "schema"], check=True, capture_output=True).stdout)
schemas |= {path.name: json.loads(path.read_text()) for path in sorted((root / "docs/schema").glob("*.schema.json"))}
faults = []
checked = {}


class Loader(yaml.SafeLoader):
    """Dates stay text, as in the program."""


Loader.yaml_implicit_resolvers = {key: [(tag, pattern) for tag, pattern in rows if tag != "tag:yaml.org,2002:timestamp"]
                                  for key, rows in yaml.SafeLoader.yaml_implicit_resolvers.items()}


def validator(name):
    resolver = jsonschema.RefResolver(base_uri="", referrer=schemas[name], store=dict(schemas))
    return jsonschema.Draft202012Validator(schemas[name], resolver=resolver)


def thin(value):
    """Of long lists the ends: tests/support/schemas.cpp looks at every element, and this validator takes its time."""
    if isinstance(value, dict):
        return {key: thin(item) for key, item in value.items()}
    if isinstance(value, list):
        return [thin(item) for item in (value if len(value) <= 40 else value[:20] + value[-20:])]
    return value


def hold(document, what, name=None):
    document = thin(document)
    name = name or document["format"] + ".schema.json"
    if name not in schemas:
        faults.append(f"{what}: docs/schema has no {name}")
        return
    for error in sorted(validator(name).iter_errors(document), key=lambda e: list(map(str, e.path)))[:3]:
        faults.append(f"{what}: {name}: {'/'.join(map(str, error.absolute_path))}: {error.message[:160]}")
    checked[name] = document


def must_refuse(name, document):
    """A key that is required is taken away, and one of another type put in its place."""
    schema = validator(name)
    for key in ("format", "version"):
        if key not in document:
            continue
        less = {k: v for k, v in document.items() if k != key}
        if schema.is_valid(less):
            faults.append(f"{name}: a document without {key} passes")
        if schema.is_valid({**document, key: [1]}):
            faults.append(f"{name}: {key}: [1] passes")
    more = copy.deepcopy(document)
    more["a key of a later version"] = {"a": 1}
    if not schema.is_valid(more):
        faults.append(f"{name}: a further key is refused")


def shipped():
    for path in sorted((root / "fixtures/scenes").rglob("*.yaml")):
        document = yaml.load(path.read_text(), Loader)
        if isinstance(document, dict) and "format" in document:
            yield path, document


for name, schema in schemas.items():
    jsonschema.Draft202012Validator.check_schema(schema)
    if schema.get("$id") != name:
        faults.append(f"{name}: $id is {schema.get('$id')}")

with tempfile.TemporaryDirectory() as scratch:
    folder = pathlib.Path(scratch)
    for words, printed in documents.run_all(program, folder, faults.append):
        for document in printed if isinstance(printed, list) else [printed]:
            hold(document, " ".join(words))
    for path in sorted(folder.rglob("*.json")):
        if path.name != "imu.f64.json":
            document = json.loads(path.read_text())
            if "format" in document:
                hold(document, path.name)
    for path in sorted(folder.rglob("*.yaml")):
        if (folder / "scenes") not in path.parents:
            hold(yaml.load(path.read_text(), Loader), path.name)
    for path in sorted(folder.rglob("device.record")):
        hold(json.loads(path.read_text().split("\n", 1)[1]), path.name)
    for path in sorted(folder.glob("*.f64.json")):
        hold(json.loads(path.read_text()), path.name, "sidecar.schema.json")
with tempfile.TemporaryDirectory() as scratch:
    subprocess.run([sys.argv[2], "40", scratch], check=True)
    for path in sorted(pathlib.Path(scratch).glob("*.json")):
        hold(json.loads(path.read_text()), path.name)
for path, document in shipped():
    hold(document, path.relative_to(root).as_posix())
hold(json.loads(subprocess.run([program, "--generate", "json"], check=True, capture_output=True).stdout),
     "--generate json")

for name, document in checked.items():
    must_refuse(name, document)
unused = set(schemas) - set(checked) - {name + ".schema.json" for name in ("common", "head")}
if unused:
    faults.append(f"held against nothing: {', '.join(sorted(unused))}")
print("\n".join(faults[:60]) or f"schemas: {len(checked)} of them hold what the program writes and reads")
sys.exit(bool(faults))
