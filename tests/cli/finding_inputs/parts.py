"""What the inputs are made of: noise, tables, raw logs and arrays, and the record of an input."""
import dataclasses
import json
import math
import random
import struct
from collections.abc import Callable

RATE, N = 100.0, 0.02  # Hz, U·√s: of every record that says nothing else
PROGRAM = "sensorchar"  # which simulates, set by who runs the matrix
SD = N * math.sqrt(RATE)


@dataclasses.dataclass(frozen=True)
class Input:
    """A record of one finding. `make(folder)` writes it and gives its path, or, for a `command`, the words of the
    command lines that raise it."""
    make: Callable
    options: tuple = ()  # of every verb that reads the log
    made_by: str = "reading"  # reading, samples, fit, characterize, command
    truth: float | None = None  # N of the first channel, after the remedy
    analysis: tuple = ()  # of the verbs that analyse
    not_in: dict = dataclasses.field(default_factory=dict)  # verb: why it does not matter to it
    never: tuple = ()  # codes that contradict it
    env: dict | None = None
    optional: str = ""  # why the command may fail on another machine
    sentence: str = ""  # what is said, of a verb without JSON


def asked(make, **more):
    """An input that is a command: `make(folder)` gives its command lines, the last of which raises the finding."""
    return Input(make, made_by="command", **more)


def noise(n, sd=SD, seed=1):
    draw = random.Random(seed)
    return [draw.gauss(0, sd) for _ in range(n)]


def csv_text(columns, head="t[s]", rate=RATE, digits=5):
    """`columns`: name with unit → values; stamps in front."""
    lines = [",".join([head, *columns])]
    for i, row in enumerate(zip(*columns.values())):
        lines.append(",".join([f"{i / rate:.4f}", *("" if v is None else f"{v:.{digits}f}" for v in row)]))
    return "\n".join(lines) + "\n"


def text(name, content):
    """A maker of a file with this text, or these bytes."""
    def make(folder):
        path = folder / name
        path.write_bytes(content() if isinstance(content(), bytes) else content().encode())
        return path
    return make


def gyro_lines(n=2000, seed=1):
    """Of a small table: the header, then the rows; for changes of a line here and there."""
    return csv_text({"w[deg/s]": noise(n, seed=seed)}).splitlines()


def raw(name, channels, rate=RATE, kind="d"):
    """A raw log of doubles (or floats) and its sidecar; `channels()`: name → (unit, values)."""
    def make(folder):
        made = channels()
        path = folder / f"{name}.f64"
        columns = [values for _, values in made.values()]
        path.write_bytes(b"".join(struct.pack(f"<{len(columns)}{kind}", *row) for row in zip(*columns)))
        sidecar = {"dtype": {"d": "f64", "f": "f32"}[kind], "endian": "little",
                   "channels": [{"name": one, "unit": unit} for one, (unit, _) in made.items()]}
        (folder / f"{name}.f64.json").write_text(json.dumps(sidecar | ({"rate_hz": rate} if rate else {})))
        return path
    return make


def gyro(name, values, rate=RATE):
    """A raw log of one gyroscope."""
    return raw(name, lambda: {"gyro": ("deg/s", values())}, rate)


def npy(name, shape, values, descr="<f8", behind=b""):
    def make(folder):
        head = f"{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}"
        head += " " * (117 - len(head)) + "\n"
        code = {"f8": "d", "f4": "f", "i8": "q", "u8": "Q"}[descr[1:]]
        path = folder / f"{name}.npy"
        path.write_bytes(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode() +
                         struct.pack(f"<{len(values())}{code}", *values()) + behind)
        return path
    return make
