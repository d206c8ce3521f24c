"""The matrix of findings and verbs. Every code of findings.tsv has an input (finding_inputs); every verb says it, in
text and in JSON, or a rule states why it does not matter there (finding_inputs/rules.py). Severities are the table's,
exports refuse what is bad and write cautions as comments, and every option and `next:` line that is printed is run as
it stands: it mends, and leads in no circle.

usage: finding_travels.py PROGRAM ROOT PART [CODE…]    (--cells: prints every cell)
"""
import functools
import html
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
import finding_inputs as inputs  # noqa: E402
from finding_inputs import known, parts, rules  # noqa: E402

cells_wanted = "--cells" in sys.argv
program, root, part, *only = [word for word in sys.argv[1:] if word != "--cells"]
parts.PROGRAM = program
kinds = inputs.table(root)
faults, cells, remedies = [], {}, 0


def run(folder, *words, env=None):
    ran = subprocess.run([program, *map(str, words)], capture_output=True, text=True, cwd=folder,
                         env=os.environ | (env or {}), errors="replace")
    if ran.returncode < 0:
        faults.append(f"{shlex.join(map(str, words))}: signal {-ran.returncode}")
    return ran


def failure(ran):
    return f"{shlex.join(ran.args[1:])}: exit {ran.returncode}: {ran.stderr.strip()[-200:]}"


def findings_in(node):
    """All findings of a document, wherever they stand."""
    if isinstance(node, dict):
        if "code" in node and "severity" in node:
            yield node
        for value in node.values():
            yield from findings_in(value)
    elif isinstance(node, list):
        for value in node:
            yield from findings_in(value)


def document(ran):
    try:
        return json.loads(ran.stdout)
    except ValueError:
        return {}


def found(node, code):
    return next((one for one in findings_in(node) if one["code"] == code), None)


def says(text, finding):
    """The beginning of its sentence, or of its phrase: up to an option, whose name a terminal writes another way."""
    text = html.unescape(text).lower()
    for words in (finding["sentence"], finding.get("phrase") or finding["sentence"]):
        pieces = [piece.strip(" .:;,)") for piece in re.split(r"`[^`]*`|[(]", words.lower())]
        first = next((piece[:60].strip() for piece in pieces if len(piece.split()) > 2), words.lower())
        if first in text:
            return True
    return False


def cell(code, verb, how, holds, why=""):
    """`how`: text, JSON, …; a cell of the list of known faults has to fail."""
    name = (code, verb, how)
    if why:
        cells[name] = why
        return
    expected = known.text_of(code, verb, how)
    cells[name] = "said" if holds else "known" if expected else "not said"
    if not holds and not expected:
        faults.append(f"{code}: {verb} ({how}) does not say it")
    if holds and expected:
        faults.append(f"{code}: {verb} ({how}) says it now: take it out of finding_inputs/known.py")


def check_severity(code, finding, where):
    if finding["severity"] != kinds[code][0] and finding["severity"] not in rules.OTHER_SEVERITIES.get(code, ()):
        faults.append(f"{code}: {finding['severity']} in {where}, {kinds[code][0]} in the table")


def check_sentence(code, finding):
    sentence = finding["sentence"].strip()
    if len(sentence.split()) < 3 or re.search(r"\{\}|\bnan\b|e[-+]\d\d", sentence):
        if not known.text_of(code, "sentence", "text"):
            faults.append(f"{code}: no sentence: {sentence!r}")


@functools.cache
def help_of(verb):
    return subprocess.run([program, verb, "--help"], capture_output=True, text=True).stdout


def flags_in(text, finding, verb):
    """The options of the verb that stand beside a finding, each as the terminal prints it."""
    out = set()
    for line in text.splitlines():
        if says(line, finding):
            out |= {flags_of(flags) for flags in re.findall(r"\((--[^()]*)\)", line)}
    for flags in out:
        if finding["code"] not in rules.OF_ANOTHER_VERB and flags[0].split("=")[0] not in help_of(verb):
            faults.append(f"{finding['code']}: {verb} has no option {flags[0]}, which stands beside it")
    return sorted(flags for flags in out if flags[0].split("=")[0] in help_of(verb))


