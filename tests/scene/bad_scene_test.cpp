// Every class of fixtures/known/badinputs/{yaml,json,manifest} as a scene: verdict as EXPECT.tsv says, with
// the place, code and words that it must name.
#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <functional>
#include <map>
#include <sstream>

#include "libchar/scene/scene_file.hpp"
#include "tests/replay/scene_text.hpp"

using namespace libchar;
using Catch::Contains;
using Catch::StartsWith;

namespace {

const std::string kHead = "format: scene\nversion: 1\n";
const std::string kBody = "recording: log.csv\nsensors: [a]\n";
const std::string kJson = R"("format":"scene","version":1,"recording":"log.csv","sensors":["a"])";

struct Case {
  std::string text;
  std::string begin;  ///< of the refusal behind FILE; empty: it is read
  std::string words;  ///< anywhere in it
};

std::string with_rate(const std::string& rate) {
  return kHead + "recording:\n  file: log.csv\n  rate_hz: " + rate + "\nsensors: [a]\n";
}

std::string bomb() {
  std::string text = kHead + "a: &a [x,x,x,x,x,x,x,x,x,x]\n";
  for (char c = 'b'; c <= 'i'; ++c) {
    const std::string before(1, static_cast<char>(c - 1));
    text += std::string(1, c) + ": &" + c + " [";
    for (int i = 0; i < 10; ++i) text += (i > 0 ? ",*" : "*") + before;
    text += "]\n";
  }
  return text;
}

std::string deep_indent() {
  std::string text = kHead;
  for (std::size_t i = 0; i < 600; ++i) text += std::string(i, ' ') + "a:\n";
  return text;
}

const std::map<std::string, Case>& yaml_cases() {
  static const std::map<std::string, Case> cases = {
      {"000_control", {kHead + kBody, "", ""}},
      {"001_bomb", {bomb(), ":3:", "E0521: anchors"}},
      {"002_cycle", {"&x\n- *x\n", ":1:1: error E0521", ""}},
      {"003_alias", {kHead + "name: &n x\nrecording: *n\n", ":3:7: error E0521", ""}},
      {"004_deep_flow", {std::string(10000, '['), ":1:1: error E0521", ""}},
      {"005_deep_indent", {deep_indent(), ":", "64 levels"}},
      {"006_dup_key", {kHead + "version: 2\n" + kBody, ":3:1: error E0521", "repeated"}},
      {"007_octal", {with_rate("010"), ":5:12: error E0541", "leading zeros"}},
      {"008_norway", {kHead + "name: no\n" + kBody, "", ""}},
      {"009_sexagesimal", {with_rate("1:30"), ":5:12: error E0541", ""}},
      {"010_inf", {with_rate(".inf"), ":5:12: error E0541", "finite"}},
      {"011_nan", {with_rate(".nan"), ":5:12: error E0541", "finite"}},
      {"012_1e400", {with_rate("1e400"), ":5:12: error E0541", ""}},
      {"013_neg_sigma",
       {kHead + kBody + "faults:\n  - {sensor: a, kind: noise, value: -1e-3}\n", ":6:37: error E0543",
        "faults[0].value"}},
      {"014_comma_decimal", {with_rate("1,5"), ":5:12: error E0541", "point"}},
      {"015_unit_suffix", {with_rate("100 Hz"), ":5:12: error E0541", "write the number alone: it is in Hz"}},
      {"016_unknown_key", {kHead + kBody + "algoritms: [mean]\n", ":5:1: error E0540", "algorithms?"}},
      {"017_version_99", {"format: scene\nversion: 99\n", ":2:10: error E0546", "newer"}},
      {"018_no_version", {"format: scene\n" + kBody, ":1:1: error E0546", "version is missing"}},
      {"019_tab_indent", {kHead + "sensors:\n\t- a\n", ":4:1: error E0522", "tab"}},
      {"020_two_docs", {kHead + kBody + "---\nversion: 1\n", "", "second document"}},
      {"021_tag", {kHead + "name: !!python/object/apply:os.system [\"echo PWN\"]\n", ":3:7: error E0521", "tags"}},
      {"022_nul", {kHead + "name: x" + std::string(1, '\0') + "\n", ":3:8: error E0522", "zero"}},
      {"023_bom", {"\xEF\xBB\xBF" + kHead + kBody, "", ""}},
      {"024_empty", {"", ":1:1: error E0522", ""}},
      {"025_scalar", {"hello", ":1:1: error E0546", ""}},
      {"026_key_1100", {kHead + std::string(1100, 'k') + ": 1\n", ":3:", ""}},
      {"027_truncated", {kHead + "recording: {file: log.c", ":3:", ""}},
      {"028_xss", {kHead + "name: \"</script><script>alert(1)</script>\"\n" + kBody, "", ""}},
      {"029_ansi", {kHead + "name: \"\\e]0;x\\a\"\n" + kBody, "", ""}},
      {"030_merge", {kHead + "simulate: {<<: {samples: 1}}\n", ":3:12: error E0521", "merge"}},
  };
  return cases;
}

const std::map<std::string, Case>& json_cases() {
  static const std::map<std::string, Case> cases = {
      {"000_control", {"{" + kJson + "}", "", ""}},
      {"001_deep_100k", {std::string(100000, '[') + std::string(100000, ']'), ":", "64 levels"}},
      {"002_dup", {"{" + kJson + ",\"version\":2}", ":1:", "repeated"}},
      {"003_1e400", {"{" + kJson + ",\"learning\":[0,1e400]}", ":1:", "out of range"}},
      {"004_NaN", {"{" + kJson + ",\"learning\":[0,NaN]}", ":1:", "E0601"}},
      {"005_u64", {"{" + kJson + ",\"seed\":18446744073709551616}", ":1:", "64 bits"}},
      {"006_bad_utf8", {"{" + kJson + ",\"name\":\"\xFF\xFE\"}", ":1:", "UTF-8"}},
      {"007_lone_surrogate", {"{" + kJson + ",\"name\":\"\\ud800\"}", ":1:", "E0601"}},
      {"008_trailing", {"{" + kJson + "} x", ":1:", "E0601"}},
      {"009_comment", {"{" + kJson + "} // c", ":1:", "E0601"}},
      {"010_trunc", {"{\"version\":", ":1:", "E0601"}},
      {"011_bom", {"\xEF\xBB\xBF{" + kJson + "}", "", ""}},
      {"012_float_version", {R"({"format":"scene","version":1.5})", ":1:29: error E0546", "version: 1"}},
      {"013_null",
       {R"({"format":"scene","version":1,"recording":"log.csv","sensors":null})", ":1:63: error E0542",
        "sensors is missing"}},
  };
  return cases;
}

// What stands behind `recording:` in line 3, column 12.
struct Named {
  std::string name, code, words;
};

const std::map<std::string, Named>& manifest_cases() {
  static const std::map<std::string, Named> cases = {
      {"000_control", {"data/none.csv", "E0732", "there is no file FOLDER/data/none.csv"}},
      {"001_traversal", {"../../../../etc/passwd", "E0731", "`allow_outside`"}},
      {"002_absolute", {"/etc/passwd", "E0731", "`allow_outside`"}},
      {"003_dotdot_inside", {"data/../data/none.csv", "E0732", "FOLDER/data/../data/none.csv"}},
      {"004_symlink_out", {"link_to_etc", "E0731", "to /etc/passwd"}},
      {"005_dir", {".", "E0733", "is a folder"}},
      {"006_self", {"s.yaml", "E0734", "itself"}},
      {"007_nul", {"a\\0b", "E0730", "zero byte"}},
      {"008_long", {std::string(5000, 'a'), "E0730", "5000 bytes"}},
      {"009_fifo", {"fifo", "E0733", "not a regular file"}},
      {"010_dev_zero", {"/dev/zero", "E0731", "`allow_outside`"}},
      {"011_proc", {"/proc/self/mem", "E0731", "`allow_outside`"}},
      {"012_url", {"http://x/y.csv", "E0732", "network"}},
      {"013_tilde", {"~/x.csv", "E0732", "~ is not expanded"}},
      {"014_glob", {"*.csv", "E0732", "patterns are not expanded"}},
      {"015_cmd", {"$(touch PWN)", "E0732", "no command is run"}},
      {"016_dash", {"-rf", "E0732", "not as an option"}},
  };
  return cases;
}

struct ManifestBench : test::SceneBench {
  ManifestBench() {
    namespace fs = std::filesystem;
    fs::create_directory(folder / "data");
    put("data/a.csv", "t,a\n0,1\n1,1\n");
    fs::create_symlink("/etc/passwd", folder / "link_to_etc");
    fs::create_directory_symlink("/etc", folder / "etc");
    fs::create_symlink("data/a.csv", folder / "link_inside");
    fs::create_symlink("loop", folder / "loop");
    REQUIRE(::mkfifo(path("fifo").c_str(), 0600) == 0);
  }
  std::string filled(std::string words) const {
    const std::size_t at = words.find("FOLDER");
    return at == std::string::npos ? words : words.replace(at, 6, folder.path().string());
  }
};

void check_case(const test::SceneBench& bench, const std::string& file, const Case& c) {
  INFO(file << ": " << c.text.substr(0, 300));
  const std::string said = bench.refusal(c.text, file);
  if (c.begin.empty() && c.words.empty()) {
    CHECK(said.empty());
    return;
  }
  CHECK_THAT(said, StartsWith(file + c.begin));
  CHECK_THAT(said, Contains(c.words));
  CHECK(said.find('\n') == std::string::npos);
}

std::map<std::string, std::string> expected(const std::string& folder) {
  std::map<std::string, std::string> rows;
  std::istringstream in(test::slurp(test::known("badinputs/EXPECT.tsv")));
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(folder + "/", 0) != 0) continue;
    const std::size_t tab = line.find('\t'), dot = line.rfind('.', tab);
    rows[line.substr(folder.size() + 1, dot - folder.size() - 1)] =
        line.substr(tab + 1, line.find('\t', tab + 1) - tab - 1);
  }
  return rows;
}

}  // namespace

