"""The Python module says what the program says, without copies, and refuses in sentences. usage:
module_test.py PROGRAM"""
import dataclasses
import datetime
import gc
import inspect
import json
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings

import numpy as np

import libchar
from libchar import functions

PROGRAM = os.path.abspath(sys.argv.pop(1))
ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
IMU = str(ROOT / "fixtures/imu_at_rest.csv")


def program(*words, folder=None):
    """The document that the program prints."""
    ran = subprocess.run([PROGRAM, *words, "--json", "--quiet"], cwd=folder, check=True, capture_output=True)
    return json.loads(ran.stdout)


def noise(n=20000, seed=1):
    return np.random.default_rng(seed).normal(size=n)


class Stamp(datetime.datetime):
    """As pandas' Timestamp: an instant whose value is in ns."""

    @classmethod
    def of(cls, ns, zone):
        made = cls.fromtimestamp(ns / 1e9, zone)
        made.value = ns
        return made


class Zoned:
    """As pandas' DatetimeIndex with a time zone: an array of it holds Stamps."""
    tz = "Europe/Paris"

    def __init__(self, stamps, asi8, unit):
        self.stamps, self.asi8, self.unit = stamps, asi8, unit

    def __array__(self, dtype=None):
        return self.stamps if dtype is None else self.stamps.astype(dtype)


class Frame:
    """As much of pandas' DataFrame as is asked of one."""

    def __init__(self, columns, index):
        self.columns, self.index, self._of = list(columns), index, columns

    def __getitem__(self, name):
        return self._of[name]

    def to_numpy(self):
        return np.stack(list(self._of.values()), axis=1)


