#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "libchar/core/document/document.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/scene/scene_file.hpp"
#include "libchar/simulate/sensor_array.hpp"
#include "tests/replay/scene_text.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

const std::string kSceneHead = "format: scene\nversion: 1\n";
const std::string kRecorded = kSceneHead + "recording: log.csv\nsensors: [a, b, c]\n";
const std::string kSimulated =
    kSceneHead +
    "simulate:\n  rate_hz: 100\n  duration_s: 2.5\n  seed: 18446744073709551615\n  oversampling: 4\n  truth:\n    - "
    "{kind: sine, name: angle, amplitude: 0.3, frequency_hz: 0.5, offset: -1}\n"
    "    - {kind: derivative, of: angle, name: rate}\n    - {kind: points, points: [[0, 1], [2, -3.5]]}\n  "
    "truth_bandwidth_hz: 20\n  temperature: {kind: ramp, slope: 0.1, offset: 20}\n  low_pass_start: zero\nsensors:\n  "
    "- {name: g, model: gyro.sensor.yaml, h: [0, 1, 0], count: 3}\n  - name: p\n    h: [0.1, 0, 1]\n    model: {unit: "
    "g, white_noise: {value: 1e-4, unit: \"g·√s\"}}\n  - {name: perfect, h: [1, 0, 0], model: none}\nfaults:\n  - "
    "{sensor: g2, kind: stuck, from_s: 1}\n  - {sensor: p, kind: scale, value: 1.5, from_s: 0.5, to_s: 1.5}\n";

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += word + "|";
  return out;
}

}  // namespace

TEST_CASE("scene: a recording, its sensors and what is known about it") {
  const test::SceneBench bench;
  const Scene s =
      bench.read(kSceneHead +
                 "name: three monitors\nrecording: {file: log.csv, rate_hz: 99.5, delimiter: \",\", decimal: point, "
                 "header: yes, names: [a, b], units: g, time_column: t, time_unit: s, skip_rows: 0, format: csv, "
                 "from_s: 0.01, to_s: 60}\nsensors:\n  - {name: left, channel: a}\n  - {channel: b, h: 1, model: "
                 "gyro.sensor.yaml}\n  - c\nreference: {channels: [pm25], recording: station.csv, lag_s: "
                 "estimate}\nlearning: [0, 10.5]\nevaluation: [10.5, end]\nfaults:\n  - {sensor: left, kind: bias, "
                 "value: -2, from_s: 3}\nalgorithms: [mean, {name: minque, gamma: 0.999, recovery: 5}]\n");
  CHECK(s.name == "three monitors");
  CHECK(s.recording == bench.path("log.csv"));
  CHECK(*s.reading.rate_hz == 99.5);
  CHECK(s.reading.header == "yes");
  CHECK(joined(s.reading.names) == "a|b|");
  CHECK(*s.reading.from_s == 0.01);
  REQUIRE(s.sensors.size() == 3);
  CHECK(s.sensors[0].name == "left");
  CHECK(s.sensors[0].channel == "a");
  CHECK(s.sensors[1].name == "b");
  CHECK(*s.sensors[1].model->noise[0].value == Approx(0.3 * M_PI / 180 / std::sqrt(2.0)).epsilon(1e-14));
  CHECK(s.sensors[2].channel == "c");
  CHECK_FALSE(s.sensors[2].model);
  CHECK(s.reference->estimate_lag);
  CHECK(*s.reference->recording == bench.path("station.csv"));
  CHECK(s.learning->to_s == 10.5);
  CHECK(std::isinf(s.evaluation->to_s));
  CHECK(s.faults[0].sensor == 0);
  CHECK(s.faults[0].value == -2);
  CHECK(std::isinf(s.faults[0].to_s));
  CHECK(s.algorithms[1].name == "minque");
  CHECK(s.algorithms[1].options[0] == std::pair<std::string, double>("gamma", 0.999));
  CHECK(s.algorithms[1].line == 14);
  CHECK(s.files.size() == 3);
  CHECK(s.warnings.empty());
}

