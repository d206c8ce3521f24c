"""What every command keeps, whatever its options (docs/errors.md, docs/reliability.md, docs/security.md):
wrong(…) says what it breaks."""
import hashlib
import json
import os
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[3]
NO_NUMBER = re.compile(r"(?<![\w./-])[-+]?(?:nan|inf)(?![\w-])", re.IGNORECASE)
CONTROL = re.compile(rb"[\x00-\x08\x0b-\x1f\x7f]")
COLOURS = re.compile(rb"\x1b\[[0-9;]*m")
# A page on stdout brings its program; gnuplot's word for no number in a row of data is NaN.
SCRIPT = re.compile(r"<script>.*?</script>|^\$series\d+ << EOD$.*?^EOD$", re.DOTALL | re.MULTILINE)
SLOWEST_S = 10
STRESS_S = 30  # bench --stress: its work is fixed, 14 s on the slowest machine so far


def exit_codes():
    """code → exit code, of the table of errors."""
    rows = re.findall(r"^\| (E\d{4}) \| ([\d, ]+) \|", (ROOT / "docs" / "errors.md").read_text(), re.M)
    return {code: [int(number) for number in numbers.split(",")] for code, numbers in rows}


def state(folder, inside=""):
    """Path → what tells whether a file was touched."""
    out = {}
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.is_dir(follow_symlinks=False):
                out.update(state(entry.path, f"{inside}{entry.name}/"))
            else:
                status = entry.stat(follow_symlinks=False)
                out[inside + entry.name] = (status.st_ino, status.st_mtime_ns, status.st_size)
    return out


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def not_finite(text):
    raise ValueError(text)


def wrong_texts(words, out, err):
    text = out.decode(errors="replace") + err.decode(errors="replace")
    quoted = re.sub(r'"[^"]*"|got .*|NaN cells|expected nan or error', "", SCRIPT.sub("", text))
    given = any(NO_NUMBER.search(word) for word in words)
    if not given and NO_NUMBER.search(quoted):
        return "nan or inf in text: " + quoted[max(0, NO_NUMBER.search(quoted).start() - 60):][:120].replace("\n", "⏎")
    if CONTROL.search(COLOURS.sub(b"", out + err)):
        return "control bytes on the terminal"
    return ""


def wrong_errors(code, err, exits):
    first = re.compile(r"(?:^|: )error (E\d{4}):")
    found = [first.search(re.sub(r"\x1b\[[0-9;]*m", "", line)) for line in err.splitlines()]
    errors = [one.group(1) for one in found if one]
    if code == 0:
        return f"exit 0 with {errors}" if errors else ""
    if len(errors) != 1:
        return f"{len(errors)} errors for exit code {code}"
    if errors[0] not in exits:
        return f"{errors[0]} is not in docs/errors.md"
    if code not in exits[errors[0]]:
        return f"exit code {code} for {errors[0]}, whose own is {exits[errors[0]]}"
    return ""


def wrong_json(words, code, out):
    to_stdout = not any(w in ("-o", "--output") or w.startswith("--output=") for w in words) or out.strip()
    if code != 0 or "--json" not in words or not to_stdout:
        return ""
    try:
        json.loads(out, parse_constant=not_finite)
    except ValueError as problem:
        return f"--json prints no document: {problem}"
    return ""


def may_replace(name, words, outputs):
    """With --force a file that is named as the output and lies in nothing that is read."""
    read = [word for word in words if word not in outputs]
    is_read = any(name == r or name.startswith(r.rstrip("/") + "/") for r in read)
    return "--force" in words and name in outputs and not is_read


def wrong_files(folder, before, after, code, outputs, words):
    """Inputs are as they were, results are where they were asked for, and a refused run leaves none; units of
    a fleet that are done stay done."""
    changed = [name for name in before if after.get(name) != before[name] and not may_replace(name, words, outputs)]
    if changed:
        return f"input changed: {', '.join(changed[:4])}"
    fresh = sorted(set(after) - set(before))
    if fresh and code in (2, 3, 5) and words[:2] != ["fleet", "run"]:
        return f"left after exit code {code}: {', '.join(fresh[:4])}"
    strange = [name for name in fresh if not any(
        name == o or name.startswith(o.rstrip("/") + "/") or name.startswith(o.rsplit(".",
            1)[0] + ".") for o in outputs)]
    if words[:2] == ["fleet", "export"]:  # a scheduler's scripts lie in the fleet's own folder
        strange = [name for name in strange if not any(name.startswith(w.rstrip("/") + "/") for w in words[2:])]
    if strange:
        return f"written where nobody asked: {', '.join(strange[:4])}"
    for name in fresh:
        if name.endswith(".json"):
            try:
                json.loads((pathlib.Path(folder) / name).read_text(), parse_constant=not_finite)
            except ValueError as problem:
                return f"{name} is no JSON: {problem}"
    return ""


def samples_ordered(words):
    """Steps of a simulation: --rate x --duration x --oversampling, where they are numbers."""
    product = 1.0
    for flag in ("--rate", "--duration", "--oversampling"):
        for at, word in enumerate(words):
            value = word[len(flag) + 1:] if word.startswith(flag + "=") else (words[at + 1:at + 2] or [""])[0]
            if word.split("=")[0] == flag and re.fullmatch(r"[0-9.]+(e[0-9]+)?", value):
                product *= float(value)
    return product if words[0] == "simulate" else 0


def wrong(words, done, folder, states, outputs, exits):
    """done: (exit code or None, stdout, stderr, CPU seconds); states: of the folder, before and after."""
    code, out, err, seconds = done
    text = err.decode(errors="replace")
    if code is None or seconds > (STRESS_S if "--stress" in words else SLOWEST_S):
        if samples_ordered(words) > 1e9:
            return ""  # 3 s at 1 GHz, each of 64 steps: as long as it takes, or until the file may not grow
        return f"slow: {seconds:.1f} s"
    if code < 0:
        return f"signal {-code}"
    if "internal error" in text or code not in (0, 2, 3, 4, 5, 6, 75):
        return "internal error: " + text[-160:].replace("\n", " ")
    return (wrong_errors(code, text, exits) or wrong_texts(words, out, err) or wrong_json(words, code, out)
            or wrong_files(folder, *states, code, outputs, words))