class SaysWhatTheProgramSays(unittest.TestCase):
    def test_read(self):
        log = libchar.read(IMU)
        told = program("inspect", IMU)["recordings"][0]
        self.assertEqual(log.names, ["gyro_z", "accel_z"])
        self.assertEqual(log.units, ["deg/s", "g"])
        self.assertEqual(log.rate_hz, told["rate_hz"])
        self.assertEqual(len(log), told["samples"])
        self.assertAlmostEqual(float(np.mean(log["gyro_z"])), told["channels"][0]["mean"], places=12)
        self.assertEqual(libchar.read(IMU, channels=["accel_z"], to_s=10).names, ["accel_z"])
        self.assertEqual(len(libchar.read(IMU, to_s=10)), 500)

    def test_allan(self):
        for kind, taus in (("oadev", "octave"), ("mdev", "decade"), ("totdev", [0.1, 1, 10])):
            told = program("allan", IMU, "--type", kind, "--taus",
                           taus if isinstance(taus, str) else "0.1s,1s,10s")["channels"]
            for curve, channel in zip(libchar.allan(IMU, type=kind, taus=taus), told):
                self.assertEqual(curve.tau_s.tolist(), channel["tau_s"])
                self.assertEqual(curve.deviation.tolist(), channel["deviation"])
                self.assertEqual(curve.ci95.tolist(), channel["ci95"])
                self.assertEqual(curve.terms.tolist(), channel["terms"])
                self.assertEqual((curve.name, curve.unit, curve.type), (channel["name"], channel["unit"], kind))

    def test_psd(self):
        told = program("psd", IMU, "--segment", "4096", "--window", "flat_top", "--sides", "two")["channels"]
        for spectrum, channel in zip(libchar.psd(IMU, segment=4096, window="flat_top", sides="two"), told):
            self.assertEqual(spectrum.frequency_hz.tolist(), channel["frequency_hz"])
            self.assertEqual(spectrum.value.tolist(), channel["value"])
            self.assertEqual(spectrum.ci95.tolist(), channel["ci95"])

    def test_fit(self):
        told = program("fit", IMU)["channels"]
        fits = libchar.fit(IMU)
        self.assertEqual([fit.to_dict() for fit in fits], told)
        self.assertEqual(fits[0].white_noise.value, told[0]["white_noise"]["value"])
        self.assertEqual(list(fits[0].white_noise.ci95), told[0]["white_noise"]["ci95"])
        self.assertIsNone(fits[1].random_walk.value)
        self.assertGreater(fits[1].random_walk.upper95, 0)

    def test_arrays_are_as_good_as_the_file(self):
        log = libchar.read(IMU)
        of_file, of_arrays = libchar.fit(IMU), libchar.fit(log)
        self.assertEqual([f.to_dict() for f in of_file], [f.to_dict() for f in of_arrays])
        named = libchar.fit({"gyro_z": log["gyro_z"]}, log.rate_hz, units=["deg/s"])
        self.assertEqual(named[0].to_dict(), of_file[0].to_dict())
        by_file, by_array = libchar.psd(IMU, segment_s=20), libchar.psd(log, segment_s=20)
        for one, other in zip(by_file, by_array):
            np.testing.assert_array_equal(one.value, other.value)
        for one, other in zip(libchar.allan(IMU), libchar.allan(log)):
            self.assertEqual(one.to_dict(), other.to_dict())

    def test_characterize(self):
        with tempfile.TemporaryDirectory() as folder:
            told = program("characterize", IMU, "-o", "report", folder=folder)
            result = libchar.characterize(IMU)
            document = result.to_dict()
            for key in ("verdict", "summary", "recording", "allan", "spectrum", "fit", "quality", "trace"):
                self.assertEqual(document[key], told[key], key)
            self.assertEqual(result["gyro_z"].fit.to_dict()["white_noise"], told["fit"]["channels"][0]["white_noise"])
            written = result.write(os.path.join(folder, "by-python"))
            self.assertTrue(all(os.path.getsize(path) > 0 for path in written))
            with self.assertRaises(libchar.InputError):
                result.write(os.path.join(folder, "by-python"))
            self.assertIn("</html>", result.html())
            self.assertEqual(len(result.models()), 2)

    def test_simulate(self):
        model = libchar.characterize(IMU, channels=["gyro_z"]).models()[0]
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "gyro_z.sensor.yaml"
            path.write_text(model)
            subprocess.run([PROGRAM, "simulate", str(path), "--devices", "2", "--duration", "60", "--truth",
                            "sine,amplitude=2,frequency_hz=0.1",
                            "--fault", "gyro_z2:bias=0.3@20..40", "--seed", "7", "-o", f"{folder}/log.csv",
                            "--quiet"], check=True, capture_output=True)
            log = libchar.read(f"{folder}/log.csv")
            for source in (model, path):
                made = libchar.simulate(source, duration_s=60, devices=2, truth="sine,amplitude=2,frequency_hz=0.1",
                                        faults=["gyro_z2:bias=0.3@20..40"], seed=7)
                self.assertEqual(made.names, log.names)
                np.testing.assert_array_equal(made.to_array(), log.to_array())

    def test_replay(self):
        model = libchar.characterize(IMU, channels=["gyro_z"]).models()[0]
        made = libchar.simulate(model, duration_s=120, devices=3, truth="sine,amplitude=2,frequency_hz=0.1")
        with tempfile.TemporaryDirectory() as folder:
            libchar.write(f"{folder}/log.f64", made)
            told = program("replay", "log.f64", "--sensors", "gyro*", "--reference", "truth", "--learning", "0..60",
                           "--algorithms",
                           "mean,least-squares", "-o", "out", folder=folder)
            how = dict(sensors=["gyro*"], reference="truth", learning=(0, 60), algorithms=["mean", "least-squares"])
            for source in (f"{folder}/log.f64", made):
                result = libchar.replay(source, **how)
                self.assertEqual([a.name for a in result.algorithms], ["mean", "least-squares"])
                for algorithm, row in zip(result.algorithms, told["algorithms"]):
                    self.assertEqual(algorithm.rmse, row["rmse"])
                    self.assertEqual(algorithm.to_dict()["weights"], row["weights"])
            self.assertEqual(result["mean"].status, "ran")
            self.assertIn("</html>", result.html)
        scene = libchar.replay(ROOT / "fixtures/scenes/rv-2.5-tilt.yaml", allan=False, timing=False)
        self.assertIn("tilt-kalman", [a.name for a in scene.algorithms])


