"""The functions of the package; their defaults are those of the program."""
from __future__ import annotations

import contextlib
import dataclasses
import datetime
import json
import os
import pathlib
import warnings
from typing import Any, Iterator, Mapping, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _libchar, program
from .errors import CopyWarning, InputError, NumericError, UsageError
from .results import (AllanCurve, Algorithm, Characterization, ChannelReport, Document, Figure, Model, NoiseFit,
                      NoiseTerm, Recording, ReplayResult, Spectrum, document_of)

#: A path of a log, a recording that was read, an array (one channel, or a table whose longer axis is the time), arrays
#: by name, or a pandas.DataFrame.
Source = Union[str, "os.PathLike[str]", Recording, npt.ArrayLike, Mapping[str, npt.ArrayLike]]
Names = Optional[Sequence[str]]

_TERMS = ("white_noise", "bias_instability", "random_walk", "quantization", "rate_ramp")
# What is only known of a file is refused for samples in memory.
_OF_FILES = ("from_s", "to_s", "time_column", "time_unit", "format", "delimiter", "decimal", "header", "encoding",
             "skip_rows", "topic", "time_source")


def _array(values: Any) -> npt.NDArray[Any]:
    """An array that keeps its mask, as do arrays in a list."""
    if isinstance(values, np.ma.MaskedArray):
        return values
    masked = isinstance(values, (list, tuple)) and any(isinstance(one, np.ma.MaskedArray) for one in values)
    return np.ma.array(values) if masked else np.asarray(values)


def _column(values: npt.ArrayLike, name: str) -> npt.NDArray[np.float64]:
    given, mask = np.asarray(values), np.ma.getmask(values)
    if given.ndim != 1:
        raise UsageError(f"{name}: an array of one dimension was expected, this has {given.ndim}", "E0208", name)
    if given.dtype.kind not in "fiu":
        raise UsageError(f"{name}: an array of numbers was expected, this is of {given.dtype}", "E0208", name)
    hidden = bool(np.any(mask))
    out = np.ascontiguousarray(np.where(mask, np.nan, given) if hidden else given, dtype=np.float64)
    if out is not given and not np.shares_memory(out, given):
        what = "masked" if hidden else "not contiguous" if given.dtype == np.float64 else f"of {given.dtype}"
        warnings.warn(f"{name}: {given.size} samples were copied, because the array is {what}", CopyWarning,
                      stacklevel=4)
    return out


def _listed(names: Any, where: str) -> Optional[list[str]]:
    """One name, or several, as a list."""
    if names is None or isinstance(names, str):
        return names if names is None else [names]
    try:
        listed = list(names)
    except TypeError:
        listed = [names]
    wrong = next((one for one in listed if not isinstance(one, str)), None)
    if wrong is not None:
        raise UsageError(f"{where}: a name or a list of names was expected, this is {wrong!r}", "E0208", where)
    return listed


def _is_frame(source: Any) -> bool:
    return hasattr(source, "columns") and hasattr(source, "index") and hasattr(source, "to_numpy")


def _is_series(source: Any) -> bool:
    return hasattr(source, "to_frame") and hasattr(source, "index") and hasattr(source, "to_numpy")


def _by_name(frame: Any) -> dict[str, npt.NDArray[np.float64]]:
    """The columns of a frame; of one name the second is NAME_2, as in a file."""
    out: dict[str, npt.NDArray[np.float64]] = {}
    for k, given in enumerate(frame.columns):
        name = str(given)
        for n in range(2, len(frame.columns) + 1):
            if name not in out:
                break
            name = f"{given}_{n}"
        out[name] = _of_series(frame[given] if list(frame.columns).count(given) == 1 else frame.iloc[:, k], name)
    return out


def _of_series(series: Any, name: str) -> npt.NDArray[np.float64]:
    """A column of a frame; what pandas marks as not available is missing."""
    own = getattr(series, "dtype", None)
    nullable = hasattr(series, "to_numpy") and own is not None and not isinstance(own, np.dtype)
    try:
        if nullable:
            return np.asarray(series.to_numpy(dtype=np.float64, na_value=np.nan))
        return np.ma.filled(_array(series).astype(np.float64, copy=False), np.nan)
    except (TypeError, ValueError) as error:
        raise UsageError(f"{name}: an array of numbers was expected, this is of {own}", "E0208", name) from error


