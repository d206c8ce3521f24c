"""What the functions return. Every result has `to_dict()`: the keys of the program's JSON documents
(docs/json.md), arrays as lists."""
from __future__ import annotations

import dataclasses
import functools
import html
import json
import os
import pathlib
from typing import Any, Iterator, Mapping, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _libchar, program

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


def frame(columns: Mapping[str, Any], index: Any = None) -> Any:
    """A pandas.DataFrame."""
    import pandas  # type: ignore[import-not-found,import-untyped,unused-ignore]
    return pandas.DataFrame(columns, index=index)


def _cell(value: Any) -> str:
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)


class _Shown:
    """A result that is a table: a terminal prints it as text, a notebook as HTML."""

    def _table(self) -> tuple[str, list[dict[str, Any]]]:
        """A heading, and rows of equal keys."""
        raise NotImplementedError

    def __repr__(self) -> str:
        above, rows = self._table()
        cells = [list(rows[0])] + [[_cell(value) for value in row.values()] for row in rows] if rows else []
        widths = [max(map(len, column)) for column in zip(*cells)]
        lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in cells]
        return "\n".join([above] * bool(above) + lines)

    def _repr_html_(self) -> str:
        above, rows = self._table()
        head = "".join(f"<th>{html.escape(key)}</th>" for key in (rows[0] if rows else {}))
        body = "".join("<tr>" + "".join(f"<td>{html.escape(_cell(value))}</td>" for value in row.values()) + "</tr>"
                       for row in rows)
        return (f"<p>{html.escape(above)}</p>" if above else "") + f"<table><tr>{head}</tr>{body}</table>"


def _range(values: Array) -> str:
    return f"{len(values)} values from {values[0]:.4g} to {values[-1]:.4g}" if len(values) else "no values"


class Figure:
    """A figure as `sensorchar plot` draws it (docs/plots.md): a notebook shows it, `save` writes it."""

    def __init__(self, documents: Sequence[tuple[str, Optional[str]]], options: Mapping[str, Any]) -> None:
        self._documents = list(documents)  # name and text each, of what is drawn; of a file its path and no text
        self._options = dict(options)
        self.svg: str = self._drawn(["-o", "-"]).decode()

    def _drawn(self, words: Sequence[str]) -> bytes:
        with program.folder() as place:
            files = []
            for k, (name, text) in enumerate(self._documents):
                files.append(place / str(k) / name)  # an absolute path stays itself
                if text is not None:
                    files[-1].parent.mkdir()
                    files[-1].write_text(text)
            return program.run("plot", [*map(str, files), *program.words_of(self._options), *words])

    def _repr_svg_(self) -> str:
        return self.svg

    def save(self, path: Union[str, "os.PathLike[str]"], overwrite: bool = False) -> None:
        """Writes it; the suffix says the format: .svg, .pdf, .png."""
        self._drawn(["-o", os.fspath(path)] + ["--force"] * overwrite)


class _Result:
    def to_dict(self) -> dict[str, Any]:
        """The result in plain Python types."""
        return {name: plain(value) for name, value in vars(self).items() if not name.startswith("_")}


class _Drawn(_Result):
    """A result that can be drawn."""

    def _drawn(self) -> tuple[str, dict[str, Any]]:
        raise NotImplementedError

    def plot(self, **options: Any) -> Figure:
        """A figure; options are those of `sensorchar plot`: kind="psd", width="two-columns", channel="gyro_z"…"""
        return Figure([document_of(self)], options)


def document_of(result: _Drawn) -> tuple[str, str]:
    """Name and text of the document that the program draws."""
    format_, document = result._drawn()
    head = {"format": format_, "version": 1, "tool": {"name": "libchar", "version": _libchar.version()}}
    return f"{format_}.json", json.dumps({**head, **plain(document)})


