"""Curves, scenes of a simulation, figures: the commands that raise their findings."""
import math
import random

from .arrays import SIMULATE
from .parts import asked, csv_text, noise


def curve(scatter, stated=False):
    """The fit of an Allan curve of white noise, whose points scatter so much."""
    def make(folder):
        draw = random.Random(2)
        path = folder / "curve.csv"
        rows = [(2.0**(k / 2), 0.02 / math.sqrt(2.0**(k / 2)) * (1 + scatter * draw.gauss(0, 1))) for k in range(24)]
        lines = ["tau[s],adev[deg/s]" + (",error" if stated else "")]
        lines += [f"{t:.6g},{d:.6g}" + (f",{0.01 * d:.6g}" if stated else "") for t, d in rows]
        path.write_text("\n".join(lines) + "\n")
        return [["fit", path, "--curve", "allan"]]
    return make


def spectrum(folder):
    """The program's own table of a spectrum, which begins at 0 Hz."""
    (folder / "log.csv").write_text(csv_text({"w[deg/s]": noise(2000)}))
    return [["psd", folder / "log.csv", "-o", folder / "psd.csv", "--force"],
            ["fit", folder / "psd.csv", "--curve", "psd"]]


def recorded(folder):
    """A simulation whose truth is a recording of half its length."""
    (folder / "motion.csv").write_text(csv_text({"rate[rad/s]": noise(1500)}))
    path = folder / "simulation.yaml"
    path.write_text(SIMULATE.replace("kind: sine, amplitude: 2, frequency_hz: 1", "kind: recording, file: motion.csv"))
    return [["simulate", path, "-o", folder / "simulated.csv", "--force"]]


def pooled(change):
    """Runs of one gyroscope, of which the last is changed."""
    def make(folder):
        paths = []
        for run in range(4):
            values = noise(8000, seed=run + 1)
            paths.append(folder / f"run{run}.csv")
            paths[-1].write_text(csv_text({"w[deg/s]": change(values) if run == 3 else values}))
        return [["characterize", *paths, "--pool", "-o", folder / "pool", "--force"]]
    return make


def moved(values):
    return [v + (60 * math.sin(i / 9) * math.sin(i / 700) if 2000 < i < 6000 else 0) for i, v in enumerate(values)]


# Fonts without the one that figures are laid out for.
FONTS = """<?xml version="1.0"?><!DOCTYPE fontconfig SYSTEM "fonts.dtd"><fontconfig>
<include>/etc/fonts/fonts.conf</include><selectfont>
<rejectfont><pattern><patelt name="family"><string>Liberation Sans</string></patelt></pattern></rejectfont>
</selectfont></fontconfig>"""


def figure(folder):
    (folder / "fonts.conf").write_text(FONTS)
    log = folder / "log.csv"
    log.write_text(csv_text({"w[deg/s]": noise(500)}))
    return [["allan", log, "-o", folder / "allan.csv", "--force"],
            ["plot", folder / "allan.csv", "-o", folder / "figure.pdf", "--force"]]


INPUTS = {
    "figure_font": asked(figure, env={"FONTCONFIG_FILE": "{folder}/fonts.conf"},
                         optional="this program draws no PDF without that font",
                         sentence="the font Liberation Sans is not installed"),
    "recorded_signal_short": asked(recorded),
    "zero_frequency": asked(spectrum),
    "run_left_out": asked(pooled(moved)),
    "runs_unlike": asked(pooled(lambda values: [1.5 * v for v in values])),
    "curve_uncertainty": asked(curve(0.02)),
    "curve_scatter": asked(curve(0.022, stated=True)),
}
