"""Reads what `sensorchar model --to` writes with parsers that are not ours: PyYAML (YAML 1.1, as Kalibr), a
check of YAML 1.2 numbers, python's XML, JSON and Python parsers, xmllint and OpenCV."""
import ast
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

import yaml

PROGRAM = sys.argv.pop(1)
GYRO, ACCEL = ("rad/s", 1.6968e-4, 1.9393e-5), ("m/s^2", 2.0e-3, 3.0e-3)
# Rounded so that 1e-05, 2e-05, 1 and 2 are the shortest texts of the values.
ROUND_GYRO, ROUND_ACCEL = ("rad/s", 1e-5, 2e-5), ("m/s^2", 1.0, 2.0)
YAML_11_FLOAT = re.compile(r"[-+]?[0-9][0-9_]*\.[0-9_]*([eE][-+][0-9]+)?$")
YAML_12_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?$")

OPENCV_READER = r"""
#include <iostream>
#include <opencv2/core.hpp>
static void show(const cv::FileNode& map, const std::string& front) {
  for (cv::FileNode node : map) {
    if (node.isMap()) { show(node, front + node.name() + "."); continue; }
    std::cout << front << node.name() << " = ";
    if (node.isReal()) std::cout << "real " << static_cast<double>(node) << "\n";
    else if (node.isInt()) std::cout << "int " << static_cast<int>(node) << "\n";
    else if (node.isString()) std::cout << "text " << static_cast<std::string>(node) << "\n";
    else std::cout << "list " << node.size() << " " << node[0].size() << "\n";
  }
}
int main(int, char** words) {
  const cv::FileStorage file(words[1], cv::FileStorage::READ);
  show(file.root(), "");
}
"""


def model(channel, unit, q, k, status="given"):
    walk = f"{{value: {k:.9e}, status: given}}" if status == "given" else f"{{upper95: {k:.9e}, status: not_detected}}"
    return f"""format: sensor-model
version: 1
channel: {channel}
unit: {unit}
rate_hz: 200
density: two-sided
white_noise: {q:.9e}
random_walk: {walk}
recording: {{file: imu.csv, sha256: "{'5e' * 32}", duration_s: 7200}}
"""


class Device:
    """Six model files in a folder, and the program run on them."""

    def __init__(self, gyro=GYRO, accel=ACCEL, status="given"):
        self.folder = tempfile.TemporaryDirectory()
        self.files = []
        for name, (unit, q, k) in (("gyr", gyro), ("acc", accel)):
            for axis in "xyz":
                path = pathlib.Path(self.folder.name) / f"{name}_{axis}.yaml"
                path.write_text(model(f"{name}_{axis}", unit, q, k, status))
                self.files.append(str(path))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.folder.cleanup()

    def export(self, target, *options):
        run = subprocess.run([PROGRAM, "model", *self.files, "--to", target, *options], capture_output=True, text=True)
        assert run.returncode == 0, run.stderr
        assert "5e" * 32 in run.stdout and "sensorchar" in run.stdout, target
        return run.stdout


def opencv_body(text):
    """OpenCV demands the first line, and PyYAML fails on it."""
    first, body = text.split("\n", 1)
    assert first == "%YAML:1.0", first
    try:
        yaml.safe_load(text)
    except yaml.YAMLError:
        return body
    raise AssertionError("PyYAML reads the OpenCV header: the two dialects are one now?")


def scalars(node):
    """The plain scalars of a YAML tree, before any reader has given them a type."""
    if isinstance(node, yaml.ScalarNode):
        if node.style is None:
            yield node.value
    elif isinstance(node, yaml.SequenceNode):
        for child in node.value:
            yield from scalars(child)
    elif isinstance(node, yaml.MappingNode):
        for _, child in node.value:
            yield from scalars(child)