def _instants(index: Any) -> Optional[npt.NDArray[np.int64]]:
    """Stamps of an index in ns, of UTC where it has a time zone; None where it has no instants."""
    if getattr(index, "tz", None) is not None and hasattr(index, "asi8"):
        given = np.asarray(index.asi8).astype(f"M8[{getattr(index, 'unit', 'ns')}]")
    else:
        given = np.asarray(index)
        if given.dtype == object and given.size and all(isinstance(one, datetime.datetime) for one in given):
            return np.array([_nanoseconds(one) for one in given], dtype=np.int64)
    kind = given.dtype.kind
    return given.astype(f"{kind}8[ns]").astype(np.int64) if kind in "mM" else None


def _nanoseconds(instant: datetime.datetime) -> int:
    """Since 1970; an instant without a time zone is of UTC. pandas' own has more digits than a datetime."""
    if hasattr(instant, "value"):
        return int(instant.value)
    utc = instant if instant.tzinfo is not None else instant.replace(tzinfo=datetime.timezone.utc)
    return (utc - datetime.datetime(1970, 1, 1, tzinfo=datetime.timezone.utc)) // datetime.timedelta(
        microseconds=1) * 1000


def _of_frame(frame: Any) -> Source:
    """A DataFrame as a recording, by its own stamps if its index has instants, else its columns by name. What the
    stamps mean (their rate, jitter, gaps) is decided as for a file."""
    columns = _by_name(frame)
    stamps = _instants(frame.index)
    if stamps is None:
        return columns
    absent = np.flatnonzero(stamps == np.iinfo(np.int64).min)  # NaT
    if absent.size:
        rows = "1 row" if absent.size == 1 else f"{absent.size} rows"
        raise UsageError(f"index: {rows} without a time, the first is row {absent[0]}", "E0208", "index",
                         "frame[frame.index.notna()]")
    table = np.empty(len(stamps), dtype=[("t[ns]", np.int64), *((name, np.float64) for name in columns)])
    table["t[ns]"] = stamps
    for name, values in columns.items():
        table[name] = values
    with program.folder() as place, program.known_as(place / "frame.npy", "DataFrame"):
        np.save(place / "frame.npy", table)
        try:
            return read(place / "frame.npy")
        except InputError as error:
            if error.code != "E0315":
                raise
            raise UsageError("index: its times fall from row to row", "E0208", "index", "frame.sort_index()") from error


def _columns(source: Source, rate_hz: Optional[float], names: Names, units: Names, channels: Names) -> dict[str, Any]:
    """Names, units and contiguous columns of what is in memory."""
    framed = _is_frame(source) or _is_series(source)
    if _is_series(source):
        source = source.to_frame("c0" if source.name is None else str(source.name))  # type: ignore[union-attr]
    if _is_frame(source):
        source = _of_frame(source)
    units, names, channels = _listed(units, "units"), _listed(names, "names"), _listed(channels, "channels")
    if isinstance(source, Recording):
        found = dict(zip(source.names, source.samples))
        unit_of = dict(zip(source.names, source.units))
        rate_hz = source.rate_hz if rate_hz is None else rate_hz
    else:
        if isinstance(source, Mapping):
            found = {str(name): _array(values) for name, values in source.items()}
        else:
            array = _array(source)
            across = array.ndim == 2 and array.shape[0] < array.shape[1]  # three channels of many samples
            table = [array] if array.ndim < 2 else list(array if across else array.T) if array.ndim == 2 else []
            if not table:
                raise UsageError(f"an array of one or two dimensions was expected, this has {array.ndim}", "E0208",
                                 "samples")
            found = {f"c{k}": column for k, column in enumerate(table)}
        unit_of = dict.fromkeys(found, "")
    if framed:  # a frame keeps the names of a file, "Gyro X (deg/s)"
        unit_of = {name: unit or _libchar.unit_of_name(name) for name, unit in unit_of.items()}
    if channels is not None:
        missing = [name for name in channels if name not in found]
        if missing:
            raise UsageError(f"no channel {missing[0]!r}; there are {', '.join(found)}", "E0208", "channels")
        found = {name: found[name] for name in channels}
    if names is not None and len(names) != len(found):
        raise UsageError(f"{len(names)} names for {len(found)} channels", "E0208", "names")
    if units is not None and len(units) not in (1, len(found)):
        raise UsageError(f"{len(units)} units for {len(found)} channels", "E0208", "units")
    shown = list(names) if names is not None else list(found)
    own = [unit_of[name] for name in found]
    said = own if units is None else list(units) * (len(found) if len(units) == 1 else 1)
    if not found:
        raise UsageError("there is no channel", "E0208", "samples")
    if not rate_hz:
        raise UsageError("samples in memory need their sampling rate", "E0208", "rate_hz", "rate_hz=200")
    if isinstance(rate_hz, str) or not 0 < rate_hz < np.inf:
        raise UsageError(f"a sampling rate in Hz was expected, this is {rate_hz!r}", "E0208", "rate_hz", "rate_hz=200")
    return {"names": shown, "units": said,
            "samples": [_column(values, name) for name, values in zip(shown, found.values())],
            "rate_hz": float(rate_hz), "file": source.file if isinstance(source, Recording) else "memory"}