TEST_CASE("scene: a simulation is ready to run") {
  const test::SceneBench bench;
  const Scene s = bench.read(kSimulated);
  REQUIRE(s.simulate);
  const ArraySimulation& a = *s.simulate;
  CHECK(a.samples == 250);
  CHECK(a.seed == std::numeric_limits<std::uint64_t>::max());
  CHECK(joined(a.truth_names) == "angle|rate|truth3|");
  CHECK(a.truth[1].of == 0);
  CHECK(a.truth[2].points[1] == std::pair<double, double>(2, -3.5));
  CHECK(a.low_pass_starts_at_zero);
  REQUIRE(a.sensors.size() == 5);
  CHECK(a.sensors[2].name == "g3");
  CHECK(a.sensors[4].h == std::vector<double>{1, 0, 0});
  CHECK(a.faults.size() == 2);
  CHECK(a.faults[0].sensor == 1);
  CHECK(joined(s.reference->channels) == "angle|rate|truth3|");  // what was simulated is known
  ArraySimulator simulator(a);
  const auto columns = simulator.next(1000);
  REQUIRE(columns.size() == 9);
  CHECK(columns[0].size() == 250);
}

TEST_CASE("scene: a truth signal out of a recording") {
  const test::SceneBench bench;
  const auto text = [](const std::string& rate, const std::string& signal) {
    return kSceneHead + "simulate: {rate_hz: " + rate + ", samples: 6, truth: " + signal +
           "}\nsensors: [{name: a, model: none}]\n";
  };
  const Scene s = bench.read(text("100", "{kind: recording, file: motion.csv, channel: angle}"));
  CHECK(s.simulate->truth[0].samples == std::vector<double>{5, 6, 7, 8});
  CHECK(s.warnings.find("recorded_signal_short") != nullptr);
  ArraySimulator simulator(*s.simulate);
  CHECK(simulator.next(10)[0][5] == 8);
  CHECK_THAT(bench.refusal(text("50", "{kind: recording, file: motion.csv, channel: angle}")),
             Contains("E0742: simulate.truth.file: is a recording at 100 Hz, and the simulation runs at 50 Hz"));
  CHECK_THAT(bench.refusal(text("100", "{kind: recording, file: motion.csv}")), Contains("holds 2 channels"));
  CHECK_THAT(bench.refusal(text("100", "{kind: recording, channel: x}")), Contains("file is missing"));
}

TEST_CASE("scene: what is written reads back to the same scene") {
  const test::SceneBench bench;
  for (const std::string& text :
       {kRecorded, kSimulated,
        kRecorded + "reference: {channels: [truth, b], mean: true, lag_s: -0.1}\nsimulated: {seed: 7, faults: "
                    "[{sensor: b, kind: noise, value: 0.3}]}\nalgorithms: [{name: takens, neighbours: 12}, mean]\n",
        kSceneHead +
            "recording: {file: log.csv, delimiter: tab, encoding: latin1, time_column: none, rate_hz: 1e12, "
            "overflow_as_missing: true, skip_repeated_header: true}\nsensors: [{name: a, h: [1, 0]}, {name: b, h: "
            "[-0.3333333333333333, 5e-324]}]\nreference: [b, c]\nlearning: [0.30000000000000004, end]\n"}) {
    const Scene s = bench.read(text);
    const std::string written = scene_yaml(s);
    const Scene again = bench.read(written, "again.yaml");
    INFO(written);
    CHECK(scene_yaml(again) == written);
    CHECK(again.recording == s.recording);
    REQUIRE(again.sensors.size() == s.sensors.size());
    for (std::size_t i = 0; i < s.sensors.size(); ++i) {
      CHECK(again.sensors[i].name == s.sensors[i].name);
      CHECK(again.sensors[i].channel == s.sensors[i].channel);
      CHECK(again.sensors[i].h == s.sensors[i].h);
      REQUIRE(again.sensors[i].model.has_value() == s.sensors[i].model.has_value());
      if (s.sensors[i].model) CHECK(model_yaml(*again.sensors[i].model) == model_yaml(*s.sensors[i].model));
    }
    REQUIRE(again.faults.size() == s.faults.size());
    for (std::size_t i = 0; i < s.faults.size(); ++i) CHECK(again.faults[i].to_s == s.faults[i].to_s);
    CHECK(again.learning.has_value() == s.learning.has_value());
    CHECK(again.simulated.has_value() == s.simulated.has_value());
    // The same tree as JSON is the same scene.
    const std::string json = dump_json(as_json(parse_yaml_document(written, "s")));
    CHECK(scene_yaml(bench.read(json, "again.json")) == written);
    if (!s.simulate) continue;
    ArraySimulator one(*s.simulate), two(*again.simulate);
    const auto x = one.next(1000), y = two.next(1000);
    for (std::size_t c = 0; c < x.size(); ++c)
      for (std::size_t k = 0; k < x[c].size(); ++k)
        if (!(x[c][k] == y[c][k])) FAIL("channel " << c << " sample " << k);
  }
}