class Yaml(unittest.TestCase):
    PLAIN, OPENCV = ("kalibr", "euroc", "ros"), ("openvins", "orbslam3", "vins")

    def body(self, device, target):
        text = device.export(target)
        return opencv_body(text) if target in self.OPENCV else text

    def test_numbers_are_numbers(self):
        for gyro, accel in ((GYRO, ACCEL), (ROUND_GYRO, ROUND_ACCEL)):
            with Device(gyro, accel) as device:
                for target in self.PLAIN + self.OPENCV:
                    numbers = 0
                    for scalar in scalars(yaml.compose(self.body(device, target))):
                        if not re.match(r"[-+.]?[0-9]", scalar):
                            continue
                        if scalar == "4" and target == "euroc":
                            continue  # rows, cols
                        self.assertRegex(scalar, YAML_11_FLOAT, target)
                        self.assertRegex(scalar, YAML_12_FLOAT, target)
                        numbers += 1
                    self.assertGreaterEqual(numbers, 4, target)

    def test_pyyaml_would_take_other_spellings_for_text(self):
        self.assertIsInstance(yaml.safe_load("a: 1e-05")["a"], str)
        self.assertIsInstance(yaml.safe_load("a: 2e-3")["a"], str)
        self.assertIsInstance(yaml.safe_load("a: 1.0e-05")["a"], float)

    def test_kalibr(self):
        with Device() as device:
            text = device.export("kalibr", "--topic", "/cam/imu")
        data = yaml.safe_load(text)
        self.assertEqual(data, {"rostopic": "/cam/imu", "update_rate": 200.0, "accelerometer_noise_density": 2.0e-3,
                                "accelerometer_random_walk": 3.0e-3, "gyroscope_noise_density": 1.6968e-4,
                                "gyroscope_random_walk": 1.9393e-5})
        for key, value in data.items():  # its own checks
            self.assertIsInstance(value, str if key == "rostopic" else float)
            self.assertTrue(key == "rostopic" or value > 0)
        with Device(ROUND_GYRO, ROUND_ACCEL, "not_detected") as device:
            text = device.export("kalibr")
        self.assertEqual(yaml.safe_load(text)["gyroscope_random_walk"], 2e-5)
        self.assertIn("upper 95 % limit", text)

    def test_euroc(self):
        with Device() as device:
            data = yaml.safe_load(device.export("euroc"))
        self.assertEqual((data["sensor_type"], data["rate_hz"], data["T_BS"]["rows"], len(data["T_BS"]["data"])),
                         ("imu", 200.0, 4, 16))
        self.assertEqual(data["gyroscope_random_walk"], 1.9393e-5)

    def test_openvins(self):
        with Device() as device:
            imu = yaml.safe_load(self.body(device, "openvins"))["imu0"]
        self.assertEqual(imu["model"], "kalibr")
        self.assertEqual(imu["accelerometer_random_walk"], 3e-3)
        for key, size in (("T_i_b", 4), ("Tw", 3), ("R_IMUtoGYRO", 3), ("Ta", 3), ("R_IMUtoACC", 3), ("Tg", 3)):
            identity = [[float(r == c and key != "Tg") for c in range(size)] for r in range(size)]
            self.assertEqual(imu[key], identity)

    def test_orbslam3_and_vins(self):
        with Device() as device:
            orb = yaml.safe_load(self.body(device, "orbslam3"))
            old = yaml.safe_load(opencv_body(device.export("orbslam3", "--older")))
            vins = yaml.safe_load(opencv_body(device.export("vins", "--gravity", "9.81007")))
        self.assertEqual((orb["File.version"], orb["IMU.Frequency"], orb["IMU.NoiseGyro"]), ("1.0", 200.0, 1.6968e-4))
        self.assertIsInstance(orb["IMU.Frequency"], float)
        self.assertIsInstance(old["IMU.Frequency"], int)
        for key, value in {"acc_n": 4.0e-2, "gyr_n": 3.3936e-3, "acc_w": 4.2426e-2, "gyr_w": 2.7426e-4,
                           "g_norm": 9.81007}.items():
            self.assertAlmostEqual(vins[key] / value, 1, delta=2e-5)

    def test_ros(self):
        with Device() as device:
            device.files = device.files[:3]
            data = yaml.safe_load(device.export("ros"))
        self.assertEqual([len(value) for value in data.values()], [9, 9, 9])
        self.assertEqual(data["linear_acceleration_covariance"][0], -1.0)
        self.assertAlmostEqual(data["angular_velocity_covariance"][4] / (1.6968e-4 ** 2 * 200), 1, delta=1e-8)

    def test_opencv(self):
        """OpenCV's own FileStorage, compiled here: what the three programs read with."""
        with tempfile.TemporaryDirectory() as folder, Device(ROUND_GYRO, ROUND_ACCEL) as device:
            reader = str(pathlib.Path(folder) / "reader")
            built = subprocess.run(["c++", "-std=c++17", "-I/usr/include/opencv4", "-x", "c++", "-", "-lopencv_core",
                                    "-o", reader],
                                   input=OPENCV_READER, text=True, capture_output=True)
            if "opencv2/core.hpp" in built.stderr:
                self.skipTest("libopencv-core-dev is not installed")
            self.assertEqual(built.returncode, 0, built.stderr)
            seen = {}
            for target in self.OPENCV:
                path = pathlib.Path(folder) / (target + ".yaml")
                path.write_text(device.export(target))
                run = subprocess.run([reader, str(path)], text=True, capture_output=True, check=True)
                seen[target] = dict(line.split(" = ") for line in run.stdout.splitlines())
        self.assertEqual(seen["orbslam3"]["IMU.NoiseGyro"], "real 1e-05")
        self.assertEqual(seen["orbslam3"]["IMU.Frequency"], "real 200")
        self.assertEqual(seen["orbslam3"]["File.version"], "text 1.0")
        self.assertEqual(seen["vins"]["gyr_n"], "real 0.0002")
        self.assertEqual(seen["openvins"]["imu0.gyroscope_random_walk"], "real 2e-05")
        self.assertEqual(seen["openvins"]["imu0.T_i_b"], "list 4 4")
        self.assertEqual(seen["openvins"]["imu0.model"], "text kalibr")