def _path(source: Source) -> Optional[str]:
    named = isinstance(source, (str, bytes, os.PathLike)) and not isinstance(source, Model)
    return os.fsdecode(source) if named else None  # type: ignore[arg-type]


def _kind(value: Any) -> str:
    return type(value).__name__


def _one_or_all(source: Source, results: list[Any]) -> Any:
    """One array in, one result out."""
    one = not isinstance(source, (str, bytes, os.PathLike, Recording, Mapping)) and not _is_frame(source)
    return results[0] if one and np.ndim(source) == 1 else results


def _rate_of(sources: Sequence[Any], rate_hz: Optional[float], options: dict[str, Any]) -> Optional[float]:
    """The rate of what is in memory; that of files is an option of the program."""
    rate: Optional[float] = options.pop("rate", None) if rate_hz is None else rate_hz
    if rate is None or any(_path(one) is None for one in sources):
        return rate
    options["rate"] = rate
    return None


@contextlib.contextmanager
def _on_disk(source: Any, rate_hz: Optional[float] = None, names: Names = None, units: Names = None,
             name: str = "recording") -> Iterator[str]:
    """A path for the program: what is in memory is written to a file of this call."""
    path = _path(source)
    if path is not None:
        yield path
        return
    with program.folder() as place:
        if isinstance(source, Characterization):
            log = place / f"{name}.json"
            log.write_text(json.dumps(source.to_dict()))
        elif isinstance(source, AllanCurve):
            log = place / f"{name}.json"
            log.write_text(document_of(source)[1])
        elif isinstance(source, Model):
            log = place / f"{name}.sensor.yaml"
            log.write_text(source)
        else:
            log = place / f"{name}.f64"
            _libchar.write_recording(str(log), _columns(source, rate_hz, names, units, None), False)
        with program.known_as(log, name):
            yield str(log)


def _document(verb: str, source: Any, log: str, words: Sequence[str]) -> dict[str, Any]:
    """What the program prints of a log; samples in memory are named so, not by the file of the call."""
    made = program.document(verb, [log, *words])
    return made if _path(source) is not None else program.renamed(made, log, "memory")  # type: ignore[no-any-return]


def _reading(arguments: Mapping[str, Any], in_memory: bool) -> dict[str, Any]:
    given = {key: value for key, value in arguments.items() if value is not None}
    if isinstance(given.get("threads"), int) and given["threads"] < 0:
        raise UsageError(f"threads: a number of threads was expected, this is {given['threads']}", "E0208", "threads")
    if in_memory:
        wrong = [key for key in _OF_FILES if key in given]
        if wrong:
            raise UsageError(f"{wrong[0]} says how a file is read, and these are samples in memory", "E0208", wrong[0])
        return {key: value for key, value in given.items() if key == "threads"}
    lists = ("channels", "names", "units")
    return {key: _listed(value, key) if key in lists else value for key, value in given.items()}


def _characterized(source: Source, reading: Mapping[str, Any], options: Mapping[str, Any]) -> _libchar.Characterized:
    path = _path(source)
    if path is not None:
        return _libchar.characterize_file(path, _reading(reading, False), dict(options))
    columns = _columns(source, reading["rate_hz"], reading["names"], reading["units"], reading["channels"])
    return _libchar.characterize_columns(columns, _reading(reading, True), dict(options))


