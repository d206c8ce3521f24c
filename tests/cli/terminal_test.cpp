// What the program shows: help, widths, colour, quiet, hints.

#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libchar/core/text/text_table.hpp"
#include "tests/support/places.hpp"
#include "tests/support/run.hpp"

using Catch::Contains;

namespace {

struct TerminalBench {
  test::TemporaryFolder folder;
  std::string log = test::fixture("imu_at_rest.csv").string();
  std::string path(const std::string& name) const { return (folder / name).string(); }
  test::Ran in(std::size_t columns, const std::vector<std::string>& words) const {
    test::RunOptions options;
    options.environment = {"COLUMNS=" + std::to_string(columns)};
    return test::run(words, options);
  }
};

std::size_t widest_line(const std::string& text) {
  std::istringstream lines(text);
  std::size_t most = 0;
  for (std::string line; std::getline(lines, line);)
    if (line.find("/tmp/") == std::string::npos && line.find("/fixtures/") == std::string::npos &&
        line.find("sensorchar ") == std::string::npos)  // paths and commands are not broken
      most = std::max(most, libchar::width_of(line));
  return most;
}

nlohmann::json usage() { return nlohmann::json::parse(test::run({"--generate", "json"}).out); }

}  // namespace

TEST_CASE("help VERB is VERB --help, has every option and argument, and two examples") {
  for (const auto& verb : usage()["verbs"]) {
    const std::string name = verb["name"];
    INFO(name);
    const auto help = test::run({"help", name});
    CHECK(help.code == 0);
    CHECK(help.err.empty());
    CHECK(help.out == test::run({name, "--help"}).out);
    CHECK(help.out == test::run({name, "-h"}).out);
    for (const auto& option : verb["options"]) {
      for (const auto& flag : option["flags"]) CHECK_THAT(help.out, Contains(flag.get<std::string>()));
      CHECK_FALSE(option["help"].get<std::string>().empty());
    }
    for (const auto& argument : verb["arguments"]) CHECK_THAT(help.out, Contains(argument["value"].get<std::string>()));
    CHECK(verb["examples"].size() >= 2);
    for (const auto& example : verb["examples"])
      CHECK_THAT(help.out, Contains("\n    " + example["command"].get<std::string>() + "\n"));
    CHECK_THAT(test::run({"help"}).out, Contains("\n  " + name + " "));
  }
  CHECK(test::run({"help"}).out == test::run({"--help"}).out);
}

TEST_CASE("help of a verb that is none, and artefacts that are none, are refused with the nearest") {
  const std::vector<std::pair<std::vector<std::string>, std::string>> slips = {
      {{"help", "alan"}, "did you mean allan?"},
      {{"help", "allan", "psd"}, "one argument too many"},
      {{"--generate", "mann"}, "did you mean man?"},
      {{"--generate"}, "expected one of man, bash, zsh, fish, json, schema"},
      {{"--generate", "man", "alan"}, "did you mean allan?"},
      {{"--generate", "bash", "allan"}, "one argument too many"},
      {{"--generate", "schema", "alan"}, "did you mean allan?"},
      {{"inspect", "a.csv", "--color", "yes"}, "expected one of auto, always, never"}};
  for (const auto& [words, says] : slips) {
    const auto ran = test::run(words);
    INFO(ran.err);
    CHECK(ran.code == 2);
    CHECK(ran.out.empty());
    CHECK_THAT(ran.err, Contains(says));
  }
}

TEST_CASE("help and tables fit the width that is there") {
  const TerminalBench bench;
  REQUIRE(test::run({"characterize", bench.log, "-o", bench.path("report")}).code == 0);
  const std::vector<std::vector<std::string>> commands = {
      {"inspect", bench.log},
      {"fit", bench.log},
      {"characterize", bench.log, "-o", bench.path("report"), "--force"},
      {"model", bench.path("report/gyro_z.sensor.yaml")},
      {"replay", test::fixture("scenes/rv-2.5-tilt.yaml").string(), "-o", bench.path("tilt"), "--force"},
      {"help", "characterize"},
      {"help"}};
  for (const auto& words : commands)
    for (const std::size_t columns : {72, 80, 100, 132}) {
      INFO(words[0] << " in " << columns);
      const auto ran = bench.in(columns, words);
      REQUIRE(ran.code == 0);
      CHECK(widest_line(ran.out) <= columns);
    }
}

TEST_CASE("a table cut to a width says the same numbers") {
  const TerminalBench bench;
  const auto wide = bench.in(400, {"fit", bench.log});
  const auto narrow = bench.in(72, {"fit", bench.log});
  std::istringstream words(wide.out);
  for (std::string word; words >> word;) {
    INFO(word);
    CHECK(narrow.out.find(word) != std::string::npos);
  }
  CHECK(wide.out == test::run({"fit", bench.log}).out);  // a pipe has any width
}