class Case:
    """One input in its folder, and the commands that were run there."""

    def __init__(self, code, made, folder):
        self.code, self.made, self.folder = code, made, folder
        self.severity, self.effects = kinds[code]
        self.finding, self.ran = None, set()

    def fault_of(self, how, text):
        """A fault that may be known."""
        expected = known.text_of(self.code, "remedy", how)
        if text and not expected:
            faults.append(f"{self.code}: {how}: {text}")
        if not text and expected:
            faults.append(f"{self.code}: {how} holds now: take it out of finding_inputs/known.py")

    def follow(self, line, how="next"):
        """The next line, and the one after it: each a command that runs, none that was there before."""
        global remedies
        seen = set()
        while line and line not in seen and len(seen) < 4:
            seen.add(line)
            if line in self.ran:  # after an earlier verb
                return None
            self.ran.add(line)
            remedies += 1
            ran = run(self.folder, *shlex.split(line))
            if ran.returncode != 0:
                return self.fault_of(how, failure(ran))
            line = next_line(ran.stdout)
        return self.fault_of(how, f"a circle: {line}" if line else "")


class Log(Case):
    """One input that is a log, and what the verbs say of it."""

    def __init__(self, code, made, folder):
        super().__init__(code, made, folder)
        self.log, self.out, self.models = made.make(folder), folder / "report", []

    def why(self, verb):
        return rules.why_not(self.made, verb, self.severity, self.effects)

    def verb(self, verb, *words, stdout=None):
        """Text and JSON of a verb that reads the log; `words` are those behind it."""
        why = self.why(verb)
        if why:
            return cell(self.code, verb, "text", False, why)
        ran = run(self.folder, verb, *words, "--json")
        if ran.returncode not in (0, 4):
            faults.append(f"{self.code}: {failure(ran)}")
        if ran.returncode == 4:  # and no document
            return cell(self.code, verb, "JSON", False, "there are no numbers, and that is said (exit code 4)")
        one = found(document(ran), self.code)
        cell(self.code, verb, "JSON", one is not None)
        if one:
            check_severity(self.code, one, f"{verb} --json")
        text = run(self.folder, verb, *words)
        said = text.stdout + text.stderr
        cell(self.code, verb, "text", says(said, one or self.finding))
        for flags in flags_in(said, one or self.finding, verb):
            self.mends_there(verb, words, flags)
        if verb == "inspect" and self.severity == "note":
            called = any("warning:" in line and says(line, self.finding) for line in said.splitlines())
            self.fault_of("label of inspect", "a note is called a warning" if called else "")
        if verb == "inspect":
            self.follow(next_line(said), "next of inspect")

    def table(self, verb, *words):
        """What reads the table of curves that a verb writes: as codes with their severity, from cautions on."""
        doc = document(run(self.folder, verb, *words, "--json"))
        severe = [one for one in findings_in(doc) if one["code"] == self.code and one["severity"] != "note"]
        if not severe or not any(one.get("effects") or one in findings_in(doc.get("channels")) for one in severe):
            return
        made = run(self.folder, verb, *words, "-o", f"{verb}.csv", "--force")
        if made.returncode != 0:
            return faults.append(f"{self.code}: {failure(made)}")
        fitted = run(self.folder, "fit", f"{verb}.csv", "--curve", verb, "--json")
        if fitted.returncode != 0:  # a curve of too few points, or not of densities
            return
        channels = document(fitted)["channels"]
        if doc.get("channels") and not {one["name"] for one in channels} & {
                one["name"] for one in doc["channels"] if found(one, self.code) or found(doc["findings"], self.code)}:
            return  # the channel that has it has no curve
        name = next((one["name"] for one in channels if found(one, self.code)), "")
        cell(self.code, f"fit --curve {verb}", "JSON", bool(name))
        drawn = run(self.folder, "plot", f"{verb}.csv", *(["-c", name] if name else []), "-o", "table.svg", "--force")
        cell(self.code, f"plot of {verb}.csv", "text",
             says(drawn.stdout + drawn.stderr, found(channels, self.code) or severe[0]))

    def characterize(self):
        words = [self.log, *self.made.options, *self.made.analysis, "-o", self.out, "--force"]
        self.said = run(self.folder, "characterize", *words)
        try:
            report = json.loads((self.out / "report.json").read_text())
        except OSError:
            faults.append(f"{self.code}: characterize: exit {self.said.returncode}: {self.said.stderr.strip()[-200:]}")
            return False
        # What stands beside a sample's quality may have been judged away.
        self.judged = [report["findings"], report["summary"]]
        self.finding = found(self.judged, self.code)
        cell(self.code, "characterize", "JSON", self.finding is not None)
        if not self.finding:
            return False
        self.severity = self.finding["severity"]
        self.effects = self.effects | {effect["quantity"] for effect in self.finding.get("effects", [])}
        check_severity(self.code, self.finding, "report.json")
        check_sentence(self.code, self.finding)
        cell(self.code, "characterize", "text", says(self.said.stdout + self.said.stderr, self.finding))
        page = (self.out / "report.html").read_text()
        cell(self.code, "page", "HTML", f'title="{self.code}"' in page or says(page, self.finding))
        return True

    def model(self):
        """The model file, what `model` prints of it, exports."""
        models = [path for path in sorted(self.out.glob("*.sensor.yaml")) if self.subject_is(path)]
        if not models:
            for verb in ("model file", "model", "export"):
                cell(self.code, verb, "text", False, "there are no coefficients, and so no model")
            return
        text = "".join(path.read_text() for path in models)
        why = self.why("model file")
        cell(self.code, "model file", "YAML", f'code: "{self.code}"' in text, why)
        self.models = models
        shown = run(self.folder, "model", *models)
        cell(self.code, "model", "text", says(shown.stdout + shown.stderr, self.finding), self.why("model"))
        why = self.why("export")
        if why:
            return cell(self.code, "export", "text", False, why)
        export = run(self.folder, "model", *models, "--to", "ros")
        if "E0590" in export.stderr:
            return cell(self.code, "export", "text", False, "the target does not take such a sensor")
        anyway = run(self.folder, "model", *models, "--to", "ros", "--anyway")
        if self.severity == "bad":
            cell(self.code, "export", "refusal", export.returncode == 3 and "E0594" in export.stderr)
        cell(self.code, "export", "comment", anyway.returncode == 0 and says(anyway.stdout, self.finding))

    def subject_is(self, path):
        report = json.loads((self.out / "report.json").read_text())
        channels = [one["name"] for one in report["summary"]["channels"] if found(one, self.code)]
        return not channels or any(path.name == f"{name}.sensor.yaml" for name in channels)

    def others(self):
        """Verbs that take what characterize wrote."""
        if self.why("plot"):
            for verb in ("plot", "compare", "lot", "simulate", "replay of its model"):
                cell(self.code, verb, "text", False, self.why("plot"))
            return
        figure = run(self.folder, "plot", self.out, "-o", "figure.svg", "--force")
        none = next((why for code, why in rules.NO_FIGURE.items() if code in figure.stderr), "")
        cell(self.code, "plot", "text", says(figure.stdout + figure.stderr, self.finding), none)
        both = run(self.folder, "compare", self.out, self.out)
        cell(self.code, "compare", "text", says(both.stdout + both.stderr, self.finding))
        cell(self.code, "compare", "JSON", found(document(run(self.folder, "compare", self.out, self.out, "--json")),
                                                 self.code) is not None)
        lot = self.folder / "lot"
        run(self.folder, "characterize", self.log, *self.made.options, *self.made.analysis, "--lot", "-o", lot,
            "--force")
        document_of_lot = json.loads((lot / "lot.json").read_text()) if (lot / "lot.json").exists() else {}
        cell(self.code, "lot", "JSON", found(document_of_lot, self.code) is not None)
        if not self.models:
            return
        again = run(self.folder, "simulate", *self.models, "--samples", 1000, "-o", "again.csv", "--force")
        cell(self.code, "simulate", "text", says(again.stdout + again.stderr, self.finding))
        self.weighed()

    def weighed(self):
        """An array of three sensors of this model: what is known of the model's noise is known of the weights."""
        model = self.models[0].read_text()
        unit = re.search(r'^unit: "(.+)"', model, re.M)
        of_unit = f"[{unit[1]}]" if unit else ""
        rows = parts.csv_text({name + of_unit: parts.noise(600, seed=i) for i, name in enumerate("abc")})
        (self.folder / "array.csv").write_text(rows)
        words = ["replay", "array.csv", "--sensors", "a,b,c", "--algorithms", "inverse-variance,mean", "-o", "weighed",
                 "--force", "--no-allan", *(word for name in "abc" for word in ("--model", f"{name}={self.models[0]}"))]
        ran = run(self.folder, *words)
        if ran.returncode != 0:
            return faults.append(f"{self.code}: {failure(ran)}")
        report = json.loads((self.folder / "weighed/report.json").read_text())
        one = found(report, self.code)
        cell(self.code, "replay of its model", "JSON", one is not None)
        return cell(self.code, "replay of its model", "text", says(ran.stdout + ran.stderr, one or self.finding))

    def all_verbs(self):
        if not self.characterize():
            return
        options = [*self.made.options]
        if not self.why("inspect") or self.made.made_by == "reading":
            self.verb("inspect", self.log, *options)
        else:
            cell(self.code, "inspect", "text", False, self.why("inspect"))
        for verb in ("allan", "psd", "fit"):
            self.verb(verb, self.log, *options, *self.analysis_of(verb))
        for verb in ("allan", "psd"):
            self.table(verb, self.log, *options, *self.analysis_of(verb))
        why = self.why("convert")
        copied = None if why else run(self.folder, "convert", self.log, *options, "-o", "copy.csv", "--force")
        cell(self.code, "convert", "text", copied and says(copied.stdout + copied.stderr, self.finding), why)
        self.model()
        self.others()
        self.remedies()

    def analysis_of(self, verb):
        """Without what only the verbs that fit know."""
        unknown = {"--verify"} if verb == "fit" else {"--verify", "--no-remedies", "--temperature", "temp"}
        return [word for word in self.made.analysis if word not in unknown]

    def mends_there(self, verb, words, flags):
        """The option that a verb prints, given to the same verb."""
        global remedies
        remedies += 1
        ran = run(self.folder, verb, *words, *flags, "--json")
        left = found(document(ran), self.code)
        self.fault_of(f"remedy of {verb}", failure(ran) if ran.returncode != 0 else left["sentence"] if left else "")

    def remedies(self):
        """Every option that is printed with the finding, and every next line, run as it stands."""
        tried = flags_in(self.said.stdout + self.said.stderr, self.finding, "characterize")
        for help_ in self.finding.get("remedies", []):
            if help_.get("options") and not tried and self.code not in rules.OF_ANOTHER_VERB:
                self.fault_of("remedy", f"the terminal does not print {help_}")
        for flags in tried:
            self.mends(flags)
        self.follow(next_line(self.said.stdout))
        if self.code in rules.OF_ANOTHER_VERB:
            self.mends_elsewhere(rules.OF_ANOTHER_VERB[self.code])
        for code in self.made.never:
            self.fault_of(f"beside {code}", "both are said" if found(self.judged, code) else "")

    def mends_elsewhere(self, words):
        """The finding and its option in the verb that has it: its next line is that option, and mends."""
        ran = run(self.folder, words[0], self.log, *self.made.options, *words[1:], "-o", "elsewhere")
        self.fault_of(f"text of {words[0]}", "" if says(ran.stdout + ran.stderr, self.finding) else failure(ran))
        again = run(self.folder, *shlex.split(next_line(ran.stdout)), "--json")
        left = found(document(again), self.code)
        self.fault_of(f"remedy of {words[0]}",
                      failure(again) if again.returncode != 0 else left["sentence"] if left else "")

    def mends(self, flags):
        global remedies
        remedies += 1
        out = self.folder / "mended"
        ran = run(self.folder, "characterize", self.log, *self.made.options, *self.made.analysis, *flags, "-o", out,
                  "--force")
        what = shlex.join(flags)
        if ran.returncode != 0:
            return self.fault_of("remedy", f"{what}: exit {ran.returncode}: {ran.stderr.strip()[-200:]}")
        report = json.loads((out / "report.json").read_text())
        left = found(report, self.code)
        self.fault_of("remedy", f"{what}: it is still there: {left['sentence']}" if left else "")
        if self.made.truth is None:
            return
        white = report["fit"]["channels"][0]["white_noise"]
        low, high = white["ci95"]
        wider = (high - low) / 2
        if not low - wider <= self.made.truth <= high + wider:
            self.fault_of("number", f"{what}: N {white['value']} [{low}, {high}], true {self.made.truth}")