def _curve(channel: dict[str, Any], kind: str) -> AllanCurve:
    def array(key: str) -> npt.NDArray[np.float64]:
        return np.array([np.nan if value is None else value for value in channel[key]], dtype=np.float64)

    ci95 = np.array([(np.nan, np.nan) if pair is None else pair for pair in channel["ci95"]],
                    dtype=np.float64).reshape(-1, 2)
    return AllanCurve(channel["name"], channel["unit"], kind, array("tau_s"), array("deviation"), ci95, array("edf"),
                      np.array(channel["terms"], dtype=np.int64), channel.get("findings") or [],
                      {"type": kind, **channel})


def _term(term: dict[str, Any]) -> NoiseTerm:
    ci95 = term.get("ci95")
    return NoiseTerm(term.get("value"), (ci95[0], ci95[1]) if ci95 else None, term["status"], term.get("upper95"),
                     term.get("unit") or "", term)


def _fit(channel: dict[str, Any]) -> NoiseFit:
    terms = {key: _term(channel[key]) for key in _TERMS}
    return NoiseFit(channel["name"], channel["unit"], document=channel, **terms)


def _refuse_nothing(kept: _libchar.Characterized, what: str, found: Sequence[Any]) -> None:
    if found:
        return
    sentences = [f"{name}: {one['sentence']}" for name, findings in kept.findings() for one in findings]
    raise NumericError(f"no channel gives {what}" + (f": {sentences[0]}" if sentences else ""), "E0711")


def _recording(made: Mapping[str, Any]) -> Recording:
    return Recording(made["names"], made["units"], made["samples"], made["rate_hz"], made["file"], made["start_ns"],
                     made["warnings"],
                     made["info"])


def read(path: Union[str, "os.PathLike[str]"], *, channels: Names = None, names: Names = None, units: Names = None,
         from_s: Optional[float] = None, to_s: Optional[float] = None, rate_hz: Optional[float] = None,
         time_column: Optional[str] = None, time_unit: Optional[str] = None, format: Optional[str] = None,
         delimiter: Optional[str] = None, decimal: Optional[str] = None, header: Optional[str] = None,
         encoding: Optional[str] = None, skip_rows: Optional[int] = None, overflow_as_missing: Optional[bool] = None,
         missing: Optional[Sequence[float]] = None, drop_bad_rows: Optional[bool] = None,
         skip_repeated_header: Optional[bool] = None, topic: Optional[str] = None, time_source: Optional[str] = None,
         threads: Optional[int] = None) -> Recording:
    """Reads a log of any format that the program reads (docs/formats.md).

    channels     names, positions ("c0") or patterns ("gyro*") of the channels to read; None: all
    names, units of the channels that are read, in order
    from_s, to_s first instant to use and first not to use, in s after the first stamp
    rate_hz      sampling rate in Hz, of a log without stamps and without a rate
    topic        of a log that holds several streams, the one to read; time_source: whose stamps count
    time_column, time_unit, format, delimiter, decimal, header, encoding, skip_rows: as the options of the
    program of these names
    missing      values that mean "no reading", such as -999

    Raises InputError with file, line and column, UsageError for an option that does not fit the file.
    """
    return _recording(_libchar.read(os.fspath(path),
                                    _reading({k: v for k, v in locals().items() if k != "path"}, False)))


def write(path: Union[str, "os.PathLike[str]"], samples: Source, rate_hz: Optional[float] = None, *,
          names: Names = None,
          units: Names = None, overwrite: bool = False) -> None:
    """Writes samples as a log; the suffix says the format (.csv, .npy, raw with a sidecar). The file reads
    back to the same bits."""
    _libchar.write_recording(os.fspath(path), _columns(samples, rate_hz, names, units, None), overwrite)