TEST_CASE("quiet: nothing but errors where the results stand in files") {
  const TerminalBench bench;
  const std::vector<std::vector<std::string>> commands = {
      {"characterize", bench.log, "-o", bench.path("report")},
      {"simulate", bench.path("report/gyro_z.sensor.yaml"), "--duration", "60", "-o", bench.path("s.csv")},
      {"convert", bench.log, "-o", bench.path("log.npy")},
      {"replay", test::fixture("scenes/rv-2.5-tilt.yaml").string(), "-o", bench.path("tilt")}};
  for (auto words : commands) {
    words.emplace_back("--quiet");
    const auto ran = test::run(words);
    INFO(words[0]);
    CHECK(ran.code == 0);
    CHECK(ran.out.empty());
    CHECK(ran.err.empty());
  }
  CHECK_FALSE(test::run({"fit", bench.log, "--quiet"}).out.empty());  // it stands nowhere else
  CHECK_FALSE(test::run({"convert", bench.log, "-o", bench.path("log.npy"), "--quiet"}).err.empty());
}

TEST_CASE("colour: where it is asked for, never in a pipe, and the text is the same") {
  const TerminalBench bench;
  const auto plain = test::run({"fit", bench.log});
  CHECK(plain.out.find('\x1b') == std::string::npos);
  CHECK(test::run({"fit", bench.log, "--color", "never"}).out == plain.out);
  test::RunOptions none;
  none.environment = {"NO_COLOR=1"};
  CHECK(test::run({"fit", bench.log}, none).out == plain.out);
  std::string coloured = test::run({"fit", bench.log, "--color", "always"}).out;
  CHECK_THAT(coloured, Contains("\x1b[32mdetected\x1b[0m") && Contains("\x1b[2mnot detected\x1b[0m"));
  for (std::size_t at = coloured.find('\x1b'); at != std::string::npos; at = coloured.find('\x1b'))
    coloured.erase(at, coloured.find('m', at) + 1 - at);
  CHECK(coloured == plain.out);
  CHECK_THAT(test::run({"inspect", "/nowhere", "--color", "always"}).err, Contains("\x1b[31merror\x1b[0m"));
  const auto document = test::run({"fit", bench.log, "--json", "--color", "always"}).out;
  CHECK(document.find('\x1b') == std::string::npos);
}

TEST_CASE("hints name flags of the verb only") {
  const auto all = usage()["verbs"];
  const TerminalBench bench;
  std::ofstream(bench.path("bad.csv")) << "t,x\n0,1\n1,2\n0,1\nt,x\n2,1e999\n";
  std::ofstream(bench.path("scene.yaml"))
      << "format: scene\nversion: 1\nrecording: bad.csv\nsensors: [{name: x}, {name: t}]\n";
  const std::vector<std::vector<std::string>> commands = {
      {"inspect", bench.path("bad.csv")},
      {"replay", bench.path("scene.yaml"), "-o", bench.path("out")},
      {"simulate", bench.path("scene.yaml"), "-o", bench.path("out.csv")},
      {"model", bench.path("bad.csv")},
      {"compare", bench.path("bad.csv"), bench.path("bad.csv")},
      {"verify", bench.path("bad.csv")}};
  for (const auto& words : commands) {
    const auto ran = test::run(words);
    INFO(ran.err);
    CHECK(ran.code != 0);
    const std::size_t hint = ran.err.find("hint: ");
    if (hint == std::string::npos || ran.err.find("sensorchar ", hint) != std::string::npos) continue;
    std::string flags;
    for (const auto& verb : all)
      if (verb["name"] == words[0])
        for (const auto& option : verb["options"])
          for (const auto& flag : option["flags"]) flags += flag.get<std::string>() + " ";
    for (std::size_t at = ran.err.find("--", hint); at != std::string::npos; at = ran.err.find("--", at + 2)) {
      const std::size_t end = ran.err.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", at);
      CHECK_THAT(flags, Contains(ran.err.substr(at, end - at) + " "));
    }
  }
}

TEST_CASE("on a terminal an error of a text shows the line and marks the column") {
  const TerminalBench bench;
  const std::string log = bench.path("broken.csv");
  std::ofstream(log) << "t,\xc3\xa4\n1,2\n2,\xc3\xbc"
                        "3\n";
  const auto shown = test::run_words({"script", "-qec", test::program() + " inspect " + log, "/dev/null"});
  CHECK_THAT(shown.out, Contains("  | 2,\xc3\xbc"
                                 "3") &&
                            Contains("\n  |   ^"));
  CHECK_THAT(test::run({"inspect", log}).err, !Contains("  |"));  // a pipe gets one line
}

TEST_CASE("explain: findings and errors by their codes") {
  CHECK_THAT(test::run({"explain", "stuck"}).out, Contains("the link hung"));
  const auto both = test::run({"explain", "E0304", "stuck", "--json"});
  REQUIRE(both.code == 0);
  const auto document = nlohmann::json::parse(both.out);
  CHECK(document["kinds"][0]["code"] == "stuck");
  CHECK(document["errors"][0]["code"] == "E0304");
  CHECK(document["errors"][0]["exit_code"] == "3");
  CHECK_THAT(test::run({"explain", "stuk"}).err, Contains("did you mean stuck"));
}
