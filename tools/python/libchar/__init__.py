"""Noise, models and fusion of sensors from recordings: the library of sensorchar for NumPy.

    import libchar
    log = libchar.read("imu.csv")                     # named channels, NaN where a sample is missing
    gyro = libchar.fit(log, channels=["gyro_z"])[0]   # N, B, K with 95 % intervals
    print(gyro.white_noise.value, gyro.white_noise.ci95, gyro.unit)

Times are in seconds, frequencies in hertz, samples in the unit of their channel. Noise coefficients are roots
of two-sided densities: N (white_noise) in U·√s, B (bias_instability) in U, K (random_walk) in U/√s; a data
sheet's one-sided density is √2·N. Contiguous arrays of float64 are used as they are; any other array is
copied once, with a CopyWarning. Work runs without the interpreter's lock, on all cores unless `threads` says
otherwise.
"""
from . import program
from ._libchar import build, version as _version
from .errors import CopyWarning, Error, InputError, NumericError, UsageError
from .functions import (allan, bench, characterize, compare, cornered_hat, cross_spectrum, fit, fuse, inspect, lot,
                        plot, psd, read, replay, simulate, write)
from .results import (AllanCurve, Algorithm, Characterization, ChannelReport, Document, Figure, Model, NoiseFit,
                      NoiseTerm, Recording, ReplayResult, Spectrum, export)

__version__ = _version()
__all__ = ["read", "write", "inspect", "allan", "psd", "fit", "characterize", "compare", "lot", "cross_spectrum",
           "cornered_hat", "simulate", "replay", "fuse", "bench", "export", "plot", "Recording", "AllanCurve",
           "Spectrum", "NoiseTerm", "NoiseFit", "Model", "ChannelReport", "Characterization", "Algorithm",
           "ReplayResult", "Document", "Figure", "Error", "UsageError", "InputError", "NumericError", "CopyWarning",
           "build", "program"]