class Model(str):
    """A sensor model: its YAML text (docs/models.md), for `simulate`, for a file NAME.sensor.yaml, for `export`."""

    @property
    def channel(self) -> str:
        """The channel that it models."""
        return str(self._document()["channel"])

    def _document(self) -> dict[str, Any]:
        with program.folder() as place:
            (place / "model.sensor.yaml").write_text(self)
            document: dict[str, Any] = program.document("model", [str(place / "model.sensor.yaml")])["models"][0]
        return document

    def to_dict(self) -> dict[str, Any]:
        """The keys of a .sensor.json."""
        return {key: plain(value) for key, value in self._document().items()}

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self)}</pre>"

    def export(self, to: str, **options: Any) -> str:
        """The text that another program takes: kalibr, sdf, … (`sensorchar model --list`)."""
        return export([self], to, **options)


def export(models: Sequence[str], to: str, **options: Any) -> str:
    """The models of one device as the text that another program takes: kalibr, vins, sdf, matlab, …
    (docs/exports.md); options are those of `sensorchar model`, such as axes="rms", anyway=True.

    Raises InputError for a coefficient with a finding that makes it unfit."""
    with program.folder() as place:
        for k, model in enumerate(models):
            (place / f"{k:04}.sensor.yaml").write_text(model)
        return str(program.document("model", [str(place), f"--to={to}", *program.words_of(options)])["text"])


def _plain_document(document: dict[str, Any]) -> dict[str, Any]:
    return {key: plain(value) for key, value in document.items()}


