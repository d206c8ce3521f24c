"""docs/library.md against docs/examples: every example stands in the page to the last character, and prints
what the page shows.

usage: library_page.py ROOT PROGRAM… [--write]
--write puts code and output into the page. In the page a line `<!-- NN_name.cpp -->` precedes the ```cpp
block of an example, a ```text block directly behind it is its output.
"""
import difflib
import os
import pathlib
import re
import subprocess
import sys
import tempfile

root = pathlib.Path(sys.argv[1]).resolve()
write = sys.argv[-1] == "--write"
programs = {pathlib.Path(p).name.removeprefix("example_"): os.path.abspath(p) for p in sys.argv[2:] if p != "--write"}
page = (root / "docs/library.md").read_text()
BLOCK = re.compile(r"<!-- (\w+)\.cpp -->\n(?:```cpp\n(.*?)```\n(?:\n?```text\n(.*?)```\n)?)?", re.S)
quotes = {name: (code, shown) for name, code, shown in BLOCK.findall(page)}


def refuse_difference(what, shown, real):
    if shown != real:
        diff = difflib.unified_diff(shown.splitlines(), real.splitlines(), "docs/library.md", what, lineterm="")
        sys.exit(f"{what} is not what the page shows:\n" + "\n".join(diff))


examples = sorted(path.stem for path in (root / "docs/examples").glob("*.cpp"))
if examples != sorted(quotes) or examples != sorted(programs):
    sys.exit(f"examples {examples}\nin the page {sorted(quotes)}\ncompiled {sorted(programs)}")
ran = {}
with tempfile.TemporaryDirectory() as folder:
    os.symlink(root / "fixtures", pathlib.Path(folder) / "fixtures")
    for name in examples:
        run = subprocess.run([programs[name]], cwd=folder, capture_output=True, text=True)
        if run.returncode != 0:
            sys.exit(f"{name} fails with code {run.returncode}: {run.stdout}{run.stderr}")
        ran[name] = (root / f"docs/examples/{name}.cpp").read_text(), run.stdout
if write:
    block = "<!-- {0}.cpp -->\n```cpp\n{1}```\n\n```text\n{2}```\n".format
    (root / "docs/library.md").write_text(BLOCK.sub(lambda found: block(found[1], *ran[found[1]]), page))
    sys.exit()
for name in examples:
    refuse_difference(f"{name}.cpp", quotes[name][0], ran[name][0])
    refuse_difference(f"the output of {name}", quotes[name][1], ran[name][1])
print(f"docs/library.md: {len(examples)} examples stand as they are and print what is shown")