TEST_CASE("bad scenes: YAML") {
  const test::SceneBench bench;
  for (const auto& [name, c] : yaml_cases()) check_case(bench, "s.yaml", c);
  CHECK(bench.read(yaml_cases().at("008_norway").text).name == "no");
  const Scene ansi = bench.read(yaml_cases().at("029_ansi").text);
  CHECK(ansi.name == "\x1B]0;x\a");
  CHECK_THAT(ansi.warnings.find("control_characters")->where.rows.at(0), Contains("s.yaml:3:7"));
}

TEST_CASE("bad scenes: JSON") {
  const test::SceneBench bench;
  for (const auto& [name, c] : json_cases()) check_case(bench, "s.json", c);
}

TEST_CASE("bad scenes: names of files") {
  const ManifestBench bench;
  for (const auto& [name, c] : manifest_cases()) {
    INFO(name);
    const std::string said = bench.refusal(kHead + "recording: \"" + c.name + "\"\nsensors: [a]\n");
    CHECK_THAT(said, StartsWith("s.yaml:3:12: error " + c.code + ": recording: "));
    CHECK_THAT(said, Contains(bench.filled(c.words)));
    // The same wherever a scene names a file.
    for (const std::string& text :
         {"sensors: [a]\nrecording: {file: \"" + c.name + "\"}\n",
          "sensors: [{name: a, model: \"" + c.name + "\"}]\nrecording: log.csv\n",
          "sensors: [a]\nrecording: log.csv\nreference: {channels: [a], recording: \"" + c.name + "\"}\n",
          "sensors: [{name: a, model: none}]\nsimulate: {rate_hz: 1, samples: 1, truth: {kind: recording, file: \"" +
              c.name + "\"}}\n"})
      CHECK_THAT(bench.refusal(kHead + text), Contains(": error " + c.code + ": "));
  }
  CHECK_FALSE(std::filesystem::exists("PWN"));
  const auto refusal = [&](const std::string& name, bool outside) {
    return bench.refusal(kHead + "recording: \"" + name + "\"\nsensors: [a]\n", "s.yaml", outside);
  };
  for (const char* inside : {"data/a.csv", "data/../data/a.csv", "./log.csv", "link_inside"})
    CHECK(refusal(inside, false).empty());
  CHECK_THAT(refusal("etc/passwd", false), Contains("E0731"));
  CHECK_THAT(refusal("data/../../x", false), Contains("E0731"));
  CHECK_THAT(refusal("loop", false), Contains("E0732"));
  CHECK_THAT(refusal("log.csv/x", false), Contains("E0732"));
  CHECK_THAT(refusal("", false), Contains("E0730"));
  CHECK_THAT(refusal("-", false), Contains("standard input"));
  CHECK_THAT(refusal(std::string(256, 'a'), false), Contains("E0730"));
  // Allowed outside, the other rules stand.
  CHECK(refusal("/etc/passwd", true).empty());
  CHECK(refusal("etc/passwd", true).empty());
  CHECK_THAT(refusal("/dev/zero", true), Contains("E0733"));
  CHECK_THAT(refusal("/proc/self/mem", true), Contains("E0733"));
  CHECK_THAT(refusal("fifo", true), Contains("E0733"));
  CHECK_THAT(refusal(bench.path("s.yaml"), true), Contains("E0734"));
  // A scene named without a folder lies in the present one.
  CHECK_THROWS_WITH(parse_scene(kHead + "recording: ../x.csv\nsensors: [a]\n", "s.yaml"),
                    StartsWith("s.yaml:3:12: error E0731"));
}