def _compared(document: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The terms of a comparison, one row per channel, term and sensor."""
    rows = []
    for group in document["groups"]:
        for term in group["terms"]:
            for one in term["sensors"]:
                low, high = (None, None) if one["ci95"] is None else one["ci95"]
                rows.append({"channel": group["name"], "term": term["term"], "sensor": one["name"],
                             "value": one["value"], "low95": low, "high95": high, "upper95": one["upper95"],
                             "unit": term["unit"], "status": one["status"], "lowest": one["name"] == term["lowest"]})
    return rows


def _of_lot(document: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The quantities of a lot: means and spreads."""
    keys = ("group", "what", "mean", "spread", "spread_is", "unit", "counted", "members")
    return [{key: one.get(key) for key in keys} for one in document["quantities"]]


class Document(_Shown, dict):  # type: ignore[type-arg]
    """What a verb prints with --json (docs/json.md), long lists of numbers as arrays. `html`: its page, where it has
    one. Shown as its verdict and its table."""

    html: str = ""

    @property
    def verdict(self) -> str:
        """In a sentence, "" where the document has none."""
        return str(self.get("verdict", ""))

    def to_dict(self) -> dict[str, Any]:
        """In plain Python types."""
        return _plain_document(self)

    def to_dataframe(self) -> Any:
        """A pandas.DataFrame of its table: terms of a comparison, quantities of a lot, channels of a log."""
        rows = self._table()[1]
        return frame({key: [row[key] for row in rows] for key in (rows[0] if rows else ())})

    def _table(self) -> tuple[str, list[dict[str, Any]]]:
        if "groups" in self:
            return self.verdict, _compared(self)
        if "quantities" in self:
            return self.verdict, _of_lot(self)
        named = [one for one in self.get("channels", []) if isinstance(one, dict) and "name" in one]
        simple = [key for key in (named[0] if named else {}) if
                  all(isinstance(one.get(key), (str, int, float)) for one in named)]
        about = str(self.get("file") or self.get("format") or "document")
        above = self.verdict or f"{about}: {', '.join(self)}"
        return above, [{key: one[key] for key in simple} for one in named]


@dataclasses.dataclass(frozen=True, repr=False)
class Recording(_Shown, _Result):
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

    def to_dataframe(self) -> Any:
        """A pandas.DataFrame, one column per channel, by seconds after the first sample."""
        out = frame(dict(zip(self.names, self.samples)), self.time_s)
        out.index.name = "t[s]"
        return out

    def plot(self, **options: Any) -> Figure:
        """A figure of what it is characterized to; options are those of `sensorchar plot`: kind="trace"…"""
        from .functions import plot
        return plot(self, **options)

    def _table(self) -> tuple[str, list[dict[str, Any]]]:
        rows = [{"channel": name, "unit": unit, "samples": int(np.isfinite(x).sum()), "missing": int(np.isnan(x).sum()),
                 "mean": float(np.nanmean(x)) if np.isfinite(x).any() else None} for name, unit, x in
                zip(self.names, self.units, self.samples)]
        return f"{self.file}: {len(self)} samples at {self.rate_hz:.10g} Hz", rows


@dataclasses.dataclass(frozen=True, repr=False)
class AllanCurve(_Drawn):
    """A deviation of the Allan family. `taus, devs, errs, ns = curve` is what allantools returns: errs is one standard
    deviation, from the degrees of freedom."""

    name: str
    unit: str
    type: str  #: oadev, mdev, …
    tau_s: Array  #: averaging times, s
    deviation: Array  #: in the channel's unit (tdev: times s)
    ci95: Array  #: (n, 2): chi-square interval, 95 %
    edf: Array  #: equivalent degrees of freedom
    terms: npt.NDArray[np.int64]  #: differences that were averaged
    findings: list[dict[str, Any]] = dataclasses.field(default_factory=list)  #: about the samples of the channel
    document: dict[str, Any] = dataclasses.field(default_factory=dict, repr=False)

    def __repr__(self) -> str:
        return (f"{self.type} of {self.name} in {self.unit or '1'}: {_range(self.deviation)} at {self.tau_s[0]:.4g} to "
                f"{self.tau_s[-1]:.4g} s")

    def __iter__(self) -> Iterator[Any]:
        return iter((self.tau_s, self.deviation, self.deviation / np.sqrt(2 * self.edf), self.terms))

    def to_dict(self) -> dict[str, Any]:
        return _plain_document(self.document)

    def to_dataframe(self) -> Any:
        """A pandas.DataFrame, one row per averaging time."""
        return frame({"tau_s": self.tau_s, "deviation": self.deviation, "low95": self.ci95[:, 0],
                      "high95": self.ci95[:, 1], "edf": self.edf, "terms": self.terms})

    def _drawn(self) -> tuple[str, dict[str, Any]]:
        return "allan", {"type": self.type, "channels": [self.document]}

    def _repr_html_(self) -> str:
        return self.plot().svg


@dataclasses.dataclass(frozen=True, repr=False)
class Spectrum(_Drawn):
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
    findings: list[dict[str, Any]] = dataclasses.field(default_factory=list)  #: about the samples of the channel

    def __repr__(self) -> str:
        return (f"{self.scaling} of {self.name}, {self.sides}-sided, {self.segments} segments of {self.segment}: "
                f"{_range(self.value)} up to {self.frequency_hz[-1]:.4g} Hz")

    def to_dataframe(self) -> Any:
        """A pandas.DataFrame, one row per frequency."""
        return frame({"frequency_hz": self.frequency_hz, "value": self.value, "low95": self.ci95[:, 0],
                      "high95": self.ci95[:, 1], "dof": self.dof})

    def _drawn(self) -> tuple[str, dict[str, Any]]:
        channel = {key: getattr(self, key) for key in ("name", "unit", "frequency_hz", "value", "dof", "ci95")}
        return "spectrum", {"sides": self.sides, "scaling": self.scaling, "channels": [channel]}

    def _repr_html_(self) -> str:
        return self.plot().svg


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


@dataclasses.dataclass(frozen=True, repr=False)
class NoiseFit(_Shown, _Drawn):
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

    def _drawn(self) -> tuple[str, dict[str, Any]]:
        return "noise-fit", {"channels": [self.to_dict()]}

    def terms(self) -> dict[str, NoiseTerm]:
        """The coefficients by their names."""
        return {name: value for name, value in vars(self).items() if isinstance(value, NoiseTerm)}

    def to_dataframe(self) -> Any:
        """A pandas.DataFrame, one row per coefficient."""
        rows = self._table()[1]
        return frame({key: [row[key] for row in rows] for key in (rows[0] if rows else {})})

    def _table(self) -> tuple[str, list[dict[str, Any]]]:
        return self.name, [
            {"coefficient": name, "value": term.value, "low95": term.ci95[0] if term.ci95 else None,
             "high95": term.ci95[1] if term.ci95 else None, "upper95": term.upper95, "unit": term.unit,
             "status": term.status} for name, term in self.terms().items() if term.status != "not_fitted"]


@dataclasses.dataclass(frozen=True, repr=False)
class ChannelReport(_Result):
    """A channel of a characterization; what is None could not be had, and `findings` says why."""

    name: str
    unit: str
    fit: Optional[NoiseFit]
    allan: Optional[AllanCurve]
    findings: list[dict[str, Any]]
    _document: dict[str, Any] = dataclasses.field(default_factory=dict, repr=False, compare=False)

    def plot(self, **options: Any) -> Figure:
        """A figure of this channel; options are those of `sensorchar plot`: kind="psd", width="two-columns"…"""
        return Figure([("report.json", json.dumps(self._document))], {"channel": self.name, **options})

    def _repr_html_(self) -> str:
        said = "".join(f"<p>{html.escape(one['severity'])}: {html.escape(one['sentence'])}</p>" for one in
                       self.findings)
        return ((self.fit._repr_html_() if self.fit else f"<p>{html.escape(self.name)}</p>") + said +
                (self.allan._repr_html_() if self.allan else ""))

    def __repr__(self) -> str:
        shown = [repr(self.fit) if self.fit else self.name] + [repr(self.allan)] * (self.allan is not None)
        return "\n".join(shown + [f"{one['severity']}: {one['sentence']}" for one in self.findings])


@dataclasses.dataclass(frozen=True, repr=False)
class Characterization(_Shown, _Drawn):
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

    def models(self) -> list[Model]:
        """A sensor model of each channel that was fitted: for `simulate`, `export`, or a file CHANNEL.sensor.yaml."""
        return [Model(text) for text in self._kept.models()]

    def export(self, to: str, **options: Any) -> str:
        """The text that another program takes: kalibr, vins, sdf, … (`libchar.export`)."""
        return export(self.models(), to, **options)

    def _rows(self) -> list[dict[str, Any]]:
        ratings = {c["name"]: c["rating"] for c in self.document["summary"]["channels"]}
        rows = []
        for channel in self.channels:
            row: dict[str, Any] = {"channel": channel.name, "unit": channel.unit, "rating": ratings.get(channel.name)}
            for name, term in (channel.fit.terms() if channel.fit else {}).items():
                row.update({name: term.value, f"{name}_low95": term.ci95[0] if term.ci95 else None,
                            f"{name}_high95": term.ci95[1] if term.ci95 else None, f"{name}_status": term.status})
            rows.append(row)
        return rows

    def to_dataframe(self) -> Any:
        """A pandas.DataFrame, one row per channel: coefficients with intervals and status, and the rating."""
        rows = self._rows()
        keys = list(dict.fromkeys(key for row in rows for key in row))
        return frame({key: [row.get(key) for row in rows] for key in keys})

    def _drawn(self) -> tuple[str, dict[str, Any]]:
        return "characterization", self.document

    def _table(self) -> tuple[str, list[dict[str, Any]]]:
        shown = ("channel", "unit", "rating", "white_noise", "bias_instability", "random_walk")
        return self.verdict, [{key: row.get(key) for key in shown} for row in self._rows()]

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
    ns_per_sample: Optional[float]  #: run time, ns per sample instant
    document: dict[str, Any] = dataclasses.field(default_factory=dict, repr=False)

    def to_dict(self) -> dict[str, Any]:
        return _plain_document(self.document)


@dataclasses.dataclass(frozen=True, repr=False)
class ReplayResult(_Shown, _Drawn):
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

    def fusion_yaml(self) -> str:
        """What was learnt, as the file fusion.yaml: for `fuse`."""
        return self._kept.fusion()

    def _rows(self) -> list[dict[str, Any]]:
        return [{key: getattr(a, key) for key in ("name", "status", "rmse", "regret", "ns_per_sample", "why")} for a in
                self.algorithms]

    def to_dataframe(self) -> Any:
        """A pandas.DataFrame, one row per algorithm."""
        rows = self._rows()
        return frame({key: [row[key] for row in rows] for key in (rows[0] if rows else ())})

    def _drawn(self) -> tuple[str, dict[str, Any]]:
        return "replay-report", self.document

    def _table(self) -> tuple[str, list[dict[str, Any]]]:
        shown = ("name", "rmse", "regret", "ns_per_sample")
        return self.verdict, [{key: row[key] for key in shown} for row in self._rows() if row["status"] == "ran"]
