"""The verbs that Python has no door of its own to: the program does the work, and its document comes back."""
from __future__ import annotations

import contextlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
from typing import Any, Iterator, Optional, Sequence

import numpy as np

from .errors import Error, InputError, NumericError, UsageError

_KINDS: dict[int, type[Error]] = {2: UsageError, 4: NumericError}
# libchar/core/error.hpp: one line, "WHERE: error CODE: WHAT; hint: HINT".
_LINE = re.compile(r"^(?:(?P<where>.*): )?error (?P<code>E\d{4}): (?P<what>.*?)(?:; hint: (?P<hint>.*))?$")


def path() -> str:
    """The program: $SENSORCHAR, that of this package or its build, or that of the system."""
    package = pathlib.Path(__file__).resolve().parent
    built = pathlib.Path(__file__).parent.parent.parent / "tools" / "sensorchar"
    for place in (os.environ.get("SENSORCHAR"), package / "bin" / "sensorchar", built):
        if place and os.access(place, os.X_OK):
            return str(place)
    found = shutil.which("sensorchar")
    if found is None:
        raise UsageError("the program sensorchar is needed for this, and is not on the path", "E0208", "sensorchar",
                         "install the package sensorchar, or name the program in the variable SENSORCHAR")
    return found


def words_of(options: dict[str, Any]) -> list[str]:
    """The options of the program that keywords stand for: fail_if="rmse+5%" is --fail-if=rmse+5%."""
    words = []
    for key, value in options.items():
        flag = "--" + key.rstrip("_").replace("_", "-")
        if value is True:
            words.append(flag)
        elif value is not None and value is not False:
            words += [f"{flag}={one}" for one in (value if isinstance(value, (list, tuple)) else [value])]
    return words


def _in_python(text: str) -> str:
    """Options as keywords ("--still" is `still`), but in the commands that a sentence quotes."""
    return re.sub(r"(sensorchar [a-z]+ [^;]*)|(?<![\w-])--([a-z][a-z-]*)",
                  lambda found: found[1] or f"`{found[2].replace('-', '_')}`", text)


@contextlib.contextmanager
def known_as(path: pathlib.Path, name: str) -> Iterator[None]:
    """A refusal of what is in memory names it, not the file of the call that it was written to."""
    try:
        yield
    except Error as error:
        error.args = (error.args[0].replace(str(path), name),)
        error.where = error.where.replace(str(path), name)
        raise


def run(verb: str, words: Sequence[str]) -> bytes:
    """What the program prints. Raises what it refuses."""
    done = subprocess.run([path(), verb, *words, "--quiet"], stdin=subprocess.DEVNULL, capture_output=True)
    if done.returncode == 0:
        return done.stdout
    said = done.stderr.decode(errors="replace").strip().splitlines() or [f"sensorchar ended with {done.returncode}"]
    line = next((found for found in map(_LINE.match, reversed(said)) if found), None)
    kind = _KINDS.get(done.returncode, InputError)
    if line is None:
        raise kind(said[-1])
    raise kind(*(_in_python(part or "") for part in line.group(0, "code", "where", "hint")))


def _arrays(value: Any) -> Any:
    """Lists of numbers as arrays, NaN where a value is absent."""
    if isinstance(value, dict):
        return {key: _arrays(item) for key, item in value.items()}
    if not isinstance(value, list):
        return value
    if len(value) > 1 and all(item is None or type(item) in (int, float) for item in value):
        return np.array([np.nan if item is None else item for item in value], dtype=np.float64)
    return [_arrays(item) for item in value]


def renamed(value: Any, path: str, name: str) -> Any:
    """With another name for a file, wherever a text holds it."""
    if isinstance(value, dict):
        return {key: renamed(item, path, name) for key, item in value.items()}
    if isinstance(value, list):
        return [renamed(item, path, name) for item in value]
    return value.replace(path, name) if isinstance(value, str) else value


def document(verb: str, words: Sequence[str]) -> Any:
    """The document that the program prints (docs/json.md), long lists of numbers as arrays."""
    return _arrays(json.loads(run(verb, [*words, "--json"])))


@contextlib.contextmanager
def folder(name: Optional[str] = None) -> Iterator[pathlib.Path]:
    """A folder of one call."""
    with tempfile.TemporaryDirectory(prefix="libchar-") as made:
        place = pathlib.Path(made) / (name or ".")
        place.mkdir(exist_ok=True)
        yield place


def main() -> None:
    """The program in the place of this process: the command `sensorchar` of a wheel."""
    os.execv(path(), ["sensorchar", *sys.argv[1:]])
