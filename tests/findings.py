"""Every finding that a source makes has its row in libchar/core/findings.tsv, every row is used, and docs/findings.md
has the rows. Every row has an input in the matrix (tests/cli/finding_inputs). usage: findings.py ROOT [--write]"""
import pathlib
import re
import sys

sys.dont_write_bytecode = True
root = pathlib.Path(sys.argv[1])
NAMED = re.compile(r'"([a-z][a-z0-9_]+)"')

rows = [line.split("\t") for line in (root / "libchar/core/findings.tsv").read_text().splitlines()
        if not line.startswith("#")]
codes = [row[0] for row in rows]
faults = []
if codes != sorted(set(codes)):
    faults.append("findings.tsv: its rows are not in the order of their codes")
MADE = re.compile(r'(?:\bfinding\(|(?:warnings_?|remarks|info_?\.warnings)\.add\(|\badd\(\s*warnings,)\s*([^,]*?),')


def text_of(path):
    return re.sub(r"//[^\n]*", "", path.read_text())


sources = sorted([*(root / "libchar").rglob("*.[ch]pp"), *(root / "tools").rglob("*.cpp")])
named = {code for path in sources for code in NAMED.findall(text_of(path))}
for path in [*sources, *sorted((root / "tests").rglob("*.cpp"))]:
    faults += [f"{path.relative_to(root)}: `{code}` has no row in libchar/core/findings.tsv"
               for made in MADE.finditer(text_of(path)) for code in NAMED.findall(made[1]) if code not in codes]
sys.path.insert(0, str(root / "tests/cli"))
import finding_inputs  # noqa: E402
faults += finding_inputs.unmatched(codes)
faults += [f"findings.tsv: nobody makes `{code}`" for code in codes if code not in named]


def effects(cell):
    return ", ".join(part.replace(":", " ").replace("too-", "too ") for part in cell.split(", ")) if cell else ""


table = ["| code | severity | what it means | it changes | what to do |", "|---|---|---|---|---|"]
table += [f"| `{code}` | {severity} | {meaning} | {effects(cell)} | {remedy} |"
          for code, severity, title, meaning, remedy, cell in rows]
page = root / "docs/findings.md"
text = page.read_text()
head = text[:text.index("| code | severity")]
if text != head + "\n".join(table) + "\n":
    if "--write" in sys.argv:
        page.write_text(head + "\n".join(table) + "\n")
    else:
        faults.append("docs/findings.md is not what findings.tsv says: --write")
print("\n".join(faults) or f"findings: {len(codes)} kinds, each with a row, each made somewhere")
sys.exit(bool(faults))
