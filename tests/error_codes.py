"""docs/errors.md against the sources: every code stands there once, with the exit code and the files that raise it.

usage: error_codes.py ROOT [--write]
The table's meaning is written by hand; --write brings its files up to date. A code that a second file wants
to raise must fit the meaning that stands in the table: that is what the list of files is for.
"""
import collections
import pathlib
import re
import sys

EXIT = {"usage": 2, "input": 3, "numeric": 4, "output": 5, "check": 6, "again": 75}
OPENING = rf'(?:ErrorKind::|\b)({"|".join(EXIT)})(?:,|_error\()\s*'
RAISED = re.compile(rf'{OPENING}"(E\d{{4}})"')
ROW = re.compile(r"^\| (E\d{4}) \| ([\d, ]+) \| (.+?) \| ?(.*?) ?\|$")

root = pathlib.Path(sys.argv[1])
page = root / "docs/errors.md"
faults = []

files, kinds = collections.defaultdict(set), collections.defaultdict(set)
for folder in ("libchar", "tools"):
    for path in sorted((root / folder).rglob("*.cpp")):
        text = path.read_text()
        for code in re.findall(r'"(E\d{4})"', text):
            files[code].add(path.relative_to(root).as_posix())
        for kind, code in RAISED.findall(text):
            kinds[code].add(EXIT[kind])
for path in sorted((root / "tools/python").rglob("*.py")):
    for kind, code in re.findall(r'raise (Usage|Input|Numeric)Error\(.*?"(E\d{4})"', path.read_text(), re.S):
        files[code].add(path.relative_to(root).as_posix())
        kinds[code].add(EXIT[kind.lower()])

rows, lines = {}, page.read_text().splitlines()
for number, line in enumerate(lines, 1):
    row = ROW.match(line)
    if not row:
        continue
    code = row[1]
    if code in rows:
        faults.append(f"{page}:{number}: {code} stands twice")
    rows[code] = {int(e) for e in row[2].split(",")}, row[4]
    where = ", ".join(f"`{f}`" for f in sorted(files.get(code, [])))
    if code not in files:
        faults.append(f"{page}:{number}: {code} is raised nowhere")
    elif row[4] != where:
        faults.append(f"{page}:{number}: {code} is raised in {where}, not in {row[4]}: same meaning? then --write")
    lines[number - 1] = f"| {code} | {row[2]} | {row[3]} | {where} |"
    if kinds[code] and kinds[code] != rows[code][0]:
        faults.append(f"{page}:{number}: {code} ends with exit codes {sorted(kinds[code])}, not "
                      f"{sorted(rows[code][0])}")
for folder in ("libchar", "tools"):
    for path in sorted((root / folder).rglob("*.cpp")):
        text = path.read_text()
        for bare in re.finditer(rf'{OPENING}""', text):
            faults.append(f"{path.relative_to(root)}:{text[:bare.start()].count(chr(10)) + 1}: an error without a code")
for code in sorted(set(files) - set(rows)):
    faults.append(f"{page}: {code} is not there; it is raised in {', '.join(sorted(files[code]))}")
if list(rows) != sorted(rows):
    faults.append(f"{page}: the codes are not in order")

if "--write" in sys.argv:
    page.write_text("\n".join(lines) + "\n")
print("\n".join(faults) or f"error codes: {len(rows)}, each with one meaning")
sys.exit(bool(faults))