TEST_CASE("bad scenes: names of sensors and outputs") {
  const test::SceneBench bench;
  CHECK_THAT(
      bench.refusal(kHead + "recording: log.csv\nsensors:\n  - {name: a, channel: a}\n  - {name: a, channel: b}\n"),
      StartsWith("s.yaml:6:12: error E0737: sensors[1].name: two sensors have the name a"));
  const Scene clash =
      bench.read(kHead + "recording: log.csv\nsensors: [{name: R, channel: a}, {name: r, channel: b}]\n");
  CHECK_THAT(clash.warnings.find("case_clash")->where.rows.at(0), Contains("s.yaml:4:41"));
  const std::string html = bench.path("r.html");
  CHECK_THROWS_WITH(refuse_scene_outputs(clash, {html, html}), Contains("E0746"));
  CHECK_THROWS_WITH(refuse_scene_outputs(clash, {bench.path("log.csv")}), Contains("E0504"));
  std::string many = kHead + "recording: log.csv\nsensors:\n";
  for (int i = 0; i < 20000; ++i) many += "  - {name: s" + std::to_string(i) + ", channel: x}\n";
  CHECK_THAT(bench.refusal(many), Contains("E0736: sensors: 20000 sensors are more than the 10000"));
  CHECK_THAT(bench.refusal(kHead + "simulate: {rate_hz: 1, samples: 1}\nsensors: [{name: a, model: none, count: "
                                   "10000}, {name: b, model: none}]\n"),
             Contains("E0736"));
  CHECK_THAT(
      bench.refusal(
          kHead +
          "simulate: {rate_hz: 1, samples: 1}\nsensors: [{name: a, model: none, count: 18446744073709551615}]\n"),
      Contains("E0736"));
}

TEST_CASE("bad scenes: every class has its case, with the verdict of EXPECT.tsv") {
  for (const auto& [folder, cases] : {std::pair{"yaml", &yaml_cases()}, std::pair{"json", &json_cases()}}) {
    const auto rows = expected(folder);
    CHECK(rows.size() == cases->size());
    for (const auto& [name, verdict] : rows) {
      INFO(folder << "/" << name);
      REQUIRE(cases->count(name) == 1);
      const Case& c = cases->at(name);
      CHECK((c.begin.empty() && c.words.empty()) == (verdict != "error"));
    }
  }
  // 017 to 021 are the case before this one.
  const auto rows = expected("manifest");
  CHECK(rows.size() == manifest_cases().size() + 5);
  for (const auto& [name, verdict] : rows)
    if (name < "017") CHECK(manifest_cases().count(name) == 1);
}
