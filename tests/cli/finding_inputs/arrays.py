"""Arrays of sensors: the commands of replay and fuse that raise the findings of plans, sensors and algorithms."""
import math

from .parts import N, RATE, SD, asked, csv_text, noise

N_ROWS = 6000


def truth(n=N_ROWS):
    return [math.sin(i / 50) + 0.3 * math.sin(i / 17) for i in range(n)]


def columns(n=N_ROWS, sensors=6, levels=(1, 1.5, 2, 1, 1, 1)):
    """a, b, c… read the truth with their noise; ref is the truth."""
    x = truth(n)
    out = {}
    for i, name in enumerate("abcdef"[:sensors]):
        out[name] = [v + levels[i] * w for v, w in zip(x, noise(n, seed=10 + i))]
    return out | {"ref": x}


def table(folder, made, name="array"):
    path = folder / f"{name}.csv"
    path.write_text(csv_text(made))
    return path


def replay(change=lambda made: made, options=(), sensors="a,b,c", algorithms="mean,median", reference="ref", **how):
    """A replay of the array after `change`."""
    def make(folder):
        made = columns(**how)
        made = change(made) or made
        words = ["replay", table(folder, made), "--sensors", sensors,
                 *(["--algorithms", algorithms] if algorithms else []),
                 *(["--reference", reference] if reference else []), "-o", folder / "replay", "--force", "--no-allan",
                 *options]
        return [words]
    return make


def scene(body, algorithms="mean,median", options=(), change=lambda made: made, **how):
    """A replay of a scene whose text ends in `body`; the recording is the array."""
    def make(folder):
        made = columns(**how)
        table(folder, change(made) or made)
        path = folder / "scene.yaml"
        path.write_text("format: scene\nversion: 1\nrecording: array.csv\n" + body)
        return [["replay", path, *(["--algorithms", algorithms] if algorithms else []), "-o", folder / "replay",
                 "--force", "--no-allan",
                 *options]]
    return make


SIMULATE = """format: scene
version: 1
simulate:
  rate_hz: 100
  samples: 3000
  truth: {name: rate, kind: sine, amplitude: 2, frequency_hz: 1}
sensors:
  - {name: one, model: {unit: rad/s, white_noise: {value: 3.0e-3, unit: rad/s*sqrt(s)}}}
  - {name: two, model: {unit: rad/s, white_noise: {value: 4.0e-3, unit: rad/s*sqrt(s)}}}
"""


def fuse(change=lambda made: made, algorithm="mean", options=(), taught="mean,median", first=lambda made: made,
         again=None):
    """A replay of the array, then what it learnt on a log that `change` made of it."""
    def make(folder):
        prepare = replay(first, ("--learning", "0..30"), algorithms=taught)(folder)
        made = columns()
        path = table(folder, change(made) or made, "log")
        if again:
            path.write_text(again(made))
        return [*prepare, ["fuse", path, "--with", folder / "replay", "--algorithm", algorithm, "-o",
                           folder / "fused.csv", "--force", *options]]
    return make


def held(name, start, end):
    def change(made):
        made[name][start:end] = [made[name][start]] * (end - start)
    return change


def set_to(name, values):
    def change(made):
        made[name] = values(made)
    return change


def three_against_three(made):
    for name in "abc":
        made[name][14000:] = [0.2 * v for v in made[name][14000:]]


def periodic(made):
    x = [math.sin(0.15 * i) for i in range(N_ROWS)]
    return {"ref": x} | {name: [v + w for v, w in zip(x, noise(N_ROWS, seed=i))] for i, name in enumerate("abc")}


def without_past(made):
    """A white input, whose past tells nothing."""
    x = noise(N_ROWS, 3, seed=70)
    return {"ref": x} | {name: [v + w for v, w in zip(x, noise(N_ROWS, seed=i))] for i, name in enumerate("abc")}


def combined(made):
    """c is the sum of a and b as they are written."""
    for name in "ab":
        made[name] = [round(v, 4) for v in made[name]]
    made["c"] = [a + b for a, b in zip(made["a"], made["b"])]


def coloured(made):
    """From 20 s on every sensor sees a motion of its own, ten times its noise."""
    for i, name in enumerate("abcdef"):
        own, draw = 0.0, noise(len(made[name]), SD, seed=90 + i)
        for k in range(2000, len(made[name])):
            own = 0.98 * own + 1.1 * draw[k]
            made[name][k] += own


