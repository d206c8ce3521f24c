"""Records whose samples raise the findings of their quality."""
import math
import random

from .parts import Input, N, RATE, SD, csv_text, gyro, noise, raw, text


def marks():
    x = [round(v, 4) + 3 for v in noise(30000)]
    x[500::400] = [-999.0] * len(x[500::400])
    return x


def wraps():
    phase, turn = [], 0.0
    for v in noise(30000):
        turn += 0.1 + v / RATE
        phase.append(turn % 50.0)
    return {"angle": ("deg", phase)}


def gravity():
    axes = {name: ("m/s^2", noise(30000, SD / 9.80665, seed)) for seed, name in enumerate(("acc_x", "acc_y", "acc_z"))}
    axes["acc_z"] = ("m/s^2", [v + 1 for v in axes["acc_z"][1]])
    return axes


def field():
    axes = {name: ("T", noise(30000, SD, seed)) for seed, name in enumerate(("mag_x", "mag_y", "mag_z"))}
    axes["mag_z"] = ("T", [v + 48 for v in axes["mag_z"][1]])
    return axes


def copied():
    axes = {name: ("deg/s", noise(30000, SD, seed)) for seed, name in enumerate(("gyro_x", "gyro_y", "gyro_z"))}
    axes["gyro_z"] = ("deg/s", [-v for v in axes["gyro_x"][1]])
    return axes


def frozen():
    x = noise(30000)
    for start in range(1000, 30000, 5000):
        x[start:start + 250] = [x[start]] * 250
    return x


def repeated():
    x = noise(60000)
    draw = random.Random(9)
    for i in range(1, 60000):  # evenly, they would be a slower sensor's
        if draw.random() < 0.04:
            x[i] = x[i - 1]
    return x


def interpolated():
    x = noise(30000)
    for start in range(1000, 30000, 1500):
        a, b = x[start], x[start + 120]
        x[start:start + 121] = [a + (b - a) * i / 120 for i in range(121)]
    return x


def resampled():
    """A sensor of 31.25 Hz, interpolated to 100 Hz."""
    x = noise(10000)
    return [x[int(t)] + (x[int(t) + 1] - x[int(t)]) * (t - int(t)) for t in (i / 3.2 for i in range(30000))]


def spiky():
    """A pulse of ten samples every 50: no spikes of a sample, and no noise."""
    return [v + (40 * SD if i % 50 < 10 else 0) for i, v in enumerate(noise(30000))]


def clipped(times, n=30000):
    return [max(-times * SD, min(v, times * SD)) for v in noise(n)]


def bumped():
    """At the end of its range for a second, twice."""
    x = noise(30000)
    for start, end in ((1000, 1.6), (7000, -1.6)):
        x[start:start + 60] = [end] * 60
    return x


def with_holes():
    return [math.nan if i % 200 < 30 else v for i, v in enumerate(noise(6000))]


INPUTS = {
    "counter": Input(text("counter.csv",
                          lambda: csv_text({"w[deg/s]": noise(3000), "count": [float(i) for i in range(3000)]})),
                          made_by="samples"),
    "phase_wraps": Input(raw("wraps", wraps), made_by="samples", analysis=("--data", "phase"), truth=N),
    "constant": Input(gyro("constant", lambda: [0.25] * 3000), made_by="samples"),
    "quantization_limited": Input(gyro("few", lambda: [float(round(v)) for v in noise(30000, 0.35)]),
                                  made_by="samples"),
    "coarse_resolution": Input(gyro("coarse", lambda: [float(round(v)) for v in noise(30000, 0.42)] + [2.0, -2.0]),
                               made_by="samples"),
    "float_step": Input(raw("floats", lambda: {"gyro": ("deg/s", [1e7 + v for v in noise(60000, 1.9)])}, kind="f"),
                        made_by="samples"),
    "missing_mark": Input(gyro("marks", marks), made_by="samples", truth=N),
    "saturated": Input(gyro("saturated", bumped), made_by="samples"),
    "much_saturated": Input(gyro("cut", lambda: clipped(1.5)), made_by="samples"),
    "dead_band": Input(gyro("dead", lambda: [0.0 if abs(v) < 1.5 * SD else v for v in noise(30000)]),
                       made_by="samples"),
    "held_values": Input(gyro("held", lambda: [v for v in noise(15000) for _ in range(4)]), made_by="samples"),
    "interpolated": Input(gyro("interpolated", interpolated), made_by="samples", truth=N),
    "resampled": Input(gyro("resampled", resampled), made_by="samples"),
    "repeated_samples": Input(gyro("repeated", repeated), made_by="samples", truth=N),
    "stuck": Input(gyro("frozen", frozen), made_by="samples", truth=N),
    "beyond_range": Input(gyro("beyond", lambda: [1e200 if i == 500 else v for i, v in enumerate(noise(30000))]),
                          made_by="samples"),
    "no_value": Input(raw("none", lambda: {"gyro": ("deg/s", noise(3000)), "off": ("deg/s", [math.nan] * 3000)}),
                      made_by="samples",
                      not_in={"psd": "it says no_finite_value, which the reader found"}),
    "spiky": Input(raw("spiky", lambda: {"level": ("V", spiky())}), made_by="samples", analysis=("--no-remedies",),
                   not_in={"allan": "it takes the remedies, and says what was done"}),
    "not_gravity": Input(raw("gravity", gravity), made_by="samples", truth=N),
    "not_earth_field": Input(raw("field", field), made_by="samples"),
    "copied_channel": Input(raw("copied", copied), made_by="samples"),
    "missing_samples": Input(gyro("missing", with_holes), made_by="characterize",
                             not_in=dict.fromkeys(("allan", "psd"), "terms that touch a missing sample are left out")),
}