def allan(source: Source, rate_hz: Optional[float] = None, *, type: str = "oadev",
          taus: Union[str, Sequence[float]] = "octave",
          tau_min_s: Optional[float] = None, tau_max_s: Optional[float] = None, full_overlap: bool = False,
          data: str = "rate",
          nominal_frequency: Optional[float] = None, channels: Names = None, names: Names = None, units: Names = None,
          threads: Optional[int] = None, rate: Optional[float] = None) -> Any:
    """Deviations of the Allan family, one AllanCurve per channel, with chi-square intervals (`sensorchar allan`): a
    list, or one curve where `source` is one array. `taus, devs, errs, ns = allan(x, rate=100)` unpacks it as allantools
    does.

    source       path of a log, Recording, array (one column per channel), or mapping of names to arrays
    rate_hz      sampling rate in Hz (rate is the same); not needed for a Recording or a log that has it
    type         adev, oadev, mdev, tdev, hdev, ohdev, totdev, …
    taus         octave, decade, dense, ten, or averaging times in s
    data         meaning of the samples: rate, phase (its integral), frequency (in Hz, around nominal_frequency)

    Deviations are in the unit of the channel. Raises NumericError when no channel has enough samples.
    """
    rate_hz = rate if rate_hz is None else rate_hz
    reading = {"rate_hz": rate_hz, "channels": channels, "names": names, "units": units, "threads": threads}
    options = {"only": "allan", "type": type, "taus": taus if isinstance(taus, str) else [float(t) for t in taus],
               "tau_min_s": tau_min_s,
               "tau_max_s": tau_max_s, "full_overlap": full_overlap, "data": data,
               "nominal_frequency": nominal_frequency}
    kept = _characterized(source, reading, options)
    document = kept.allan()
    _refuse_nothing(kept, "an Allan deviation", document["channels"])
    return _one_or_all(source, [_curve(channel, channel.get("type", document.get("type", type))) for channel in
                                document["channels"]])


def psd(source: Source, rate_hz: Optional[float] = None, *, segment: Optional[int] = None,
        segment_s: Optional[float] = None,
        overlap: float = 0.5, window: str = "hann", detrend: str = "constant", sides: str = "one", scaling: str = "psd",
        bins: int = 0, channels: Names = None, names: Names = None, units: Names = None,
        threads: Optional[int] = None, rate: Optional[float] = None) -> Any:
    """Power spectra by Welch's method, one Spectrum per channel (`sensorchar psd`): a list, or one where `source` is
    one array.

    segment, segment_s  samples of a segment, or its length in s; None: a quarter of the record, 65536 samples
                        of one of more than 1048576
    overlap             of segments, a fraction
    window, detrend     hann, rectangular, blackman_harris, flat_top…; none, constant, linear
    sides, scaling      one, two; psd U²/Hz, ps U², lsd U/√Hz, ls U
    bins                averaged into at most so many on a logarithmic axis of frequency; 0: not averaged
    """
    rate_hz = rate if rate_hz is None else rate_hz
    reading = {"rate_hz": rate_hz, "channels": channels, "names": names, "units": units, "threads": threads}
    options = {"segment": segment, "segment_s": segment_s, "overlap": overlap, "window": window, "detrend": detrend,
               "sides": sides,
               "scaling": scaling, "bins": bins}
    path = _path(source)
    what: Union[str, dict[str, Any]] = path if path is not None else _columns(source, rate_hz, names, units, channels)
    made = _libchar.psd(what, _reading(reading, path is None), options)
    return _one_or_all(source, [Spectrum(**one) for one in made])


def fit(source: Source, rate_hz: Optional[float] = None, *, terms: Names = None, threshold: Optional[float] = None,
        remedies: bool = True,
        second_opinion: bool = True, still: Optional[str] = None, temperature: Optional[str] = None, data: str = "rate",
        nominal_frequency: Optional[float] = None, channels: Names = None, names: Names = None, units: Names = None,
        threads: Optional[int] = None, rate: Optional[float] = None) -> Any:
    """Noise coefficients with 95 % intervals, one NoiseFit per channel (`sensorchar fit`): a list, or one where
    `source` is one array.

    terms           offered to the fit from the start: white_noise, bias_instability, random_walk, rate_ramp,
                    quantization, or N, B, K, R, Q
    threshold       likelihood ratio above which a term counts as present (5.41: 1 % false)
    remedies        clean spikes, clip lines, add ramp, bandwidth or quantization terms where an alarm asks for it
    second_opinion  fit the Allan curve as well
    still           "auto", or "FROM..TO" in s: only that stretch is analysed
    temperature     channel whose effect is taken out of the others first

    Coefficients are roots of two-sided densities, in U·√s (N), U (B), U/√s (K).
    """
    rate_hz = rate if rate_hz is None else rate_hz
    reading = {"rate_hz": rate_hz, "channels": channels, "names": names, "units": units, "threads": threads}
    options = {"only": "fit", "terms": _listed(terms, "terms"), "threshold": threshold,
               "remedies": remedies,
               "second_opinion": second_opinion, "still": still, "temperature": temperature, "data": data,
               "nominal_frequency": nominal_frequency}
    kept = _characterized(source, reading, options)
    fits = kept.fits()["channels"]
    _refuse_nothing(kept, "a fit", fits)
    return _one_or_all(source, [_fit(channel) for channel in fits])