def at_half_rate(made):
    return csv_text({name: values[::2] for name, values in made.items()}, rate=RATE / 2)


def short_lived(made):
    made["c"][100:] = [None] * (N_ROWS - 100)


def louder(names, times):
    def change(made):
        x = made["ref"]
        for name in names:
            made[name] = [v + times * (m - v) for v, m in zip(x, made[name])]
    return change


def sensors_of(names, more=""):
    return "sensors: [" + ", ".join(names) + "]\nreference: ref\n" + more


def modelled(terms):
    """Sensors of a model with these terms."""
    return "".join(["sensors:\n",
                    *(f"  - {{name: {name}, model: {{white_noise: {{value: {N}}}{terms}, density: two-sided}}}}\n"
                                    for name in "abc"), "reference: ref\n"])


RESTLESS = {"fault_detection": 2, "fault_gamma": 0.5, "fault_threshold": 1.5, "recovery_samples": 1, "gamma": 0.95}


def restless(folder):
    """A rule that takes sensors out and in again at nearly every instant."""
    made = columns(40000)
    path = table(folder, made)
    options = [word for name, value in RESTLESS.items() for word in ("--set", f"minque.{name}={value}")]
    return [["replay", path, "--sensors", "a,b,c,d,e,f", "--algorithms", "minque,mean", "-o", folder / "replay",
             "--force", "--no-allan",
             *options],
            ["fuse", path, "--with", folder / "replay", "--algorithm", "minque", "-o", folder / "fused.csv", "--force"]]


def resampled(folder):
    """A recording that a scene reads at another rate, in which a stamp stands twice."""
    lines = csv_text(columns()).splitlines()
    lines[3000] = lines[2999].split(",")[0] + "," + lines[3000].split(",", 1)[1]
    (folder / "array.csv").write_text("\n".join(lines) + "\n")
    path = folder / "scene.yaml"
    path.write_text("format: scene\nversion: 1\nrecording: {file: array.csv, resample_hz: 50}\n" + sensors_of("abc"))
    return [["replay", path, "--algorithms", "mean,median", "-o", folder / "replay", "--force", "--no-allan"]]


def named(*names):
    """A scene whose second and third sensors have these names."""
    return scene("sensors:\n  - a\n" + "".join(f'  - {{name: "{name}", channel: {c}}}\n' for name, c in zip(names,
            "bc")) + "reference: ref\n")


def tilt(folder, sign=1):
    angle = [1.2 * math.sin(i / 100) for i in range(N_ROWS)]
    rate = [1.2 * math.cos(i / 100) for i in range(N_ROWS)]
    made = {"g[rad/s]": [sign * v + 0.02 + w for v, w in zip(rate, noise(N_ROWS, 0.02, 1))],
            "x[m/s^2]": [9.80665 * math.sin(v) + w for v, w in zip(angle, noise(N_ROWS, 0.1, 2))],
            "z[m/s^2]": [9.80665 * math.cos(v) + w for v, w in zip(angle, noise(N_ROWS, 0.1, 3))], "angle[rad]": angle}
    table(folder, made)
    path = folder / "tilt.yaml"
    path.write_text("format: scene\nversion: 1\nrecording: array.csv\nsensors: [g, x, z]\n"
                    "tilt: {gyroscope: g, accelerometer_x: x, accelerometer_z: z}\n"
                    "reference: angle\nlearning: [0, 20]\n")
    return [["replay", path, "--algorithms", "tilt-complementary-tuned", "-o", folder / "replay", "--force",
             "--no-allan"]]


