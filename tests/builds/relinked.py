"""How a test program of an ordinary build is linked with another build of the library."""
import os
import re
import shlex
import subprocess

ARCHIVES = ("libchar.a", "libcharcurves.a")


def words_of(build, target):
    """The words of the command that links `target`."""
    commands = subprocess.run(["ninja", "-C", str(build), "-t", "commands", target], capture_output=True, text=True,
                              check=True).stdout.strip().split("\n")
    return shlex.split(re.sub(r"^: && | && (?:cd .*|:)$", "", commands[-1]))


def of_library(word):
    return word.startswith("libchar/")


def link_words(build, target, library, beside=None):
    """The command that links `target`, to be run in `build`, with the archives of `library`, and the libraries that
    its own target `beside` is linked with; PROGRAM stands for what it writes."""
    words = words_of(build, target)
    words[words.index("-o") + 1] = "PROGRAM"
    first = next(i for i, word in enumerate(words) if of_library(word))
    words = [word for word in words if not of_library(word)]
    words[first:first] = ["-Wl,--start-group", *(str(library / "libchar" / a) for a in ARCHIVES), "-Wl,--end-group"]
    if beside:
        words += [word for word in words_of(library, beside) if word.startswith("-l")
                  or os.path.isabs(word) and re.search(r"\.(?:a|so)$", word)]
    return words