TEST_CASE("scene: hostile texts are names like any other") {
  const test::SceneBench bench;
  const std::vector<std::string> hostile = {"a\"b\\c",
                                            "tab\there",
                                            "two\nlines\r",
                                            "\x1B]0;x\a",
                                            "é漢😀",
                                            "\u202Eevil\u2066",
                                            "- x",
                                            "null",
                                            "1",
                                            "true",
                                            "a: b # c",
                                            " blank ",
                                            "{x: [",
                                            "*alias",
                                            "!tag",
                                            "~",
                                            "%",
                                            "\x7F\u0085\uFEFF",
                                            "</script><b>",
                                            "$(touch PWN)",
                                            "none",
                                            "<<"};
  Scene s = bench.read(kRecorded);
  s.sensors.clear();
  for (const std::string& name : hostile) s.sensors.push_back({name, name + "x", {}, {1}});
  s.sensors[0].model = SensorModel{};
  s.sensors[0].model->unit = hostile[3];
  s.sensors[0].model->remarks = hostile;
  s.name = hostile[3];
  s.reference.emplace().channels = {hostile[5]};
  std::vector<std::string> columns;
  for (const std::string& name : hostile) columns.push_back(name + "x");
  s.reading.names = columns;
  for (const std::string& name : hostile) s.algorithms.push_back({name, {{name + "k", 0.1}}, 0, 0});
  s.faults.push_back({21, FaultKind::bias, 1, 0, 1});
  const std::string weird = "log \"$(x)\" *.csv";
  bench.put(weird, "a\n1\n");
  s.recording = bench.path(weird);
  s.file = bench.path("h.yaml");
  const std::string written = scene_yaml(s);
  for (const char c : written) CHECK((static_cast<unsigned char>(c) >= 0x20 || c == '\n'));
  const Scene again = bench.read(written, "h.yaml");
  CHECK(again.recording == s.recording);
  CHECK(again.name == s.name);
  CHECK(again.reading.names == columns);
  CHECK(again.reference->channels[0] == hostile[5]);
  CHECK(again.faults[0].sensor == 21);
  CHECK(again.sensors[0].model->remarks == hostile);
  for (std::size_t i = 0; i < hostile.size(); ++i) {
    CHECK(again.sensors[i].name == hostile[i]);
    CHECK(again.sensors[i].channel == hostile[i] + "x");
    CHECK(again.algorithms[i].name == hostile[i]);
    CHECK(again.algorithms[i].options[0].first == hostile[i] + "k");
  }
  CHECK(again.warnings.find("control_characters") != nullptr);
  s.recording = bench.path("\xFF.csv");
  CHECK_THROWS_WITH(scene_yaml(s), Contains("E0745"));
}

