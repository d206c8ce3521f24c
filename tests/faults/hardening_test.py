#!/usr/bin/env python3
"""How the program was built and linked, by readelf: no fixed addresses, tables read-only after the start, no
stack that runs, guards in functions and in the C library's copies.

usage: hardening_test.py PROGRAM

Needs readelf (binutils); exit 77 where it is missing.
"""

import shutil
import subprocess
import sys


def readelf(option, program):
    return subprocess.run(["readelf", "-W", option, program], check=True, capture_output=True, text=True).stdout


def main():
    program = sys.argv[1]
    if not shutil.which("readelf"):
        print("SKIPPED: no readelf")
        sys.exit(77)
    head, segments, dynamic, symbols = (readelf(o, program) for o in ("-h", "-l", "-d", "--dyn-syms"))
    stack = [line for line in segments.splitlines() if "GNU_STACK" in line]
    wrong = []
    for holds, what in [
        ("DYN" in head.split("Type:")[1].splitlines()[0], "position-independent (PIE)"),
        ("GNU_RELRO" in segments, "relocations read-only (RELRO)"),
        ("BIND_NOW" in dynamic or "NOW" in dynamic.split("FLAGS_1")[-1], "all symbols bound at the start (full RELRO)"),
        (bool(stack) and "RWE" not in stack[0], "a stack that is not executable"),
        ("__stack_chk_fail" in symbols, "stack protector"),
        ("_chk@" in symbols.replace("__stack_chk_fail@", ""), "_FORTIFY_SOURCE"),
        ("RPATH" not in dynamic, "no RPATH"),
    ]:
        print(f"{'yes' if holds else 'NO ':4} {what}")
        if not holds:
            wrong.append(what)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