class CopiesNothing(unittest.TestCase):
    def test_in(self):
        table = np.asfortranarray(np.stack([noise(), noise(seed=2)], axis=1))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for source in (noise(), table, {"a": noise()}, libchar.read(IMU), noise()[::1], noise()[100:15000]):
                columns = functions._columns(source, 100.0, None, None, None)
                for name, column in zip(columns["names"], columns["samples"]):
                    original = source[name] if isinstance(source, (dict, libchar.Recording)) else source
                    self.assertTrue(np.shares_memory(column, original))
            libchar.fit(table, 100)

    def test_in_copied_once_and_said(self):
        for source in (noise().astype(np.float32), noise()[::2], np.stack([noise(), noise()], axis=1)[:, 0],
                       np.arange(20000) % 7, noise()[::-1]):
            with self.assertWarns(libchar.CopyWarning):
                copied = libchar.fit(source, 100)
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                self.assertEqual(copied.to_dict(),
                                 libchar.fit(np.ascontiguousarray(source, dtype=float), 100).to_dict())

    def test_memory_of_a_call(self):
        record = noise(4_000_000)

        def peak():
            """Bytes that the process has held at most, by the system."""
            status = pathlib.Path("/proc/self/status").read_text()
            return int(status.split("VmHWM:")[1].split()[0]) * 1024

        libchar.psd(record, 100, segment=4096)
        before = peak()
        libchar.psd(record, 100, segment=4096)
        self.assertLess(peak() - before, record.nbytes / 4)

    def test_out(self):
        log = libchar.read(IMU)
        for array in (*log.samples, libchar.psd(log)[0].value):
            self.assertFalse(array.flags.owndata)  # a vector of the library's, which the array owns
            self.assertTrue(array.flags.c_contiguous and array.flags.writeable)
        gyro = log["gyro_z"]
        mean = float(gyro.mean())
        del log
        gc.collect()
        self.assertEqual(float(gyro.mean()), mean)

    def test_the_lock_is_released(self):
        record, count, stop = noise(2_000_000), [0], threading.Event()

        def work():
            while not stop.is_set():
                count[0] += 1
                time.sleep(0.001)

        thread = threading.Thread(target=work)
        thread.start()
        begin, count[0] = time.perf_counter(), 0
        libchar.fit(record, 100, threads=1)
        counted, seconds = count[0], time.perf_counter() - begin
        stop.set()
        thread.join()
        self.assertGreater(counted, 20 * seconds)  # of a thousand a second; with the lock held: none


