"""What the functions return. Every result has `to_dict()`: the keys of the program's JSON documents
(docs/json.md), arrays as lists."""
from __future__ import annotations

import dataclasses
import functools
from typing import Any, Iterator, Optional

import numpy as np
import numpy.typing as npt

from . import _libchar

Array = npt.NDArray[np.float64]


def plain(value: Any) -> Any:
    """Lists, dictionaries, numbers, strings and None, for json.dumps: what is not finite is None."""
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, float):
        return value if np.isfinite(value) else None
    if hasattr(value, "to_dict"):
        return value.to_dict()
    return value


class _Result:
    def to_dict(self) -> dict[str, Any]:
        """The result in plain Python types."""
        return {name: plain(value) for name, value in vars(self).items() if not name.startswith("_")}


def _plain_document(document: dict[str, Any]) -> dict[str, Any]:
    return {key: plain(value) for key, value in document.items()}


@dataclasses.dataclass(frozen=True)
class Recording(_Result):
    """Named channels on one time base: sample k is k / rate_hz seconds after the first."""

    names: list[str]
    units: list[str]  #: as written in the log, "" where it says nothing
    samples: list[Array]  #: one array per channel, all of one length; NaN is a missing sample
    rate_hz: float  #: 0 where it is not known
    file: str = ""
    start_ns: Optional[int] = None  #: stamp of the first sample in ns, where the log has stamps
    warnings: list[str] = dataclasses.field(default_factory=list)  #: what was repaired, a sentence a kind
    info: dict[str, Any] = dataclasses.field(default_factory=dict)  #: what `inspect --json` says of the log

    def __getitem__(self, name: str) -> Array:
        """The samples of a channel."""
        if name not in self.names:
            raise KeyError(f"no channel {name!r}; there are {', '.join(self.names)}")
        return self.samples[self.names.index(name)]

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        """Samples of a channel."""
        return len(self.samples[0]) if self.samples else 0

    @property
    def time_s(self) -> Array:
        """Seconds after the first sample."""
        return np.arange(len(self)) / self.rate_hz

    def to_array(self) -> Array:
        """All channels as one array, one row per sample (a copy)."""
        return np.column_stack(self.samples)


@dataclasses.dataclass(frozen=True)
class AllanCurve(_Result):
    """A deviation of the Allan family."""

    name: str
    unit: str
    type: str  #: oadev, mdev, …
    tau_s: Array  #: averaging times, s
    deviation: Array  #: in the channel's unit (tdev: times s)
    ci95: Array  #: (n, 2): chi-square interval, 95 %
    edf: Array  #: equivalent degrees of freedom
    terms: npt.NDArray[np.int64]  #: differences that were averaged
    document: dict[str, Any] = dataclasses.field(default_factory=dict, repr=False)

    def to_dict(self) -> dict[str, Any]:
        return _plain_document(self.document)


@dataclasses.dataclass(frozen=True)
class Spectrum(_Result):
    """A power spectrum by Welch's method."""

    name: str
    unit: str  #: of the samples
    sides: str  #: one, two
    scaling: str  #: psd U²/Hz, ps U², lsd U/√Hz, ls U
    window: str
    segment: int  #: samples of a segment
    segments: int  #: that were averaged
    enbw_hz: float  #: equivalent noise bandwidth
    frequency_hz: Array
    value: Array
    dof: Array  #: degrees of freedom of each bin
    ci95: Array  #: rows low, high; NaN where they are not known
    notes: list[str] = dataclasses.field(default_factory=list)


@dataclasses.dataclass(frozen=True)
class NoiseTerm(_Result):
    """One noise coefficient, root of a two-sided density."""

    value: Optional[float]  #: None where it was not detected
    ci95: Optional[tuple[float, float]]
    status: str  #: detected, not_detected, undetermined, misfit, not_fitted
    upper95: Optional[float]  #: upper 95 % limit where there is no value
    unit: str  #: deg/s·√s, deg/s, deg/s/√s, …
    document: dict[str, Any] = dataclasses.field(default_factory=dict, repr=False)

    def to_dict(self) -> dict[str, Any]:
        return _plain_document(self.document)