class Xml(unittest.TestCase):
    def test_sdf(self):
        with Device() as device:
            text = device.export("sdf")
        root = ElementTree.fromstring(text)
        self.assertEqual(root.find("sensor").attrib["type"], "imu")
        self.assertEqual(float(root.find("sensor/update_rate").text), 200)
        for vector, stddev, walk in (("angular_velocity", 2.3996e-3, 1.9393e-5),
                                     ("linear_acceleration", 2e-3 * math.sqrt(200), 3e-3)):
            for axis in "xyz":
                noise = root.find(f"sensor/imu/{vector}/{axis}/noise")
                self.assertEqual(noise.attrib, {"type": "gaussian"})
                self.assertAlmostEqual(float(noise.find("stddev").text) / stddev, 1, delta=1e-4)
                self.assertEqual(float(noise.find("dynamic_bias_stddev").text), walk)
                self.assertEqual(float(noise.find("dynamic_bias_correlation_time").text), 72000)
                self.assertEqual([float(noise.find(key).text) for key in ("mean", "bias_mean", "bias_stddev")],
                                 [0, 0, 0])

    def test_rotors(self):
        with Device() as device:
            root = ElementTree.fromstring(device.export("rotors"))
        values = {child.tag: float(child.text) for child in root}
        self.assertEqual(values["gyroscopeBiasRandomWalk"], 1.9393e-5)
        self.assertEqual(values["accelerometerNoiseDensity"], 2e-3)
        self.assertEqual(len(values), 9)

    def test_xmllint(self):
        if not shutil.which("xmllint"):
            self.skipTest("xmllint is not installed")
        with Device(status="not_detected") as device:
            for target in ("sdf", "rotors"):
                run = subprocess.run(["xmllint", "--noout", "--nonet", "-"], input=device.export(target), text=True,
                                     capture_output=True)
                self.assertEqual((run.returncode, run.stderr), (0, ""))


