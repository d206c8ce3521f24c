"""Runs the commands of README.md and of the pages in PAGES as printed, and compares their output and pictures.

usage: readme.py ROOT [--write] [--program PROGRAM]
A ```sh block holds one command per line; a ```text block directly after it is its output, to the last character. The
block after the comment `test command` is not run here (this test is part of it): .ci/run runs exactly that one. A
picture docs/images/NAME.svg is the file NAME.svg that a command of its page wrote into demo-report, to the last byte;
one that measures time (IMAGES_OF_TIMES) cannot be, and is written by .ci/figures. --write brings output and pictures
up to date.
"""
import difflib
import os
import pathlib
import re
import subprocess
import sys

PAGES = ["README.md", "docs/verbs.md", *(f"docs/howto/{name}.md" for name in (
    "imu-bag-to-kalibr", "px4-log-to-gazebo-and-ekf2", "which-sensor", "redundant-sensors", "clock"))]
IMAGES_OF_TIMES = {"recipes.svg"}
BLOCK = re.compile(r"(<!-- test command -->\n)?```sh\n(.*?)```\n(?:(\n?```text\n)(.*?)```)?", re.S)


def ran(page, commands, root, environment):
    run = subprocess.run(["bash", "-euo", "pipefail", "-c", commands], cwd=root, env=environment,
                         capture_output=True, text=True)
    if run.returncode != 0:
        sys.exit(f"{page}: this fails with code {run.returncode}:\n{commands}{run.stdout}{run.stderr}")
    return run.stdout


def check_pictures(page, text, root, write):
    for name in set(re.findall(r"\]\((?:[\w./-]*/)?images/([\w-]+\.svg)\)", text)) - IMAGES_OF_TIMES:
        drawn, kept = root / "demo-report" / name, root / "docs/images" / name
        if not drawn.is_file():
            sys.exit(f"{page}: no command writes demo-report/{name}, the picture docs/images/{name}")
        if write:
            kept.write_bytes(drawn.read_bytes())
        elif drawn.read_bytes() != kept.read_bytes():
            sys.exit(f"{page}: docs/images/{name} is not what its command draws: --write")


def main():
    root, write = pathlib.Path(sys.argv[1]).resolve(), "--write" in sys.argv
    program = root / "build/tools/sensorchar"
    if "--program" in sys.argv:
        program = pathlib.Path(sys.argv[sys.argv.index("--program") + 1]).resolve()
    environment = dict(os.environ, PATH=f"{program.parent}:{os.environ['PATH']}", TERM="dumb")
    count = 0
    for page in PAGES:
        text = (root / page).read_text()
        blocks = [found for found in BLOCK.finditer(text) if not found[1]]
        if not blocks:
            sys.exit(f"{page}: no block of commands was found")
        for _, commands, head, shown in (found.groups() for found in blocks):
            printed = ran(page, commands, root, environment)
            count += 1
            if not head or printed == shown:
                continue
            if not write:
                diff = difflib.unified_diff(shown.splitlines(), printed.splitlines(), page, "the program", lineterm="")
                sys.exit(f"{page}: the output has changed:\n" + "\n".join(diff))
            text = text.replace(f"```sh\n{commands}```\n{head}{shown}```", f"```sh\n{commands}```\n{head}{printed}```")
        check_pictures(page, text, root, write)
        if write:
            (root / page).write_text(text)
    print(f"README: {count} blocks of commands of {len(PAGES)} pages ran and printed what is shown")


if __name__ == "__main__":
    main()
