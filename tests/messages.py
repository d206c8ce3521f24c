"""Messages of the library speak of the library; tools/help/flag_names.cpp says them with flags.

usage: messages.py ROOT
A string in libchar/ names no flag ("--rate"). A word in backquotes that stands alone is an option or a
function that flag_names.cpp has a flag for, or it is listed below as none. Every row of flag_names.cpp is
used by a message, and its flag exists.
"""
import pathlib
import re
import sys

# Words in backquotes for which there is nothing to type on the command line.
NO_FLAGS = {
    "frequency_hz": "key of a sensor model",
    "gain_about": "key of fusion.yaml",
    "gain_sd": "key of fusion.yaml",
    "level_sd": "key of fusion.yaml",
    "name": "key of a document",
    "none": "word of a scene",
    "options": "part of a fusion algorithm, in a message of the compiler",
    "ratio": "key of a sensor model",
    "recording": "key of a scene",
    "recursive": "value of an option",
    "repeat": "key of a signal in a scene",
    "scale": "key of a scene",
    "simulate": "key of a scene",
    "taps": "key of a sensor model",
    "tau_s": "key of a sensor model",
    "unit": "key of a sensor model",
    "version": "key of a document",
}
TOKEN = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"(\w*)\((?P<raw>.*?)\)\1"|"(?P<text>(?:[^"\\\n]|\\.)*)"|\'(?:[^\'\\\n]|\\.)+\'', re.S)
FLAG = re.compile(r"(?<![\w!-])--[a-z]")
WORD = re.compile(r"`([a-z][a-z0-9_]*)`")


def strings(text):
    """(line, string) of every literal; neighbours that the compiler joins are one."""
    found, end = [], 0
    for token in TOKEN.finditer(text):
        value = token["raw"] if token["raw"] is not None else token["text"]
        if value is None:
            continue
        if found and not text[end:token.start()].strip():
            found[-1][1] += value
        else:
            found.append([text.count("\n", 0, token.start()) + 1, value])
        end = token.end()
    return found


root = pathlib.Path(sys.argv[1])
table = (root / "tools/help/flag_names.cpp").read_text()
flags = dict(re.findall(r'\{"(\w+)", "([^"]+)"\}', table))
typed = {word
         for path in sorted((root / "tools").rglob("*.cpp")) if path.name != "flag_names.cpp"
         for _, string in strings(path.read_text())
         for word in re.split(r"[, ]", string)}
verbs = {path.stem for path in (root / "tools/verbs").glob("*.cpp")} | {"sensorchar"}
faults, used = [], set()

for path in sorted((root / "libchar").rglob("*.[ch]pp")):
    used |= set(re.findall(r'\{"([a-z_0-9]+)", ', path.read_text()))  # settings of a finding's help
    for line, string in strings(path.read_text()):
        place = f"{path.relative_to(root)}:{line}"
        # Scripts and commands for other programs name those programs' flags.
        others = "libchar/fleet/engines/", "libchar/log/csv/head/other_content.cpp"
        if FLAG.search(string) and not place.startswith(others):
            faults.append(f"{place}: names a flag; the library has options, such as `rate_hz`: {string}")
        for word in WORD.findall(string):
            used.add(word)
            if word not in flags and word not in NO_FLAGS:
                faults.append(f"{place}: `{word}` has no row in tools/help/flag_names.cpp and is not listed in "
                              f"tests/messages.py")
for option, flag in flags.items():
    if option not in used:
        faults.append(f"tools/help/flag_names.cpp: no message names `{option}`")
    unknown = [word for word in flag.split() if word.startswith("--") and word not in typed]
    unknown += [word for word in flag.split()[:2] if flag.startswith("sensorchar ") and word not in verbs]
    if unknown:
        faults.append(f"tools/help/flag_names.cpp: {option}: {unknown[0]} is no flag and no verb of the program")
if list(flags) != sorted(flags):
    faults.append("tools/help/flag_names.cpp: the rows are not in order")
for word in sorted(NO_FLAGS):
    if word not in used or word in flags:
        faults.append(f"tests/messages.py: {word} need not be listed")

print("\n".join(faults) or f"messages: {len(flags)} options with a flag, all used; no string of the library names a "
                           f"flag")
sys.exit(bool(faults))
