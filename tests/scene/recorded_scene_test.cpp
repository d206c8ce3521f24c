// A scene from a recording and a few words, and patterns in a scene's own list of sensors.

#include <catch2/catch.hpp>

#include "libchar/scene/scene_file.hpp"
#include "tests/replay/scene_text.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

const std::string kPatternHead = "format: scene\nversion: 1\nrecording: array.csv\n";

struct ArrayBench : test::SceneBench {
  ArrayBench() {
    put("array.csv",
        "t[s],g10[deg/s],g2[deg/s],g1[deg/s],T[degC],ref[deg/s],word\n"
        "0,1,2,3,20,2,x\n0.01,1,2,3,20,2,y\n");
    recording.file = path("array.csv");
  }
  std::string refused(const SensorRecording& asked) const {
    try {
      scene_from_recording(asked);
    } catch (const Error& error) {
      CHECK(error.problem().kind == ErrorKind::usage);
      return error.what();
    }
    return "";
  }
  std::vector<std::string> sensors(const Scene& scene) const {
    std::vector<std::string> out;
    for (const SceneSensor& sensor : scene.sensors) out.push_back(sensor.name + "=" + sensor.channel);
    return out;
  }
  SensorRecording recording;
};

using SensorNames = std::vector<std::string>;

}  // namespace

TEST_CASE("scene from a recording: the same as its own YAML read again") {
  ArrayBench bench;
  bench.recording.sensors = {"g*"};
  bench.recording.reference = {"ref"};
  bench.recording.models = {{"g2", bench.path("gyro.sensor.yaml")}};
  bench.recording.scene_file = bench.path("s.yaml");
  bench.recording.reading.from_s = 0.005;
  const Scene scene = scene_from_recording(bench.recording);
  CHECK(bench.sensors(scene) == SensorNames{"g1=g1", "g2=g2", "g10=g10"});
  CHECK(scene.name == "array");
  CHECK(scene.reference->channels == SensorNames{"ref"});
  CHECK(scene.sensors[1].model->unit == "rad/s");
  const Scene again = bench.read(scene_yaml(scene));
  CHECK(scene_yaml(again) == scene_yaml(scene));
  CHECK(again.recording == scene.recording);
  CHECK(again.files.size() == 1);
  CHECK(again.reading.from_s == 0.005);
}

TEST_CASE("scene from a recording: what cannot be one is refused in a sentence") {
  ArrayBench bench;
  SensorRecording& asked = bench.recording;
  CHECK_THAT(bench.refused(asked), Contains("E0749") && Contains("which channels") && Contains("g10, g2, g1, T, ref"));
  asked.sensors = {"x*"};
  CHECK_THAT(bench.refused(asked), Contains("E0320") && Contains("g10, g2, g1"));
  asked.sensors = {"g1", "T"};
  CHECK_THAT(bench.refused(asked), Contains("E0749") && Contains("g1 is in deg/s, and T in degC"));
  asked.reading.units = {"1"};
  CHECK(bench.refused(asked).empty());  // whoever says so means it
  asked.reading.units.clear();
  asked.sensors = {"g1", "ref"};
  asked.reference = {"ref"};
  CHECK_THAT(bench.refused(asked), Contains("E0749") && Contains("one of the sensors"));
  asked.sensors = {"g1", "g1"};
  CHECK_THAT(bench.refused(asked), Contains("E0749") && Contains("named twice"));
  asked.sensors = {"g1"};
  asked.reference = {"T"};
  CHECK_THAT(bench.refused(asked), Contains("degC"));
  asked.reference.clear();
  asked.models = {{"g2", bench.path("gyro.sensor.yaml")}};
  CHECK_THAT(bench.refused(asked), Contains("no sensor of this name"));
  asked.models.clear();
  asked.models_folder = bench.folder.path().string();
  CHECK_THAT(bench.refused(asked), Contains("no model of sensor g1") && Contains("g1.sensor.yaml"));
  asked.models_folder.clear();
  asked.reference_file = bench.path("station.csv");
  CHECK_THAT(bench.refused(asked), Contains("which of its channels"));
  asked.file = "-";
  CHECK_THAT(bench.refused(asked), Contains("read once only"));
}

TEST_CASE("scene from a recording: reference in a log of its own, models of a folder") {
  ArrayBench bench;
  bench.put("g1.sensor.yaml", "format: sensor-model\nversion: 1\nunit: deg/s\n");
  bench.recording.sensors = {"g1"};
  bench.recording.models_folder = bench.folder.path().string();
  bench.recording.reference = {"pm*"};
  bench.recording.reference_file = bench.path("station.csv");
  const Scene scene = scene_from_recording(bench.recording);
  CHECK(scene.sensors[0].model->unit == "deg/s");
  CHECK(scene.reference->channels == SensorNames{"pm25"});
  CHECK(*scene.reference->recording == bench.path("station.csv"));
  CHECK(scene.files.size() == 3);
}