def characterize(source: Source, rate_hz: Optional[float] = None, *, type: str = "oadev",
                 taus: Union[str, Sequence[float]] = "ten",
                 terms: Names = None, threshold: Optional[float] = None, remedies: bool = True,
                 second_opinion: bool = True,
                 still: Optional[str] = None, temperature: Optional[str] = None, data: str = "rate",
                 nominal_frequency: Optional[float] = None, channels: Names = None, names: Names = None,
                 units: Names = None,
                 threads: Optional[int] = None, rate: Optional[float] = None) -> Characterization:
    """Everything about a recording: curves, coefficients, models, a page (`sensorchar characterize`).

    Arguments as of `allan` and `fit`: times in s, rate_hz (or rate) in Hz, samples in the unit of their channel.
    """
    rate_hz = rate if rate_hz is None else rate_hz
    reading = {"rate_hz": rate_hz, "channels": channels, "names": names, "units": units, "threads": threads}
    options = {"type": type, "taus": taus if isinstance(taus, str) else [float(t) for t in taus],
               "terms": _listed(terms, "terms"), "threshold": threshold, "remedies": remedies,
               "second_opinion": second_opinion, "still": still, "temperature": temperature, "data": data,
               "nominal_frequency": nominal_frequency}
    kept = _characterized(source, reading, options)
    document = kept.document()
    curves = kept.allan()
    by_name = {c["name"]: _curve(c, curves.get("type", type)) for c in curves["channels"]}
    fits = {c["name"]: _fit(c) for c in kept.fits()["channels"]}
    units_of = {c["name"]: c["unit"] for c in document["recording"]["channels"]}
    reports = [ChannelReport(name, units_of.get(name, ""), fits.get(name), by_name.get(name), findings, document) for
               name, findings in kept.findings()]
    return Characterization(document["verdict"], reports, document, kept.seconds(), kept)


def _simulated(models: Sequence[Any], options: Mapping[str, Any]) -> Recording:
    """Sensors of several models in one recording."""
    with program.folder() as place, contextlib.ExitStack() as kept:
        texts = [Model(one) if isinstance(one, str) and "\n" in one else one for one in models]
        paths = [kept.enter_context(_on_disk(one, name=f"model {k + 1}")) for k, one in enumerate(texts)]
        words = {"duration": options["duration_s"], "rate": options["rate_hz"], "seed": options["seed"],
                 "devices": options["devices"], "truth": options["truth"], "fault": options["faults"]}
        made = place / "simulation.f64"
        program.run("simulate", [*paths, *program.words_of(words), "--no-scene", f"--output={made}"])
        return dataclasses.replace(read(made), file="simulation")


