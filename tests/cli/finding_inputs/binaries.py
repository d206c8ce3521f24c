"""Arrays and raw logs that raise the findings of their reading."""
import json
import struct

from .parts import Input, noise, npy


def swapped(folder):
    """Doubles in the order of bytes that the sidecar does not name."""
    path = folder / "swapped.f64"
    path.write_bytes(struct.pack(">3000d", *noise(3000)))
    path.with_suffix(".f64.json").write_text(json.dumps(
        {"dtype": "f64", "endian": "little", "rate_hz": 100, "channels": [{"name": "gyro", "unit": "deg/s"}]}))
    return path


INPUTS = {
    "looks_transposed": Input(npy("transposed", (64, 65), lambda: noise(64 * 65)), ("--rate", "100")),
    "trailing_bytes": Input(npy("trailing", (3000,), lambda: noise(3000), behind=b"\0" * 12), ("--rate", "100")),
    "rounded_integer": Input(npy("rounded", (3000,), lambda: [2**60 + int(1000 * v) for v in noise(3000)], "<i8"),
                             ("--rate", "100")),
    "implausible_magnitude": Input(swapped),
}