TEST_CASE("scene: a pattern in the list of sensors") {
  const ArrayBench bench;
  const auto names = [&](const std::string& list) { return bench.sensors(bench.read(kPatternHead + list)); };
  CHECK(names("sensors: ['g*']\n") == SensorNames{"g1=g1", "g2=g2", "g10=g10"});
  CHECK(names("sensors: [{channel: 'g?', scale: 2}, g10]\n") == SensorNames{"g1=g1", "g2=g2", "g10=g10"});
  CHECK(names("sensors: [g2, '*']\nreference: {channels: [ref, T], mean: true}\n") ==
        SensorNames{"g2=g2", "g1=g1", "g10=g10"});
  CHECK(names("sensors: [{name: left, channel: '?10'}]\n") == SensorNames{"left=g10"});
  const Scene scene = bench.read(kPatternHead + "sensors: [{channel: 'g?', scale: 2}, g10]\n");
  CHECK(scene.sensors[1].scale == 2);
  CHECK(scene.sensors[2].scale == 1);
}

TEST_CASE("scene: patterns that mean nothing, or one name for many") {
  const ArrayBench bench;
  CHECK_THAT(bench.refusal(kPatternHead + "sensors: [g1, 'x*']\n"),
             Contains("s.yaml:4:15: error E0738: sensors[1]: no channel matches this pattern in ") &&
                 Contains("it has g10, g2, g1, T, ref"));
  CHECK_THAT(bench.refusal(kPatternHead + "sensors: [{name: g, channel: 'g*'}]\n"),
             Contains("E0737") && Contains("one name for 3 channels"));
  CHECK_THAT(bench.refusal(kPatternHead + "sensors: ['re*', g1]\nreference: ref\n"),
             Contains("E0738") && Contains("named elsewhere"));
}

TEST_CASE("what is meant as a scene: by its suffix, or its head") {
  const test::SceneBench bench;
  bench.put("s.txt", "# a scene\nformat: scene\nversion: 1\n");
  CHECK(looks_like_scene("nowhere.yaml"));
  CHECK(looks_like_scene("nowhere.JSON"));
  CHECK(looks_like_scene(bench.path("s.txt")));
  CHECK_FALSE(looks_like_scene(bench.path("log.csv")));
  CHECK_FALSE(looks_like_scene("nowhere.csv"));
  CHECK_FALSE(looks_like_scene("-"));
}

TEST_CASE("a scene's recording may be a folder of CSV files beside it, and its types of messages a folder") {
  const test::SceneBench bench;
  const std::filesystem::path folder = bench.path("phone");
  std::filesystem::create_directories(folder / "msg");
  bench.put("phone/Gyroscope.csv", "time,x\n0,1\n0.01,2\n0.02,1\n");
  const std::string head = "format: scene\nversion: 1\n";
  const Scene scene = bench.read(head + "recording: {file: phone, topic: Gyroscope, msg: phone/msg}\nsensors: [x]\n");
  CHECK(scene.recording == folder.string());
  CHECK(scene.reading.unsaid.msg == (folder / "msg").string());
  CHECK_THAT(scene_yaml(scene), Contains("msg: \"phone/msg\""));
  CHECK_THAT(bench.refusal(head + "recording: phone/msg\nsensors: [x]\n"), Contains("E0733"));
  CHECK_THAT(bench.refusal(head + "recording: {file: phone, msg: ../elsewhere}\nsensors: [x]\n"), Contains("E0731"));
  CHECK_THAT(bench.refusal(head + "recording: log.csv\nsensors: [{name: a, model: phone}]\n"), Contains("E0733"));
  std::filesystem::create_symlink("/etc/hostname", folder / "Link.csv");
  CHECK_THAT(bench.refusal(head + "recording: phone\nsensors: [x]\n"), Contains("E0731"));
}

TEST_CASE("scene from a recording: the sources of a long table with one column are the sensors") {
  ArrayBench bench;
  const auto table = [&](const std::string& columns, const std::vector<std::string>& ids, const std::string& values) {
    std::string text = "t [s]," + columns + "\n";
    for (const char* t : {"0", "0.1", "0.2", "0.3"})
      for (const std::string& id : ids) text += t + ("," + id) + values + "\n";
    bench.put("long.csv", text);
    SensorRecording asked;
    asked.file = bench.path("long.csv");
    asked.reading.kinds.group_by = "id";
    return asked;
  };
  CHECK(bench.sensors(scene_from_recording(table("id,x", {"0", "1", "2"}, ",1.5"))) ==
        SensorNames{"0=0", "1=1", "2=2"});
  SensorRecording asked = table("id,x", {"imu1", "imu2", "imu10"}, ",1.5");
  asked.reference = {"imu10"};
  CHECK(bench.sensors(scene_from_recording(asked)) == SensorNames{"imu1=imu1", "imu2=imu2"});
  // Sources of unlike names may measure unlike quantities, as columns do.
  CHECK_THAT(bench.refused(table("id,x", {"temp", "hum"}, ",1.5")), Contains("which channels measure one quantity"));
  CHECK_THAT(bench.refused(table("id,x,y", {"a", "b"}, ",1,2")), Contains("a_x, a_y, b_x, b_y") && Contains("'*_x'"));
}
