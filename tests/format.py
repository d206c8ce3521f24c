"""Fails on sources that clang-format would change (.clang-format). usage: format.py ROOT
Exit code 77 (skipped) where clang-format 14 is not installed: other versions break lines elsewhere."""
import pathlib
import re
import shutil
import subprocess
import sys

root = pathlib.Path(sys.argv[1])
program = shutil.which("clang-format-14") or shutil.which("clang-format")
version = program and subprocess.run([program, "--version"], capture_output=True, text=True).stdout
if not version or not re.search(r"version 14\.", version):
    print("SKIPPED: clang-format 14 is not installed")
    sys.exit(77)
sources = sorted(p for folder in ("libchar", "tools", "tests", "docs") for p in (root / folder).rglob("*.[ch]pp"))
check = subprocess.run([program, "--dry-run", "-Werror", *map(str, sources)], capture_output=True, text=True)
wrong = sorted({line.split(":")[0] for line in check.stderr.splitlines() if "clang-format-violations" in line})
print("\n".join(f"{pathlib.Path(p).relative_to(root)}: clang-format -i" for p in wrong)
      or f"format: {len(sources)} sources as .clang-format has them")
sys.exit(bool(wrong or check.returncode))