SMOOTHED = ("--set", "virtual-sensor.smoothed=1")
INPUTS = {
    "frozen_sensor": asked(replay(held("c", 3000, N_ROWS))),
    "constant_error": asked(replay(lambda made: made | {"ref": [v + 3 for v in made["ref"]]}, ("--learning", "0..5"),
                                   algorithms="mean,median")),
    "constant_sensor": asked(replay(set_to("b", lambda made: [0.5] * N_ROWS), sensors="a,b")),
    "copied_sensor": asked(replay(set_to("c", lambda made: list(made["a"])))),
    "sensor_without_samples": asked(replay(short_lived, ("--learning", "0..30"))),
    "reference_is_a_sensor": asked(scene("sensors: [a, b, c]\nreference: {channels: [a, ref], mean: true}\n")),
    "window_beyond_end": asked(replay(options=("--learning", "0..30", "--evaluation", "30..90"))),
    "learning_in_evaluation": asked(replay(options=("--learning", "0..30", "--evaluation", "20..60"))),
    "learning_before_settled": asked(scene(sensors_of("abc", "band_hz: [0.2, 5]\nlearning: [0, 5]\n"))),
    "alignment_in_evaluation": asked(replay(options=("--align", "bias,gain@run"))),
    "leave_one_out_budget": asked(replay(options=("--budget", "0.001"), algorithms="", reference="",
                                         sensors="a,b,c,d,e,f")),
    "fault_after_end": asked(replay(options=("--fault", "a:bias=1@100..110",))),
    "sensor_changed": asked(fuse(set_to("b", lambda made: [v + 5 for v in made["b"]]))),
    "sensor_failing": asked(replay(set_to("b", lambda made: made["b"][:4000] + [v + 5 for v in made["b"][4000:]]))),
    "sensor_apart": asked(replay(set_to("b", lambda made: [-v for v in made["b"]]), reference="")),
    "sensor_unlike": asked(replay(set_to("b", lambda made: [v + 8 * w for v, w in zip(truth(), noise(N_ROWS, seed=5))]),
                                  reference="")),
    "sensors_out_of_time": asked(replay(lambda made: {k: v[5:] + v[:5] if k == "b" else v for k, v in made.items()},
                                        reference="", levels=(0.05,) * 6)),
    "noise_changed": asked(fuse(louder("b", 3))),
    "noise_changed_of_all": asked(fuse(louder("abc", 3))),
    "another_rate": asked(fuse(again=at_half_rate)),
    "sensor_not_in_log": asked(fuse(lambda made: {k: v for k, v in made.items() if k != "c"})),
    "channel_without_signal": asked(replay(set_to("c", lambda made: noise(N_ROWS, 1, 77)), ("--learning", "0..30"),
                                           algorithms="least-squares")),
    "duplicate_channels": asked(replay(set_to("c", lambda made: made["a"][:3000] + made["c"][3000:]),
                                       ("--learning", "0..30"), algorithms="least-squares")),
    "dependent_channels": asked(replay(combined, ("--learning", "0..30"),
                                       algorithms="least-squares")),
    "perceptron_fewer_neurons": asked(replay(options=("--learning", "0..30", "--set", "perceptron.most_weights=20"),
                                             algorithms="perceptron")),
    "network_led": asked(replay(options=("--learning", "0..30"), algorithms="neural-simplex")),
    "network_not_better": asked(replay(without_past, ("--learning", "0..30"), algorithms="neural-simplex")),
    "not_calibrated": asked(replay(lambda made: {k: noise(N_ROWS, seed=i) for i, k in enumerate(made)},
                                   algorithms="blind-gls")),
    "noise_bias": asked(replay(sensors="a,b", algorithms="blind-calibration", reference="")),
    "faults_not_watched": asked(replay(algorithms="minque-published")),
    "negative_variance": asked(replay(algorithms="minque-published", options=("--set", "minque-published.gamma=0.9"))),
    "variances_not_identifiable": asked(replay(algorithms="minque", levels=(1, 1, 400, 1, 1, 1))),
    "faults_ambiguous": asked(replay(three_against_three, algorithms="minque", sensors="a,b,c,d,e,f", reference="",
                                     n=20000)),
    "fault_watch_stood_down": asked(scene(sensors_of("abcdef", "fault_free_s: 20\n"), "minque", change=coloured,
                                          n=20000)),
    "faults_not_kept": asked(restless),
    "input_repeats": asked(scene(modelled(""), "kalman-takens", change=periodic)),
    "tilt_contradicts": asked(lambda folder: tilt(folder, sign=-1)),
    "tilt_tuned": asked(tilt),
    "looks_ahead": asked(scene(modelled(f", random_walk: {{value: {N}}}"), "virtual-sensor", SMOOTHED)),
    "no_drift": asked(scene(modelled(""), "virtual-sensor")),
    "stamp_not_rising": asked(resampled),
    "case_clash": asked(named("A", "c")),
    "control_characters": asked(named("b\u202e", "c")),
}