TEST_CASE("scene: refusals name place, key and what would be right") {
  const test::SceneBench bench;
  const auto recorded = [&](const std::string& body, const std::string& begin) {
    INFO(body);
    CHECK_THAT(bench.refusal(kRecorded + body), Catch::StartsWith("s.yaml:" + begin));
  };
  recorded("simulate: {rate_hz: 1, samples: 2}\n", "5:11: error E0735: simulate: a scene has");
  recorded("learning: [3, 3]\n", "5:11: error E0740: learning: expected 0 <= from < to");
  recorded("learning: [-1, 3]\n", "5:11: error E0740");
  recorded("align: {learn: rest}\n", "5:16: error E0748: align.learn: the scene has no such window");
  recorded("align: {learn: [3, 1]}\n", "5:16: error E0740");
  recorded("align: {terms: [phase]}\n", "5:16: error E0748: align.terms: phase is not a term");
  recorded("align: {by: reference}\n", "5:13: error E0748: align.by: the scene has no reference");
  recorded("align: {interpolation: linear}\n", "5:24: error");
  recorded("learning: 3\n", "5:11: error E0541");
  recorded("evaluation: [1, 2, 3]\n", "5:13: error E0740");
  recorded("evaluation: [end, 2]\n", "5:14: error E0740");
  recorded("faults: [{sensor: bb, kind: bias, value: 1}]\n",
           "5:19: error E0738: faults[0].sensor: bb is not a sensor of this scene; got \"bb\"; hint: did you mean b?");
  recorded("faults: [{sensor: b, kind: bais, value: 1}]\n", "5:28: error E0544");
  recorded("faults: [{sensor: b, kind: bias}]\n", "5:10: error E0542: faults[0].value is missing");
  recorded("faults: [{sensor: b, kind: stuck, value: 1}]\n",
           "5:42: error E0739: faults[0].value: a fault of kind stuck has no value");
  recorded("faults: [{sensor: b, kind: dropout, from_s: 3, to_s: 2}]\n", "5:54: error E0740: faults[0].to_s");
  recorded("faults: [{sensor: b, kind: noise, value: -1}]\n", "5:42: error E0543");
  recorded("algorithms: []\n", "5:13: error E0736: algorithms");
  recorded("algorithms: [{gamma: 1}]\n", "5:14: error E0737: algorithms[0]");
  recorded("algorithms: [{name: m, gamma: x}]\n", "5:31: error E0744: algorithms[0].gamma");
  recorded("reference: []\n", "5:12: error E0736: reference");
  recorded("reference: [truth, truth]\n", "5:12: error E0737: reference");
  recorded("reference: [truth, a]\n",
           "4:11: error E0741: sensors[0]: the row h of sensor a has 1 weight, and there are 2 true inputs");
  recorded("reference: {channels: a, lag_s: guess}\n", "5:33: error E0545: reference.lag_s");
  recorded("reference: {chanels: a}\n", "5:13: error E0540: unknown key in reference");
  recorded("simulated: {sed: 1}\n", "5:13: error E0540");
  const auto sensors = [&](const std::string& list, const std::string& begin) {
    INFO(list);
    CHECK_THAT(bench.refusal(kSceneHead + "recording: log.csv\nsensors: " + list + "\n"),
               Catch::StartsWith("s.yaml:" + begin));
  };
  sensors("[]", "4:10: error E0736: sensors");
  sensors("a", "4:10: error E0541");
  sensors("[{h: 1}]", "4:11: error E0542: sensors[0].name is missing");
  sensors("[a, {name: b, hh: 1}]", "4:24: error E0540: unknown key in sensors[1]");
  sensors("[a, {name: b, h: [1, 2]}]", "4:21: error E0741: sensors[1].name");
  sensors("[{name: a, h: []}]", "4:24: error E0741: sensors[0].h");
  sensors("[{name: a, h: 0}]", "4:18: error E0741");
  sensors("[{name: a, count: 2}]", "4:28: error E0545: sensors[0].count");
  sensors("[{name: \"\"}]", "4:18: error E0737");
  sensors("[{name: \"x\\0y\"}]", "4:18: error E0737");
  sensors("[a, ~]", "4:14: error E0737");
  sensors("[{name: a, model: {white_noise: -1, density: two-sided}}]",
          "4:42: error E0543: sensors[0].model.white_noise");
  const auto simulated = [&](const std::string& inside, const std::string& begin) {
    INFO(inside);
    CHECK_THAT(
        bench.refusal(kSceneHead + "sensors: [{name: a, model: none}]\nsimulate: {rate_hz: 10, " + inside + "}\n"),
        Catch::StartsWith("s.yaml:" + begin));
  };
  simulated("samples: 0", "4:34: error E0545: simulate.samples");
  simulated("samples: 1e3", "4:34: error E0541: simulate.samples");
  simulated("samples: 18446744073709551615", "4:34: error E0545: simulate.samples: more than");
  simulated("duration_s: 1e300", "4:37: error E0545");
  simulated("seed: 1", "4:11: error E0735: simulate.duration_s");
  simulated("samples: 1, duration_s: 1", "4:34: error E0735");
  simulated("samples: 9, oversampling: 0", "4:51: error E0545");
  simulated("samples: 9, truth: []", "4:44: error E0736");
  simulated("samples: 9, truth: {kind: sin}", "4:51: error E0544: simulate.truth.kind: expected one of");
  simulated("samples: 9, truth: sin", "4:44: error E0544");
  simulated("samples: 9, truth: {kind: constant, amplitude: 2}",
            "4:61: error E0739: simulate.truth.amplitude: is a key of sine, chirp, uniform, sine_of, cosine_of, and "
            "this signal is of kind constant; got \"amplitude\"; hint: constant reads value");
  simulated("samples: 9, truth: {kind: sine, amplitud: 2}",
            "4:57: error E0540: unknown key in simulate.truth; got \"amplitud\"; hint: did you mean amplitude?");
  simulated("samples: 9, truth: [{kind: derivative, of: truth2}, {kind: sine}]",
            "4:68: error E0738: simulate.truth[0].of");
  simulated("samples: 9, truth: [{kind: sine, name: x}, {kind: sine_of, of: xx}]",
            "4:88: error E0738: simulate.truth[1].of: xx is not a signal before");
  simulated("samples: 9, truth: [{kind: sine, name: x}, {kind: zero, name: x}]",
            "4:87: error E0737: simulate.truth[1].name");
  simulated("samples: 9, truth: {kind: points, points: [[0, 1], [0, 2]]}", "4:67: error E0545");
  simulated("samples: 9, truth: {kind: points, points: []}", "4:67: error E0736");
  simulated("samples: 9, truth: {kind: zero, name: a}", "4:11: error E0554: two channels would be called a");
  CHECK_THAT(bench.refusal(kSceneHead + "sensors: [a]\nsimulate: {rate_hz: 10, samples: 9}\n"),
             Contains("E0554") || Contains("E0743"));
  CHECK_THAT(bench.refusal(kSceneHead + "sensors: [{name: a}]\nsimulate: {rate_hz: 10, samples: 9}\n"),
             Contains("E0743: sensors[0].model: a simulated sensor needs a model"));
  CHECK_THAT(bench.refusal(kSceneHead +
                           "simulate: {rate_hz: 10, samples: 9}\nsensors: [{name: a, model: none}]\nreference: trut\n"),
             Contains("E0738: reference: trut is not a truth signal") && Contains("did you mean truth?"));
  CHECK_THAT(bench.refusal("format: sensor-model\nversion: 1\n"), Contains("E0546"));
}

