"""Records that raise the findings of the fit, of motion and of the analysis as a whole."""
import math
import random
import subprocess

from . import parts
from .parts import Input, N, RATE, SD, gyro, noise, raw


def simulated(name, rate=RATE, samples=60000, seed=1, more="", options=(), **terms):
    """A record of a sensor with these terms (white, flicker, walk, resolution), by `simulate`."""
    def make(folder):
        model = folder / f"{name}.yaml"
        model.write_text(f"format: sensor-model\nversion: 1\nchannel: gyro\nunit: deg/s\nrate_hz: {rate}\n"
                         "density: two-sided\n"
                         f"white_noise: {terms.get('white', 0)}\nbias_instability: {terms.get('flicker', 0)}\n"
                         f"random_walk: {terms.get('walk', 0)}\n{more}")
        log = folder / f"{name}.npy"
        subprocess.run([parts.PROGRAM, "simulate", model, "--samples", str(samples), "--seed", str(seed), "-o", log,
                        "--no-truth",
                        "--no-scene", "--force", "-q", *options], check=True)
        return log
    return make


def gauss_markov(n, sigma, tau, seed):
    draw, keep, last, out = random.Random(seed), math.exp(-1 / RATE / tau), 0.0, []
    drive = sigma * math.sqrt(1 - keep * keep)
    last = draw.gauss(0, sigma)
    for _ in range(n):
        out.append(last)
        last = keep * last + draw.gauss(0, drive)
    return out


def with_process(n, sigma, tau):
    return [a + b for a, b in zip(noise(n), gauss_markov(n, sigma, tau, 2))]


def power_law(n, size):
    """1/f^1.5 of processes whose times are spaced evenly in their logarithm."""
    out = noise(n)
    for k in range(11):
        tau = 0.05 * 3.0**k
        out = [a + b for a, b in zip(out, gauss_markov(n, size * tau**0.25, tau, k + 2))]
    return out


def high_passed(n=60000):
    keep, last, out = math.exp(-2 * math.pi * 0.3 / RATE), 0.0, []
    white = noise(n + 1001)
    for before, v in zip(white, white[1:]):
        last = keep * last + v - before
        out.append(last)
    return out[1000:]


def motion():
    x = noise(30000)
    for i in range(8000, 22000):
        x[i] += 60 * math.sin(i / 9) * math.sin(i / 700)
    return x


def outliers():
    draw = random.Random(3)
    return [v + (draw.choice((-6, 6)) * SD if draw.random() < 0.006 else 0) for v in noise(60000)]


def laplace():
    draw = random.Random(3)
    return [draw.expovariate(1 / SD) * draw.choice((-1, 1)) for _ in range(60000)]


def spikes(share, size):
    draw = random.Random(3)
    return [v + (size * SD * draw.choice((-1, 1)) if draw.random() < share else 0) for v in noise(30000)]