@dataclasses.dataclass(frozen=True)
class NoiseFit(_Result):
    """Noise coefficients of a channel (docs/theory/fit.md)."""

    name: str
    unit: str
    white_noise: NoiseTerm  #: N, angle random walk
    bias_instability: NoiseTerm  #: B; the flat part of the Allan curve lies at 0.664·B
    random_walk: NoiseTerm  #: K, rate random walk
    quantization: NoiseTerm
    rate_ramp: NoiseTerm
    document: dict[str, Any] = dataclasses.field(default_factory=dict, repr=False)

    @property
    def goodness(self) -> Optional[dict[str, float]]:
        """chi2, dof, and the probability p of more."""
        return self.document.get("goodness")

    @property
    def second_opinion(self) -> Optional[dict[str, Any]]:
        """The covariance-weighted fit of the Allan curve, and whether it agrees."""
        return self.document.get("second_opinion")

    @property
    def findings(self) -> list[dict[str, Any]]:
        """What else is to be known of the fit: code, severity, sentence…"""
        return list(self.document.get("findings") or [])

    def to_dict(self) -> dict[str, Any]:
        return _plain_document(self.document)


@dataclasses.dataclass(frozen=True)
class ChannelReport(_Result):
    """A channel of a characterization; what is None could not be had, and `findings` says why."""

    name: str
    unit: str
    fit: Optional[NoiseFit]
    allan: Optional[AllanCurve]
    findings: list[dict[str, Any]]


@dataclasses.dataclass(frozen=True)
class Characterization(_Result):
    """Everything about a recording: what `sensorchar characterize` writes."""

    verdict: str
    channels: list[ChannelReport]
    document: dict[str, Any] = dataclasses.field(repr=False)  #: report.json
    seconds: float  #: that the computation took
    _kept: _libchar.Characterized = dataclasses.field(repr=False, compare=False)

    def __getitem__(self, name: str) -> ChannelReport:
        """A channel by its name."""
        for channel in self.channels:
            if channel.name == name:
                return channel
        raise KeyError(f"no channel {name!r}; there are {', '.join(c.name for c in self.channels)}")

    def models(self) -> list[str]:
        """A sensor model, as YAML, of each channel that was fitted: for `simulate`, or a file CHANNEL.sensor.yaml."""
        return self._kept.models()

    def html(self) -> str:
        """The report as one self-contained page."""
        return self._kept.html()

    def write(self, folder: str, overwrite: bool = False) -> list[str]:
        """report.html, report.json, curves.csv and the models into a folder, all or none; their paths."""
        return self._kept.write(str(folder), overwrite)

    def to_dict(self) -> dict[str, Any]:
        return _plain_document(self.document)


@dataclasses.dataclass(frozen=True)
class Algorithm(_Result):
    """A fusion algorithm in a replay."""

    name: str
    status: str  #: ran, skipped
    why: Optional[str]  #: it was skipped
    rmse: Optional[float]  #: error of the fused quantity, in its unit; None without a reference
    regret: Optional[float]  #: rmse above the best weights that knew the truth, as a fraction
    ns_per_sample: Optional[float]  #: run time, ns a sample instant
    document: dict[str, Any] = dataclasses.field(default_factory=dict, repr=False)

    def to_dict(self) -> dict[str, Any]:
        return _plain_document(self.document)


@dataclasses.dataclass(frozen=True)
class ReplayResult(_Result):
    """Every fusion algorithm that had what it needs, on one recording."""

    verdict: str
    algorithms: list[Algorithm]
    document: dict[str, Any] = dataclasses.field(repr=False)  #: report.json
    _kept: _libchar.Replayed = dataclasses.field(repr=False, compare=False)

    @functools.cached_property
    def html(self) -> str:
        """The report as one self-contained page."""
        return self._kept.html()

    @functools.cached_property
    def markdown(self) -> str:
        """The report in Markdown."""
        return self._kept.markdown()

    def __getitem__(self, name: str) -> Algorithm:
        """An algorithm by its name."""
        for algorithm in self.algorithms:
            if algorithm.name == name:
                return algorithm
        raise KeyError(f"no algorithm {name!r}; there are {', '.join(a.name for a in self.algorithms)}")

    def to_dict(self) -> dict[str, Any]:
        return _plain_document(self.document)