def simulate(model: Any, *, duration_s: float = 3600, rate_hz: Optional[float] = None,
             seed: int = 1,
             devices: int = 1, truth: Optional[str] = None, faults: Names = None) -> Recording:
    """Devices of a sensor model, the truth as last channel (`sensorchar simulate`). The same seed gives the
    same samples.

    model       path of a model (.sensor.yaml), or its text, as `Characterization.models()` has it; a list of models,
                or a Characterization: one channel for each
    duration_s  length in s
    rate_hz     sampling rate in Hz; None: the model's
    truth       what the sensors measure: "0.5", "sine,amplitude=2,frequency_hz=0.1" (docs/scenes.md)
    faults      "SENSOR:KIND=VALUE@FROM..TO", times in s
    """
    options = {"duration_s": float(duration_s), "rate_hz": rate_hz, "seed": seed, "devices": devices, "truth": truth,
               "faults": _listed(faults, "faults")}
    several = model.models() if isinstance(model, Characterization) else model
    if isinstance(several, (list, tuple)) and several and all(isinstance(one, (str, os.PathLike)) for one in several):
        if len(several) > 1:
            return _simulated(several, options)
        model = several[0]
    if not isinstance(model, (str, os.PathLike)):
        raise UsageError(f"model: the path or the text of a model, or a list of these, was expected, this is a "
                         f"{_kind(model)}", "E0208", "model")
    text = os.fspath(model)
    return _recording(_libchar.simulate(text, "\n" in text, options))


def replay(source: Source, *, sensors: Names = None, reference: Union[None, str, Sequence[str]] = None,
           learning: Optional[tuple[float, float]] = None, evaluation: Optional[tuple[float, float]] = None,
           rest: Optional[tuple[float, float]] = None, warm_up_s: Optional[float] = None, algorithms: Names = None,
           models_folder: Optional[str] = None, allan: bool = True, budget_s: Optional[float] = None,
           timing: bool = True,
           allow_outside: bool = False, rate_hz: Optional[float] = None, names: Names = None,
           units: Names = None, rate: Optional[float] = None) -> ReplayResult:
    """Every fusion algorithm that has what it needs, compared on one recording (`sensorchar replay`).

    source      scene file, path of a log, Recording, or arrays; what is in memory is written once to a
                temporary file, as a replay reads its recording several times
    sensors     channels that measure one quantity: names or patterns ("gyro*")
    reference   channel with the truth; of several the mean
    learning, evaluation, rest   windows (from, to) in s
    algorithms  these only (`sensorchar replay --list`)
    """
    rate_hz = rate if rate_hz is None else rate_hz
    options = {"sensors": _listed(sensors, "sensors"), "reference": _listed(reference, "reference"),
               "learning": learning, "evaluation": evaluation, "rest": rest, "warm_up_s": warm_up_s,
               "algorithms": _listed(algorithms, "algorithms"), "models_folder": models_folder,
               "allan": allan, "budget_s": budget_s, "timing": timing, "allow_outside": allow_outside}
    with _on_disk(source, rate_hz, names, units) as log:
        reading = {"rate_hz": rate_hz, "names": names, "units": units} if _path(source) is not None else {}
        made = _libchar.replay(log, _reading(reading, False), options)
    document = made.document()
    ran = [Algorithm(a["name"], a["status"], a.get("why"), a.get("rmse"), a.get("regret"), a.get("ns_per_sample"), a)
           for a in document["algorithms"]]
    return ReplayResult(document["verdict"], ran, document, made)


def inspect(source: Source, rate_hz: Optional[float] = None, **options: Any) -> Document:
    """What is in a log, what was guessed and what was repaired (`sensorchar inspect --json`): the keys of its
    recording, and its findings. rate_hz in Hz, of samples in memory; times in s; options are those of the program:
    topic="imu"."""
    with _on_disk(source, _rate_of([source], rate_hz, options)) as log:
        made = _document("inspect", source, log, program.words_of(options))
    return Document({**made["recordings"][0], "findings": made["findings"]})


def compare(*sources: Any, rate_hz: Optional[float] = None, labels: Names = None, channels: Names = None,
            **options: Any) -> Document:
    """Which sensor has the lowest noise, and at which averaging times (`sensorchar compare`): `verdict`, `groups`, and
    the page as `html`.

    sources   paths (logs, reports, models), Characterizations, AllanCurves, Models, Recordings or arrays, in any
              mixture
    rate_hz   sampling rate in Hz, of arrays
    labels    a name for each; channels: those to compare, by name or pattern
    Times are in s; further options are those of the program, such as limits="sheet.yaml".
    """
    rate_hz = _rate_of(sources, rate_hz, options)
    with contextlib.ExitStack() as kept:
        paths = [kept.enter_context(_on_disk(one, rate_hz, name=f"input {k + 1}")) for k, one in enumerate(sources)]
        page = kept.enter_context(program.folder()) / "compared.html"
        words = program.words_of({"label": labels, "channel": channels, **options})
        made = Document(program.document("compare", [*paths, *words, f"--output={page}"]))
        made.html = page.read_text()
    return made


