#!/usr/bin/env python3
"""What docs/security.md promises, looked at from outside: each verb reads the files that it was named, writes
where it was told to, opens no socket and starts no program.

usage: promise_test.py PROGRAM

USER is set: where it is not, glog (which Ceres brings) asks the system for the user's name before main,
perhaps through the local socket of nscd. Needs strace; exit 77 where it is missing or may not trace.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from fault_loops import VERBS, inputs

# What the loader, the C library, TBB (how many processors?) and the terminal look at.
SYSTEM = ("/lib", "/usr/", "/etc/ld.so", "/etc/ssl/", "/proc/self/", "/proc/sys/", "/proc/meminfo", "/proc/cpuinfo",
          "/proc/cgroups", "/proc/mounts",
          "/sys/devices/system/", "/sys/fs/cgroup", "/sys/kernel/mm", "/dev/null", "/dev/tty")
NEVER = {"socket", "connect", "bind", "listen", "accept", "accept4", "sendto", "sendmsg", "fork", "vfork", "ptrace",
         "chmod", "fchmodat", "chown", "lchown", "symlink",
         "symlinkat", "mknod", "mknodat", "mount", "setuid", "kexec_load", "memfd_create"}
CHANGES = {"rename", "renameat", "renameat2", "link", "linkat", "unlink", "unlinkat", "mkdir", "mkdirat", "rmdir",
           "truncate", "utimensat"}
CALL = re.compile(r"^(?:\d+ +)?(?:\[pid +\d+\] )?(\w+)\((.*)$")
NAME = re.compile(r'"((?:[^"\\]|\\.)*)"')


def trace(program, words, folder):
    log = Path(str(folder) + ".strace")
    ran = subprocess.run(["strace", "-f", "-qq", "-e", "signal=none", "-e", "trace=%file,%network,%process,kill",
                          "-o", log, program, *words], cwd=folder,
                         stdin=subprocess.DEVNULL, capture_output=True, env=dict(os.environ, USER="somebody"))
    return ran, log.read_text(errors="replace").splitlines() if log.exists() else []


def below(name, folder):
    relative = not name.startswith("/") and ".." not in Path(name).parts
    return Path(name) == folder or folder in Path(name).parents or relative


def wrong_in(lines, folder):
    wrong, programs = [], 0
    for line in lines:
        call = CALL.match(line)
        if not call or " = -1 ENOENT" in line:
            continue
        what, rest = call[1], call[2]
        names = NAME.findall(rest)
        if what in NEVER:
            wrong.append(line)
        elif what in ("execve", "execveat"):
            programs += 1
        elif what in ("clone", "clone3") and "CLONE_THREAD" not in rest:
            wrong.append(line)
        elif what in CHANGES and not all(below(name, folder) or name.startswith("/proc/self/fd/") for name in names):
            wrong.append(line)
        elif what in ("open", "openat", "creat"):
            writes = re.search(r"O_WRONLY|O_RDWR|O_CREAT|O_TRUNC", rest)
            if not all(below(name, folder) or (not writes and name.startswith(SYSTEM))
                       or name in ("/dev/null", "/dev/tty") for name in names[:1]):
                wrong.append(line)
    if programs != 1:
        wrong.append(f"{programs} programs were started")
    return wrong


def main():
    program = str(Path(sys.argv[1]).resolve())
    if not shutil.which("strace") or subprocess.run(["strace", "-qq", "-o", "/dev/null", "true"],
                                                    capture_output=True).returncode != 0:
        print("SKIPPED: no strace, or it may not trace")
        sys.exit(77)
    bad = 0
    with tempfile.TemporaryDirectory() as root:
        for name, verb in VERBS.items():
            folder = Path(root).resolve() / name.replace(" ", "-")
            folder.mkdir()
            for file, text in inputs(1).items():
                (folder / file).write_text(text)
            if "prepare" in verb:
                subprocess.run([program, *verb["prepare"]], cwd=folder, check=True, capture_output=True)
            ran, lines = trace(program, verb["words"], folder)
            if ran.returncode != 0 or not any("execve(" in line for line in lines):
                print(f"{name}: exit {ran.returncode}: {ran.stderr.decode()}")
                bad += 1
            for line in wrong_in(lines, folder):
                print(f"{name}: {line}")
                bad += 1
    print(f"{len(VERBS)} verbs looked at, {bad} wrong")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