TEST_CASE("scene: outputs never overwrite what a scene reads, nor one another") {
  const test::SceneBench bench;
  const Scene s = bench.read(kSceneHead +
                             "recording: log.csv\nsensors: [{name: a, model: gyro.sensor.yaml}]\n"
                             "reference: {channels: pm25, recording: station.csv}\n");
  const auto refusal = [&](const std::vector<std::string>& outputs) -> std::string {
    try {
      refuse_scene_outputs(s, outputs);
    } catch (const Error& error) {
      CHECK(error.problem().kind == ErrorKind::output);
      return error.what();
    }
    return "";
  };
  for (const char* input : {"log.csv", "gyro.sensor.yaml", "station.csv", "s.yaml"})
    CHECK_THAT(refusal({bench.path(input)}), Contains("E0504"));
  CHECK(refusal({bench.path("r.html"), bench.path("r.json")}).empty());
  CHECK(refusal({bench.path("R.html"), bench.path("r.html")}).empty());
  CHECK_THAT(refusal({bench.path("r.html"), bench.path("./x/../r.html")}), Contains("E0746"));
  bench.put("one", "");
  std::filesystem::create_hard_link(bench.path("one"), bench.path("two"));
  CHECK_THAT(refusal({bench.path("one"), bench.path("two")}), Contains("E0746"));
  std::filesystem::create_symlink("log.csv", bench.path("three"));
  CHECK_THAT(refusal({bench.path("three")}), Contains("E0504"));
}

TEST_CASE("a tilt, a rest, a scale and a noise are read and written", "[scene]") {
  const test::SceneBench bench;
  const Scene scene = bench.read(
      "format: scene\nversion: 1\nrecording: log.csv\nsensors: [{name: g, channel: a}, {name: x, channel: b, scale: "
      "-1}, {name: z, channel: c, noise: 0.5}]\nreference: d\n"
      "tilt: {gyroscope: g, accelerometer_x: x, accelerometer_z: z}\nrest: [0, 2]\nfault_free_s: 3\n");
  REQUIRE(scene.tilt);
  CHECK(scene.tilt->accelerometer_z == 2);
  CHECK(scene.sensors[1].scale == -1);
  CHECK(scene.sensors[2].noise == 0.5);
  CHECK(scene.rest->to_s == 2);
  CHECK(scene.fault_free_s == 3);
  CHECK(scene_yaml(parse_scene(scene_yaml(scene), scene.file)) == scene_yaml(scene));
}
