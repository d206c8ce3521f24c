"""Runs the commands of README.md as they stand and compares what they print with what the README shows.

A ```sh block holds one command a line; a ```text block directly behind it is its output, to the last
character. The block behind the comment `test command` is not run here (this test is part of it): .ci/run runs
exactly that one.
"""
import difflib
import os
import pathlib
import re
import subprocess
import sys

root = pathlib.Path(sys.argv[1])
readme = (root / "README.md").read_text()
environment = dict(os.environ, PATH=f"{root / 'build' / 'tools'}:{os.environ['PATH']}", TERM="dumb")
blocks = re.findall(r"(<!-- test command -->\n)?```sh\n(.*?)```\n(?:\n?```text\n(.*?)```)?", readme, re.S)
ran = 0
for is_test, commands, shown in blocks:
    if is_test:
        continue
    run = subprocess.run(["bash", "-euo", "pipefail", "-c", commands], cwd=root, env=environment,
                         capture_output=True, text=True)
    if run.returncode != 0:
        sys.exit(f"README: this fails with code {run.returncode}:\n{commands}{run.stdout}{run.stderr}")
    if shown and run.stdout != shown:
        diff = difflib.unified_diff(shown.splitlines(), run.stdout.splitlines(), "README.md", "the program",
                                    lineterm="")
        sys.exit("README: the output has changed:\n" + "\n".join(diff))
    ran += 1
if ran < 3:
    sys.exit(f"README: only {ran} blocks were found")
print(f"README: {ran} blocks of commands ran and printed what is shown")