def bursts(size):
    """Noise that is louder in one part of seven."""
    return [v * (size if i // 500 % 7 == 0 else 1) for i, v in enumerate(noise(20000))]


def steps(n, every, size):
    draw = random.Random(5)
    levels = [draw.gauss(0, size * SD) for _ in range(n // every + 1)]
    return [v + levels[i // every] for i, v in enumerate(noise(n))]


def louder(n=60000, times=3.0):
    return [v * (times if i >= n // 2 else 1) for i, v in enumerate(noise(n))]


def swelling(n=60000):
    return [v * (1 + 0.25 * math.sin(2 * math.pi * 3 * i / n)) for i, v in enumerate(noise(n))]


def slow_bump(n=60000):
    return [v + 0.5 * math.exp(-((i / n - 0.4) / 0.12) ** 2) for i, v in enumerate(noise(n))]


def band_hump(n=60000):
    """A broad resonance near 3 Hz, of no more noise than gyroscopes have."""
    a, b, y1, y2, out = 2 * 0.995 * math.cos(2 * math.pi * 0.03), -0.995**2, 0.0, 0.0, []
    for drive, white in zip(noise(n, 0.1, seed=2), noise(n)):
        y1, y2 = a * y1 + b * y2 + drive, y1
        out.append(0.001 * (y1 + white))
    return out


def flown():
    """An accelerometer that looks like one at rest, beside a gyroscope that turns throughout."""
    swings = [0.0, 0.0]
    turned = []
    for drive, white in zip(noise(30000, 400, seed=2), noise(30000)):
        swings[0] += 0.05 * (drive - swings[0])
        swings[1] += 0.05 * (swings[0] - swings[1])
        turned.append(swings[1] + white)
    return {"acc": ("m/s^2", noise(30000, 0.03, seed=3)), "gyro": ("deg/s", turned)}


def weather():
    """A temperature outside, smooth over hours and in tenths."""
    wall, room, out = 0.0, 0.0, []
    for drive in noise(8000, 300, seed=5):
        wall += (drive - wall) / 300
        room += (wall - room) / 300
        out.append(round(20 + room, 1))
    return {"temp": ("degC", out)}


def heating(n, period, height, uneven=0.0):
    """A heating of two states behind a slow wall."""
    draw, wall, left, on, out = random.Random(346), 0.0, 0.0, False, []
    for v in noise(n):
        left -= 1 / RATE
        if left < 0:
            on, left = not on, period / 2 + uneven * draw.gauss(0, 1)
        wall += ((height if on else 0) - wall) / (RATE * period / 10)
        out.append(v + wall)
    return out


def with_temperature():
    warm = [20 + 5 * math.sin(i / 9000) for i in range(30000)]
    return {"gyro": ("deg/s", [v + 0.3 * t for v, t in zip(noise(30000), warm)]), "temp": ("degC", warm)}


def with_line(n=30000):
    return [v + 0.4 * math.sin(2 * math.pi * 13 * i / RATE) for i, v in enumerate(noise(n))]


def swinging(n=60000, hz=12, quality=8):
    angle = 2 * math.pi * hz / RATE
    radius = math.exp(-angle / 2 / quality)
    a1, a2 = 2 * radius * math.cos(angle), -radius * radius
    drive, out = noise(n, 0.15 * SD, 2), [0.0, 0.0]
    for t in range(2, n):
        out.append(a1 * out[-1] + a2 * out[-2] + drive[t] - drive[t - 2])
    return [v + swing for v, swing in zip(noise(n), out)]


def fitted(name, values, made_by="fit", **more):
    """A record of one gyroscope, of which the fit finds something."""
    return Input(gyro(name, values), made_by=made_by, **more)


def fitted_model(name, samples, **terms):
    """The same of a simulated sensor."""
    return Input(simulated(name, samples=samples, **terms), ("--rate", "100"), made_by="fit")


def hardly_there():
    """A channel with four samples, far apart."""
    few = {0: 0.3, 900: 0.1, 1700: 0.4, 2600: 0.2}
    return {"gyro": ("deg/s", noise(3000)), "off": ("deg/s", [few.get(i, math.nan) for i in range(3000)])}


def clock_of(unit, mean, sd):
    return lambda: {"clock": (unit, [mean + v for v in noise(20000, sd)])}


def integral():
    angle, out = 0.0, []
    for v in noise(30000):
        angle += v / RATE
        out.append(angle)
    return out


ONLY_VERIFY = dict.fromkeys(("allan", "psd", "fit"), "only --verify of characterize simulates")
INPUTS = {
    "event": fitted("event", lambda: [v + (0.6 if i > 12000 else 0) for i, v in enumerate(noise(30000))],
                    made_by="curve"),
    "events_left_in": fitted("steps", lambda: steps(60000, 3000, 4), made_by="curve"),
    "motion": fitted("motion", motion, made_by="characterize", truth=N),
    "moves_throughout": fitted("resonance", band_hump, made_by="characterize"),
    "moves_with_others": Input(raw("flown", flown), made_by="characterize",
                               not_in={"psd": "it is the fit that finds that the gyroscope moves"}),
    "nothing_detected": Input(raw("weather", weather, rate=1 / 60), made_by="fit"),
    "heavy_tails": fitted("laplace", laplace),
    "high_passed": fitted("coupled", high_passed),
    "outliers_in_n": fitted("outliers", outliers),
    "spikes_left_out": fitted("spikes", lambda: spikes(0.0005, 60)),
    "spikes_kept": fitted("kept", lambda: spikes(0.04, 40)),
    "rail": fitted("rail", lambda: [max(-2.6 * SD, v) for v in noise(30000)]),
    "rounding_in_n": fitted("coarse", lambda: [round(v / 0.15) * 0.15 for v in noise(30000)], truth=N),
    "staircase": fitted("staircase", lambda: [round(v / 0.35) * 0.35 for v in noise(30000)]),
    "digital_misfit": fitted("rounding", lambda: [float(round(v)) for v in noise(20000, 0.3)]),
    "lines_left_out": fitted("lines", with_line, made_by="curve"),
    "resonance": fitted("swinging", swinging, made_by="curve", truth=N),
    "strength_change": fitted("louder", louder),
    "not_stationary": fitted("swelling", swelling),
    "cycle": fitted("cycle", lambda: heating(100000, 97, 1.2), made_by="curve"),
    "hump": fitted("hump", lambda: heating(60000, 60, 0.5, uneven=4.0), made_by="curve"),
    "gauss_markov": fitted("process", lambda: with_process(60000, 0.3, 3.0)),
    "gauss_markov_or_terms": fitted("either", lambda: with_process(20000, 0.1, 10.0)),
    "power_law": fitted("law", lambda: power_law(60000, 0.02), never=("misfit",)),
    "drift": fitted("drift", lambda: [v + 0.001 * i for i, v in enumerate(noise(1000))]),
    "lowest_left_out": fitted("lowest", slow_bump),
    "misfit": fitted("misfit", band_hump, analysis=("--no-remedies",)),
    "contradicted": fitted("contradicted", band_hump, analysis=("--no-remedies",)),
    "allan_disagrees": fitted("disagrees", slow_bump),
    "flicker_or_walk": fitted_model("slow", 8000, white=0.02, flicker=0.02),
    "white_or_flicker": fitted_model("white_or", 64, flicker=0.02),
    "drift_or_walk": fitted_model("drifting", 4000, white=0.02, flicker=0.019, options=("--deterministic",),
                                  more="deterministic:\n  - {kind: ramp, size: 0.16, per_s: 0.004}\n"),
    "too_short": fitted_model("short", 4000, white=0.02, walk=0.01),
    "undetermined": fitted_model("between", 8000, white=0.02, flicker=0.02),
    "reaches_zero": fitted_model("zero", 12000, white=0.02, flicker=0.01),
    "temperature_left_in": Input(raw("warm", with_temperature), made_by="fit", truth=N),
    "temperature": Input(raw("temperature", with_temperature), made_by="fit", analysis=("--temperature", "temp")),
    "noise_types": Input(raw("clock", clock_of("s", 0, 1e-9), rate=1), made_by="characterize",
                         analysis=("--data", "phase"), not_in={"psd": "it names no slopes"}),
    "frequency_mean": Input(raw("frequency", clock_of("Hz", 10e6, 1e-3), rate=1), made_by="characterize",
                            analysis=("--data", "frequency")),
    "integral_unit": Input(raw("increments", lambda: {"gx": ("rad", noise(20000, SD / RATE))}), made_by="characterize",
                           truth=N),
    "looks_integrated": Input(gyro("angle", integral), made_by="characterize",
                              not_in={"psd": "it fits nothing"}),
    "no_fit": Input(raw("no_fit", hardly_there), made_by="characterize"),
    "not_computed": Input(raw("not_computed", hardly_there), made_by="characterize"),
    "simulation_disagrees": Input(gyro("again", lambda: bursts(4)), made_by="characterize",
                                  analysis=("--verify",), not_in=ONLY_VERIFY),
}