def plot(*sources: Any, rate_hz: Optional[float] = None, **options: Any) -> Figure:
    """One figure of several results, overlaid (`sensorchar plot`): curves, spectra, characterizations, replays, models,
    paths; Recordings and arrays are characterized first. rate_hz in Hz, of arrays; options are those of the program,
    such as label=["a", "b"], kind="psd"."""
    rate_hz = options.pop("rate", None) if rate_hz is None else rate_hz
    drawn: list[tuple[str, Optional[str]]] = []
    for one in sources:
        if isinstance(one, Model):
            drawn.append((f"{one.channel}.sensor.yaml", str(one)))
        elif _path(one) is not None:
            drawn.append((os.path.abspath(os.fsdecode(one)), None))
        else:
            drawn.append(document_of(one if hasattr(one, "_drawn") else characterize(one, rate_hz)))
    return Figure(drawn, options)


def lot(*sources: Any, rate_hz: Optional[float] = None, **options: Any) -> Document:
    """Devices of one kind, one log each: mean, spread and outliers of each term (`sensorchar characterize --lot`), and
    the page as `html`. rate_hz in Hz, of arrays; times in s."""
    rate_hz = _rate_of(sources, rate_hz, options)
    with contextlib.ExitStack() as kept:
        paths = [kept.enter_context(_on_disk(one, rate_hz, name=f"device {k + 1}")) for k, one in enumerate(sources)]
        place = kept.enter_context(program.folder()) / "lot"
        program.run("characterize", [*paths, "--lot", f"--output={place}", *program.words_of(options)])
        made = Document(json.loads((place / "lot.json").read_text()))
        made.html = (place / "index.html").read_text()
    return made


def cross_spectrum(source: Source, a: str, b: str, rate_hz: Optional[float] = None, **options: Any) -> Document:
    """Cross spectrum and coherence of two channels (`sensorchar psd --cross A,B`): arrays frequency_hz in Hz, real,
    imaginary, phase_rad, coherence… Options are those of the program, such as segment="20s"."""
    with _on_disk(source, _rate_of([source], rate_hz, options)) as log:
        return Document(_document("psd", source, log, [f"--cross={a},{b}", *program.words_of(options)]))


def cornered_hat(source: Source, rate_hz: Optional[float] = None, *, pairs: bool = False, **options: Any) -> Document:
    """The deviation of each of three or more devices from their differences (`sensorchar allan --hat`): `channels` with
    arrays tau_s in s, deviation, variance, variance_sd. pairs: the channels are the differences a - b, b - c, c - a."""
    with _on_disk(source, _rate_of([source], rate_hz, options)) as log:
        words = ["--hat-pairs" if pairs else "--hat", *program.words_of(options)]
        return Document(_document("allan", source, log, words))


def fuse(source: Source, learnt: Any, rate_hz: Optional[float] = None, **options: Any) -> Recording:
    """A log fused by what a replay learnt (`sensorchar fuse`): the estimate, its deviation, a flag per sensor; what is
    known of the log and its sensors in `warnings`.

    learnt   ReplayResult, or the folder of a replay, or its fusion.yaml
    rate_hz  sampling rate in Hz, of arrays; times are in s
    Further options are those of the program, such as algorithm="minque", map=["gyro1=wx"].
    """
    with _on_disk(source, _rate_of([source], rate_hz, options)) as log, program.folder() as place:
        if isinstance(learnt, ReplayResult):
            (place / "fusion.yaml").write_text(learnt.fusion_yaml())
            learnt = place / "fusion.yaml"
        words = [log, f"--with={os.fspath(learnt)}", *program.words_of(options), f"--output={place / 'fused.f64'}"]
        findings = program.document("fuse", words)["findings"]
        sentences = [one["sentence"] for one in findings]
        return dataclasses.replace(read(place / "fused.f64"), file="fused", warnings=sentences)


def bench(**options: Any) -> Document:
    """Run time against error of the algorithms on this machine (`sensorchar bench`), times in s; options are those of
    the program: quick=True, parts="characterization"."""
    return Document(program.document("bench", program.words_of(options)))