class Others(unittest.TestCase):
    def test_json(self):
        with Device() as device:
            airsim = json.loads(device.export("airsim"))["DefaultSensors"]["Imu"]
            basalt = json.loads(device.export("basalt"))
            generic = json.loads(device.export("json"))
        self.assertAlmostEqual(airsim["AngularRandomWalk"], 0.58332, delta=1e-5)
        self.assertAlmostEqual(airsim["VelocityRandomWalk"], 0.20394, delta=1e-5)
        self.assertAlmostEqual(airsim["GyroBiasStability"], 89.445, delta=1e-3)
        self.assertEqual(next(iter(basalt)), "value0")
        self.assertEqual(basalt["value0"]["gyro_noise_std"], [1.6968e-4] * 3)
        self.assertEqual([m["channel"] for m in generic["models"]],
                         ["gyr_x", "gyr_y", "gyr_z", "acc_x", "acc_y", "acc_z"])

    def test_gnss_ins_sim(self):
        with Device() as device:
            tree = ast.parse(device.export("gnss-ins-sim"))
        dictionary = next(node.value for node in tree.body if isinstance(node, ast.Assign))
        values = {key.value: [ast.literal_eval(item) for item in call.args[0].elts]
                  for key, call in zip(dictionary.keys, dictionary.values)}
        # of its constructor
        required = {"gyro_b", "gyro_b_stability", "gyro_arw", "accel_b", "accel_b_stability", "accel_vrw"}
        self.assertTrue(required <= set(values))
        self.assertTrue(all(len(v) == 3 for v in values.values()))
        self.assertAlmostEqual(values["gyro_arw"][0], 1.6968e-4 * 60 * 180 / math.pi, delta=1e-9)
        self.assertAlmostEqual(values["accel_b_stability"][2], 3e-3 * math.sqrt(72000 / 2), delta=1e-9)

    def test_pegasus(self):
        with Device() as device:
            tree = ast.parse(device.export("pegasus"))
        config = ast.literal_eval(next(node.value for node in tree.body if isinstance(node, ast.Assign)))
        self.assertEqual(config["update_rate"], 200)
        for sensor, (_, q, k) in (("gyroscope", GYRO), ("accelerometer", ACCEL)):
            self.assertAlmostEqual(config[sensor]["noise_density"], q)
            self.assertAlmostEqual(config[sensor]["random_walk"], k)
            self.assertEqual(config[sensor]["bias_correlation_time"], 72000)

    def test_kf_gins(self):
        with Device() as device:
            noise = yaml.safe_load(device.export("kf-gins"))["imunoise"]
        # all that loadConfig asks for
        self.assertEqual(set(noise), {"arw", "vrw", "gbstd", "abstd", "gsstd", "asstd", "corrtime"})
        self.assertEqual(noise["corrtime"], 20)  # h: ten records
        steady = math.sqrt(20 * 3600 / 2)
        for i in range(3):
            self.assertAlmostEqual(noise["arw"][i] * math.pi / 180 / 60 / GYRO[1], 1, delta=1e-8)
            self.assertAlmostEqual(noise["vrw"][i] / 60 / ACCEL[1], 1, delta=1e-8)
            self.assertAlmostEqual(noise["gbstd"][i] * math.pi / 180 / 3600 / (GYRO[2] * steady), 1, delta=1e-8)
            self.assertAlmostEqual(noise["abstd"][i] * 1e-5 / (ACCEL[2] * steady), 1, delta=1e-8)

    def test_navego(self):
        with Device() as device:
            text = device.export("navego")
        values = {key: [float(v) for v in row.split()]
                  for key, row in re.findall(r"^imu\.(\w+) = \[(.*?)\];", text, re.M)}
        self.assertEqual(set(values), {"arw", "vrw", "arrw", "vrrw", "gb_sta", "gb_dyn", "gb_corr", "ab_sta",
                                       "ab_dyn", "ab_corr"})
        self.assertAlmostEqual(values["ab_dyn"][1] * 1e-3 * 9.80665 / (ACCEL[2] * math.sqrt(36000)), 1, delta=1e-8)

    def test_gtsam_compiles_as_a_snippet(self):
        with Device() as device:
            text = device.export("gtsam", "--gravity", "9.81")
        source = ("namespace gtsam { struct M {} I_3x3; M operator*(M m, double) "
                  "{ return m; }\nstruct PreintegrationCombinedParams { M gyroscopeCovariance, "
                  "accelerometerCovariance, biasOmegaCovariance, biasAccCovariance;\nstatic "
                  "PreintegrationCombinedParams* MakeSharedU(double) "
                  "{ static PreintegrationCombinedParams p; return &p; } }; }\nint main() {\n" + text + "}\n")
        compiler = shutil.which("c++")
        if not compiler:
            self.skipTest("no compiler")
        run = subprocess.run([compiler, "-std=c++17", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-x", "c++",
                              "-"], input=source, text=True, capture_output=True)
        self.assertEqual(run.returncode, 0, run.stderr)
        values = dict(re.findall(r"p->(\w+) = gtsam::I_3x3 \* ([-+0-9.e]+);", text))
        self.assertAlmostEqual(float(values["gyroscopeCovariance"]) / 2.8791e-8, 1, delta=1e-4)
        self.assertEqual(float(values["biasAccCovariance"]), 9.0e-6)

    def test_matlab_and_px4(self):
        with Device() as device:
            matlab = device.export("matlab").replace(" ...\n", " ")
            px4 = device.export("px4")
        code = [line for line in matlab.splitlines() if not line.startswith("%")]
        for line in code:
            self.assertRegex(line, r"^(gyro|accel) = (gyro|accel)params\('NoiseType', 'double-sided'(, +'\w+', "
                                   r"[-+0-9.e]+)+\);$")
        self.assertEqual(len(code), 2)
        lines = [line for line in px4.splitlines() if not line.startswith("#")]
        self.assertEqual(len(lines), 8)
        for line in lines:
            self.assertRegex(line, r"^param set (EKF2|EK3)_[A-Z_]{1,11} [0-9.]+(e-[0-9]+)?$")
            self.assertLessEqual(len(line.split()[2]), 16)  # the autopilots' limit


if __name__ == "__main__":
    unittest.main()