class TakesWhatPeopleHave(unittest.TestCase):
    def test_one_array_in_one_curve_out(self):
        x = noise()
        taus, devs, errs, ns = libchar.allan(x, rate=100)
        curve = libchar.allan([x.copy()], rate_hz=100)[0]
        self.assertEqual((taus.tolist(), devs.tolist(), ns.tolist()),
                         (curve.tau_s.tolist(), curve.deviation.tolist(), curve.terms.tolist()))
        self.assertLess(abs(errs[0] / (devs[0] / np.sqrt(2 * curve.edf[0])) - 1), 1e-12)
        self.assertEqual(libchar.fit(x, 100, units="deg/s").unit, "deg/s")
        self.assertEqual(libchar.fit(x, 100, terms=["N", "B"]).to_dict(),
                         libchar.fit(x, 100, terms=["white_noise", "bias_instability"]).to_dict())
        self.assertEqual(libchar.psd(x, 100).segments, libchar.psd({"x": x}, 100)[0].segments)

    def test_a_rate_has_two_names(self):
        x, table = noise(), {"a": noise(seed=4), "b": noise(seed=5)}
        for one, other in (
                (libchar.fit(x, 100), libchar.fit(x, rate=100)), (libchar.psd(x, 100), libchar.psd(x, rate=100)),
                (libchar.characterize(x, 100).channels[0].fit, libchar.characterize(x, rate=100).channels[0].fit)):
            self.assertEqual(one.to_dict(), other.to_dict())
        one, other = libchar.cross_spectrum(table, "a", "b", 100), libchar.cross_spectrum(table, "a", "b", rate=100)
        self.assertEqual(one["coherence"].tolist(), other["coherence"].tolist())
        self.assertEqual(libchar.inspect(x, rate=100)["rate_hz"], 100)
        with tempfile.TemporaryDirectory() as folder:  # of a file it is the program's option
            path = pathlib.Path(folder) / "x.csv"
            path.write_text("a\n" + "\n".join(map(str, x[:500])))
            self.assertEqual(libchar.inspect(path, rate_hz=50)["rate_hz"], 50)
            self.assertEqual(libchar.inspect(path, rate="50Hz")["rate_hz"], 50)

    def test_a_terminal_shows_a_table(self):
        x = noise()
        shown = repr(libchar.fit(x, 100))
        self.assertRegex(shown, r"coefficient +value +low95")
        self.assertRegex(shown, r"white_noise +0\.\d+ +0\.\d+ +0\.\d+ .*detected")
        self.assertLess(max(len(repr(one).splitlines()) for one in (
            libchar.characterize(x, 100), libchar.characterize(x, 100)["c0"], libchar.read(IMU), libchar.psd(x, 100),
            libchar.fit(x, 100), libchar.allan(x, 100))), 20)

    def test_the_longer_axis_is_the_time(self):
        across = np.random.default_rng(3).normal(size=(3, 20000))
        down = np.asfortranarray(across.T)
        self.assertEqual([f.to_dict() for f in libchar.fit(across, 100)], [f.to_dict() for f in libchar.fit(down, 100)])

    def test_data_frames(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("pandas is not installed")
        log = libchar.read(IMU)
        frame = log.to_dataframe()
        self.assertEqual(list(frame.columns), log.names)
        by_rate = libchar.fit(frame, log.rate_hz)
        self.assertEqual([f.white_noise.value for f in by_rate], [f.white_noise.value for f in libchar.fit(log)])
        frame.index = pandas.Timestamp("2026-01-01") + pandas.to_timedelta(np.arange(len(log)) * 20, unit="ms")
        gone = frame.drop(frame.index[1000:1100])
        stamped = libchar.fit(gone, units="deg/s")
        self.assertEqual([f.name for f in stamped], log.names)
        curve = libchar.allan(gone)[0]
        self.assertAlmostEqual(curve.tau_s[0], 0.02)  # rate and gap by the stamps
        gone.columns = ["Gyro Z (deg/s)", "acceleration (left)"]
        for named in (gone, gone.reset_index(drop=True)):
            self.assertEqual([(c.name, c.unit) for c in libchar.allan(named, 50)],
                             [("Gyro Z (deg/s)", "deg/s"), ("acceleration (left)", "")])
        for result in (curve, libchar.psd(log)[0], libchar.characterize(log)):
            self.assertGreater(len(result.to_dataframe()), 1)

    def test_series_and_equal_names(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("pandas is not installed")
        x = noise()
        series = pandas.Series(x, index=pandas.date_range("2026-01-01", periods=len(x), freq="10ms"), name="wz")
        curve = libchar.allan(series)
        self.assertEqual((curve.name, curve.deviation.tolist()), ("wz", libchar.allan(x, 100).deviation.tolist()))
        self.assertEqual(libchar.fit(pandas.Series(x), 100).name, "c0")
        twice = pandas.DataFrame(np.column_stack([x, 2 * x]), columns=["w", "w"])
        self.assertEqual([one.name for one in libchar.allan(twice, 100)], ["w", "w_2"])
        with self.assertRaises(libchar.UsageError) as caught:
            libchar.allan(series[::-1])
        self.assertEqual((caught.exception.where, caught.exception.hint), ("index", "frame.sort_index()"))

    def test_one_name_is_a_list_of_one(self):
        truth = np.sin(np.arange(20000) / 500)
        array = {f"s{k}": truth + noise(seed=k) * (0.1 + 0.1 * k) for k in range(3)} | {"truth": truth}
        one, several = (libchar.replay(array, rate=100, sensors=sensors, reference="truth", algorithms=algorithms,
                                       timing=False)
                        for sensors, algorithms in (("s*", "mean"), (["s*"], ["mean"])))
        self.assertEqual(one.to_dict()["algorithms"], several.to_dict()["algorithms"])
        self.assertEqual(libchar.fit(array, 100, channels="s0")[0].name, "s0")

    def test_what_a_mask_hides_is_missing(self):
        x = noise()
        x[500:520] = 1e6
        hidden = np.ma.array(x, mask=x > 1e5)
        missing = hidden.filled(np.nan)
        want = libchar.fit(missing, 100).to_dict()
        table, tables = np.ma.stack([hidden, hidden * 2], axis=1), np.stack([missing, missing * 2], axis=1)
        for given, same in ((hidden, missing), ({"c0": hidden}, {"c0": missing}), ([hidden, hidden], [missing] * 2),
                            (table, tables), (table.T, tables.T),
                            (libchar.Recording(["c0"], [""], [hidden], 100.0),) * 2):
            got = libchar.fit(given, 100)
            one = got[0] if isinstance(got, list) else got
            self.assertEqual(one.to_dict(), want)
            self.assertEqual(libchar.inspect(given, 100)["channels"][0]["missing"], 20)
            self.assertEqual(libchar.inspect(given, 100)["samples"], libchar.inspect(same, 100)["samples"])
        whole = np.ma.array(np.arange(3000) % 7, mask=False)
        whole[3] = np.ma.masked
        self.assertEqual(libchar.inspect(whole, 100)["channels"][0]["missing"], 1)  # whole numbers have no NaN
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # a mask that hides nothing costs no copy
            self.assertEqual(libchar.fit(np.ma.array(missing), 100).to_dict(), want)

    def test_frames_with_time_zones(self):
        log = libchar.read(IMU)
        naive = np.datetime64("2026-01-01T10:00:00", "ns") + np.arange(len(log)) * np.timedelta64(20, "ms")
        columns = dict(zip(log.names, log.samples))
        want = [curve.to_dict() for curve in libchar.allan(Frame(columns, naive))]
        self.assertAlmostEqual(want[0]["tau_s"][0], 0.02)
        summer = datetime.timezone(datetime.timedelta(hours=2))
        nanoseconds = naive.astype(np.int64)
        stamps = np.array([Stamp.of(ns, summer) for ns in nanoseconds.tolist()])
        plain = np.array([datetime.datetime.fromtimestamp(ns / 1e9, summer) for ns in nanoseconds.tolist()])
        for index in (Zoned(stamps, nanoseconds, "ns"), Zoned(stamps, nanoseconds // 1000, "us"), stamps, plain,
                      np.array([one.replace(tzinfo=None) for one in plain])):
            self.assertEqual([curve.to_dict() for curve in libchar.allan(Frame(columns, index))], want)
        with self.assertRaisesRegex(libchar.UsageError, "name: an array of numbers was expected"):
            libchar.fit(Frame({"name": np.array(["a", "b"])}, naive[:2]))
        naive[50] = np.datetime64("NaT")
        with self.assertRaisesRegex(libchar.UsageError, "1 row without a time, the first is row 50"):
            libchar.fit(Frame(columns, naive))

    def test_findings_travel(self):
        x = noise(40000)
        x[20000:] += 3e4 * np.sin(np.arange(20000) / 700.0)  # handled in its second half
        told = {f["code"] for f in program_of(x, "allan")["channels"][0]["findings"]}
        self.assertTrue(told)
        self.assertEqual({f["code"] for f in libchar.allan(x, 100).findings}, told)
        told = {f["code"] for f in program_of(x, "psd")["channels"][0]["findings"]}
        self.assertEqual({f["code"] for f in libchar.psd(x, 100).findings}, told)
        self.assertTrue(told)


def program_of(x, *words):
    """The document that the program prints of an array at 100 Hz."""
    with tempfile.TemporaryDirectory() as folder:
        libchar.write(pathlib.Path(folder) / "x.f64", x, rate_hz=100)
        return program(*words, "x.f64", folder=folder)


class HasEveryVerb(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.log = libchar.read(IMU)
        cls.result = libchar.characterize(cls.log)

    def test_inspect(self):
        told = program("inspect", IMU)["recordings"][0]
        found = libchar.inspect(IMU)
        self.assertEqual((found["rate_hz"], found["samples"]), (told["rate_hz"], told["samples"]))
        self.assertEqual(libchar.inspect(self.log)["samples"], told["samples"])
        self.assertEqual(libchar.inspect(self.log)["file"], "memory")
        self.assertRegex(repr(found), r"^\S*imu_at_rest.csv: file, (?s:.)*\ngyro_z +deg/s")

    def test_models_and_exports(self):
        model = self.result.models()[0]
        self.assertEqual(model.channel, "gyro_z")
        self.assertEqual(len(libchar.simulate(model, duration_s=10)), 500)
        self.assertIn("<pre>", model._repr_html_())
        for several in (self.result, self.result.models()):
            made = libchar.simulate(several, duration_s=10, seed=3)
            self.assertEqual([*made][:2], ["gyro_z", "accel_z"])
            self.assertEqual((made.file, len(made)), ("simulation", 500))
        self.assertEqual(libchar.simulate([model], duration_s=10)["gyro_z"].tolist(),
                         libchar.simulate(model, duration_s=10)["gyro_z"].tolist())
        text = self.result.export(to="kalibr", axis=["gyro_z=g", "accel_z=a"], anyway=True)
        self.assertIn("gyroscope_noise_density", text)
        self.assertIn("gyro_z", model.export("matlab", axis="gyro_z=g"))
        with self.assertRaises(libchar.UsageError) as caught:
            self.result.export(to="calibr")
        self.assertRegex(caught.exception.code, r"E\d{4}")

    def test_compare_and_lot(self):
        other = libchar.simulate(self.result.models()[0], duration_s=600, seed=5)
        found = libchar.compare(self.result, other, channels=["gyro_z"], labels=["ours", "new"])
        self.assertEqual([side["name"] for side in found["sides"]], ["ours", "new"])
        self.assertTrue(found.verdict)
        self.assertIn("<html", found.html)
        self.assertTrue(repr(found).startswith(found.verdict))
        table = found.to_dataframe()
        self.assertEqual(list(table["sensor"])[:2], ["ours", "new"])
        self.assertIn("white_noise", list(table["term"]))
        model, curve = self.result.models()[0], libchar.allan(other)[0]
        self.assertTrue(libchar.compare(model, curve, channels=["gyro_z"]).verdict)
        logs = [libchar.simulate(self.result.models()[0], duration_s=300, seed=seed) for seed in range(3)]
        found = libchar.lot(*logs, channel="gyro_z")
        self.assertEqual(found["devices"], 3)
        self.assertIn("white_noise", list(found.to_dataframe()["what"]))
        self.assertIn("<table", found._repr_html_())

    def test_pairs_and_arrays(self):
        rng = np.random.default_rng(2)
        truth = np.cumsum(rng.normal(size=20000)) * 1e-3
        array = {f"s{k}": truth + rng.normal(size=20000) * (k + 1) for k in range(4)}
        hat = libchar.cornered_hat(array, 100)
        self.assertAlmostEqual(hat["channels"][2]["deviation"][0] / 3, 1, delta=0.1)
        cross = libchar.cross_spectrum(array, "s0", "s1", 100, segment=1024)
        self.assertEqual(len(cross["coherence"]), 513)
        replay = libchar.replay(array, sensors=["s*"], rate_hz=100, algorithms=["mean", "minque"])
        fused = libchar.fuse(array, replay, 100, algorithm="minque")
        self.assertLess(np.std(fused.samples[0] - truth), 0.95)
        frozen = {**array, "s0": np.where(np.arange(20000) < 10000, array["s0"], array["s0"][10000])}
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "fusion.yaml").write_text(replay.fusion_yaml())
            libchar.write(pathlib.Path(folder) / "log.f64", frozen, rate_hz=100)
            told = program("fuse", "log.f64", "--with", "fusion.yaml", "-o", "out.csv", folder=folder)["findings"]
        self.assertTrue(told)
        self.assertEqual(libchar.fuse(frozen, replay, 100).warnings, [one["sentence"] for one in told])
        self.assertIn("minque", replay.fusion_yaml())

    def test_pictures(self):
        with tempfile.TemporaryDirectory() as folder:
            for drawn, kind in ((self.result, "psd"), (libchar.allan(self.log)[0], "allan"),
                                (libchar.psd(self.log)[0], "psd")):
                figure = drawn.plot(kind=kind, channel="gyro_z")
                self.assertIn("<svg", figure.svg)
                figure.save(pathlib.Path(folder) / "figure.svg", overwrite=True)
                self.assertEqual((pathlib.Path(folder) / "figure.svg").read_text(), figure.svg)
            both = libchar.plot(self.result, libchar.allan(self.log)[0], channel="gyro_z", label=["a", "b"])
            self.assertIn(">b<", both.svg)
            model = self.result.models()[0]
            raw = libchar.plot(self.log, model, channel="gyro_z", label=["log", "model"])
            self.assertIn(">model<", raw.svg)
            self.assertIn("<svg", libchar.plot(noise(), noise(seed=2), rate=100).svg)
            self.assertIn("<svg", self.log.plot(kind="trace", channel="gyro_z").svg)
            self.assertIn("<svg", self.result["gyro_z"].plot(kind="residuals").svg)
            for fit in (libchar.fit(self.log, channels=["gyro_z"])[0], self.result["gyro_z"].fit):
                self.assertIn("N = 0.00402 deg/s·√s", fit.plot().svg)
                self.assertIn("<svg", libchar.plot(fit, self.result, channel="gyro_z").svg)
            self.assertIn("<svg", libchar.plot(IMU, channel="gyro_z").svg)
        self.assertEqual(list(libchar.fit(self.log)[0].to_dataframe()["coefficient"])[0], "white_noise")
        for shown in (self.log, self.result, self.result["gyro_z"], libchar.fit(self.log)[0],
                      libchar.allan(self.log)[0]):
            self.assertRegex(shown._repr_html_(), "<(table|svg)")


class NeverTakesItsProcessDown(unittest.TestCase):
    def test_hostile_arrays(self):
        hostile = [np.array([]), np.array(3.0), noise(100)[::3], np.array([object()]), np.full(1000, np.inf),
                   np.full(1000, np.nan), np.full(1000, 1e308), np.array([1e308, -1e308] * 500), np.zeros(1000),
                   np.broadcast_to(np.float64(1), 2**20), np.zeros((0, 3)), np.zeros((1, 1)), np.array(["a"]),
                   np.zeros(1000, dtype=complex), [], [None], {"a": []}, {}, None, 7, b"/nowhere", object()]
        frozen = noise(1000)
        frozen.flags.writeable = False
        calls = [lambda x: libchar.allan(x, 100), lambda x: libchar.psd(x, 100), lambda x: libchar.fit(x, 100),
                 lambda x: libchar.characterize(x, 100), lambda x: libchar.inspect(x, 100),
                 lambda x: libchar.replay(x, rate_hz=100), lambda x: libchar.cross_spectrum(x, "c0", "c1", 100),
                 lambda x: libchar.cornered_hat(x, 100), lambda x: libchar.compare(x, x, rate_hz=100),
                 lambda x: libchar.lot(x, x, rate_hz=100), lambda x: libchar.fuse(x, "/nowhere", 100)]
        for call in calls:
            for source in [*hostile, frozen]:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    try:
                        call(source)
                    except libchar.Error as error:
                        self.assertRegex(error.code, r"E\d{4}", f"{source!r}: {error}")

    def test_hostile_options(self):
        x = noise(1000)
        for options in ({"threshold": "a"}, {"threads": -1}, {"terms": [3]}, {"remedies": "perhaps"},
                        {"nominal_frequency": []}):
            with self.assertRaises(libchar.UsageError, msg=options):
                libchar.fit(x, 100, **options)
        for segment in (-1, 2**63, 1e9, "a"):
            with self.assertRaises(libchar.Error):
                libchar.psd(x, 100, segment=segment)
        for rate in (-1.0, float("nan"), float("inf"), "fast"):
            with self.assertRaises(libchar.Error, msg=rate):
                libchar.fit(x, rate)


class Refuses(unittest.TestCase):
    def refused(self, kind, call, code):
        with self.assertRaises(kind) as caught:
            call()
        self.assertEqual(caught.exception.code, code, caught.exception)
        self.assertGreater(len(str(caught.exception)), 20)
        return caught.exception

    def test_files(self):
        self.assertIn("/nowhere", self.refused(libchar.InputError, lambda: libchar.read("/nowhere/a.csv"),
                                               "E0101").where)
        with tempfile.TemporaryDirectory() as folder:
            bad = pathlib.Path(folder) / "bad.csv"
            bad.write_text("t,x\n0,1\n1,y\n2,3\n")
            error = self.refused(libchar.InputError, lambda: libchar.read(bad), "E0311")
            self.assertIn("bad.csv:3", error.where)
        self.refused(libchar.UsageError, lambda: libchar.read(IMU, channels=["gyro_x"]), "E0320")
        self.assertIsInstance(error, OSError)

    def test_arguments(self):
        x = noise(1000)
        for call in (lambda: libchar.fit(x), lambda: libchar.fit(np.zeros((2, 2, 2)), 1),
                     lambda: libchar.fit(np.array(["a"]), 1),
                     lambda: libchar.fit(x, 1, names=["a", "b"]), lambda: libchar.fit({"a": x}, 1, channels=["b"]),
                     lambda: libchar.fit(x, 1, units=["a", "b"])):
            self.refused(libchar.UsageError, call, "E0208")
        for call in (lambda: libchar.allan(x, 1, type="odev"), lambda: libchar.psd(x, 1, window="hamm"),
                     lambda: libchar.fit(x, 1, terms=["X"]),
                     lambda: libchar.allan(x, 1, taus="eighth")):
            self.refused(libchar.UsageError, call, "E0202")
        self.assertRaises(ValueError, lambda: libchar.allan(x, 1, type="odev"))
        for call in (lambda: libchar.fit(x, 1, units=3), lambda: libchar.simulate(["a", 3]),
                     lambda: libchar.replay({"a": x}, rate=1, sensors=[1])):
            self.refused(libchar.UsageError, call, "E0208")

    def test_names_of_python(self):
        """Options are keywords, and what is in memory has a name instead of the path of a file that is gone."""
        x = noise(1000)
        error = self.refused(libchar.UsageError, lambda: libchar.allan(x, 1).plot(kind="alan"), "E0202")
        self.assertIn("`kind`", str(error))
        self.assertNotIn("--", str(error))
        for call in (lambda: libchar.replay({"a": x, "b": -x}, rate=1, sensors="q*"),
                     lambda: libchar.cross_spectrum({"a": x}, "a", "q", 1)):
            error = self.refused(libchar.UsageError, call, "E0320")
            self.assertEqual(error.where, "recording")
            self.assertNotIn(tempfile.gettempdir(), str(error))
        with tempfile.TemporaryDirectory() as folder:
            libchar.write(pathlib.Path(folder) / "log.csv", {"a": x}, 50)
            self.assertEqual(libchar.read(pathlib.Path(folder) / "log.csv").rate_hz, 50)

    def test_numbers(self):
        self.refused(libchar.NumericError, lambda: libchar.fit(noise(3), 1), "E0711")
        error = self.refused(libchar.NumericError, lambda: libchar.psd(noise(3), 1), "E0715")
        again = pickle.loads(pickle.dumps(error))
        self.assertEqual((str(again), again.code), (str(error), error.code))

    def test_interrupt(self):
        scene = str(ROOT / "fixtures/scenes/rv-5.1-faults.yaml")
        script = ("import libchar, sys; print('begins', flush=True)\n"
                  f"for _ in range(1000): libchar.replay({scene!r})")
        child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                 text=True)
        child.stdout.readline()
        time.sleep(1.5)
        child.send_signal(signal.SIGINT)
        _, err = child.communicate(timeout=30)
        self.assertIn("KeyboardInterrupt", err)


class IsDescribed(unittest.TestCase):
    def test_results_are_plain(self):
        log = libchar.read(IMU)
        results = [log, *libchar.allan(log), *libchar.psd(log, segment=512), *libchar.fit(log),
                   libchar.characterize(log)]
        for result in results:
            self.assertTrue(dataclasses.is_dataclass(result))
            json.dumps(result.to_dict(), allow_nan=False)

    def test_documentation(self):
        for name in libchar.__all__:
            thing = getattr(libchar, name)
            if name != "build":
                self.assertTrue(inspect.getdoc(thing), name)
        for function in (libchar.read, libchar.allan, libchar.psd, libchar.fit, libchar.characterize,
                         libchar.simulate, libchar.replay):
            self.assertIn(" s", inspect.getdoc(function))
            for argument in inspect.signature(function).parameters.values():
                self.assertIsNot(argument.annotation, argument.empty, f"{function.__name__}({argument.name})")
        package = pathlib.Path(libchar.__file__).parent
        self.assertTrue((package / "py.typed").exists() and (package / "_libchar.pyi").exists())

    def test_stubs(self):
        from libchar import _libchar
        stub = (pathlib.Path(libchar.__file__).parent / "_libchar.pyi").read_text()
        for name in dir(_libchar):
            if not name.startswith("_"):
                self.assertRegex(stub, rf"\b(def|class) {name}\b")

    def test_types(self):
        if subprocess.run([sys.executable, "-m", "mypy", "--version"], capture_output=True).returncode != 0:
            self.skipTest("mypy is not installed")
        with tempfile.TemporaryDirectory() as cache:
            ran = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", cache,
                                  str(pathlib.Path(libchar.__file__).parent)],
                                 capture_output=True, text=True)
        self.assertEqual(ran.returncode, 0, ran.stdout)


if __name__ == "__main__":
    unittest.main(verbosity=0)