def flags_of(text):
    """The flags in front of the words that go on: "--rate 250 takes the longer steps as gaps"."""
    words, out = shlex.split(text), []
    for i, word in enumerate(words):
        if word.startswith("--") or (i > 0 and words[i - 1].startswith("--") and "=" not in words[i - 1]):
            out.append(word.rstrip(",;"))
        else:
            break
    return tuple(out)


def next_line(text):
    lines = [line.split("next: sensorchar ", 1)[1] for line in text.splitlines() if "next: sensorchar " in line]
    return lines[-1] if lines else ""


def command(code, made, folder):
    """An input that is a command: its last line says the finding, in text and JSON."""
    *before, last = made.make(folder)
    for words in before:
        ran = run(folder, *words)
        if ran.returncode != 0:
            return faults.append(f"{code}: {failure(ran)}")
    verb = last[0]
    env = {key: value.format(folder=folder) for key, value in (made.env or {}).items()}
    text = run(folder, *last, env=env)
    if text.returncode != 0 and made.optional:
        return cell(code, verb, "text", False, made.optional)
    one, why = None, ""
    if verb != "plot":
        doc = document(run(folder, *last, "--json", env=env))
        one = found(doc, code)
        cell(code, verb, "JSON", one is not None)
        if one and one["severity"] == "note" and not found(doc.get("findings"), code):
            why = "its numbers hold, and it stands with its algorithm in the document and on the page"
    sentence = one or {"sentence": made.sentence}
    cell(code, verb, "text", says(text.stdout + text.stderr, sentence), why)
    if one:
        check_severity(code, one, f"{verb} --json")
        check_sentence(code, one)
    if verb == "replay" and one:
        page = (folder / "replay/report.html").read_text()
        cell(code, "page", "HTML", f'title="{code}"' in page or says(page, one))
        fused = folder / "replay/fusion.yaml"
        touches = kinds[code][1] & {"weights", "verdict", "rate", "time", "scale", "values"}
        why = "" if touches and kinds[code][0] != "note" else "it changes no weight"
        if fused.exists():
            cell(code, "fusion.yaml", "YAML", f'code: "{code}"' in fused.read_text(), why)
    Case(code, made, folder).follow(next_line(text.stdout))  # may write the same files again


done = [code for code in inputs.PARTS[part] if not only or code in only]
for code in done:
    made = inputs.PARTS[part][code]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        command(code, made, folder) if made.made_by == "command" else Log(code, made, folder).all_verbs()

faults += [f"{code}: {verb} ({how}) is not asked: take it out of finding_inputs/known.py"
           for code, verb, how in known.stale(done)]
if cells_wanted:
    for (code, verb, how), state in cells.items():
        print(f"{code}\t{verb}\t{how}\t{state}")
states = list(cells.values())
count = {state: states.count(state) for state in ("said", "known", "not said")}
print("\n".join(faults) or f"findings, {part}: {len({code for code, _, _ in cells})} codes; {count['said']} said, "
      f"{len(states) - sum(count.values())} do not matter, {count['known']} known to be wrong; {remedies} remedies run")
sys.exit(bool(faults))
