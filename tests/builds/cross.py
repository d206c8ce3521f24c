"""Has another compiler look at every source of a configured build, without making an object: a cross compiler needs
no libraries then.

usage: cross.py BUILD COMPILER
BUILD was configured with CMAKE_EXPORT_COMPILE_COMMANDS and the portable path.
Headers of libraries are those of this machine, behind the compiler's own: they know the processor by its macros.
"""
import concurrent.futures
import json
import os
import pathlib
import shlex
import subprocess
import sys


# What a library configured when it was built; the compiler's own library comes before.
HERE = "/usr/include/" + subprocess.run(["c++", "-print-multiarch"], capture_output=True, text=True).stdout.strip()


def checked(entry, compiler):
    words = shlex.split(entry["command"])
    kept, skip = [], False
    for word, after in zip(words, [*words[1:], ""]):
        if skip:
            skip = False
        elif word == "-isystem":
            kept += ["-idirafter", after]
            skip = True
        elif word.startswith(("-I", "-D", "-std=")):
            kept.append(word)
    ran = subprocess.run([compiler, *kept, "-w", "-fsyntax-only", "-idirafter", "/usr/include", "-idirafter", HERE,
                          entry["file"]], cwd=entry["directory"], capture_output=True, text=True)
    return "" if ran.returncode == 0 else f"{entry['file']}:\n{ran.stderr[:2000]}"


def main():
    build, compiler = pathlib.Path(sys.argv[1]), sys.argv[2]
    entries = [e for e in json.loads((build / "compile_commands.json").read_text())
               if not e["file"].endswith(("cmake_pch.hxx.cxx", ".c")) and pathlib.Path(e["file"]).exists()]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        faults = [f for f in pool.map(lambda e: checked(e, compiler), entries) if f]
    print("\n".join(faults) or f"{len(entries)} sources are sound for {compiler}")
    return bool(faults) or not entries


sys.exit(main())
