"""Every public header compiles alone: the first thing that a stranger includes may be any of them.

usage: headers_alone.py ROOT [COMPILER] (a gate, not a test of each build: some 100 headers, a second each)
"""
import concurrent.futures
import os
import pathlib
import subprocess
import sys

root = pathlib.Path(sys.argv[1]).resolve()
compiler = sys.argv[2] if len(sys.argv) > 2 else "c++"
headers = sorted(path.relative_to(root).as_posix() for pattern in ("*.hpp", "*/*.hpp") for path in (root / "libchar").glob(pattern))


def compile_alone(header):
    command = [compiler, "-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", f"-I{root}", "-isystem", "/usr/include/eigen3", "-x", "c++", "-"]
    return subprocess.run(command, input=f'#include "{header}"\n', capture_output=True, text=True)


with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
    failed = [(header, run.stderr) for header, run in zip(headers, pool.map(compile_alone, headers)) if run.returncode]
for header, message in failed:
    print(f"{header} does not compile alone:\n{message}")
print(f"{len(headers)} public headers, {len(failed)} do not compile alone")
sys.exit(bool(failed))
