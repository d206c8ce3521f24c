// The examples of docs/formats.md, read as people read them: what stands in a block's first line is
// what inspect must find.

#include <catch2/catch.hpp>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libchar/core/document/json.hpp"
#include "tests/support/places.hpp"
#include "tests/support/run.hpp"

using namespace libchar;

namespace {

struct Example {
  std::map<std::string, std::string> expected;
  std::string text;
};

std::vector<Example> examples() {
  std::istringstream page(test::slurp(test::source_folder() / "docs/formats.md"));
  std::vector<Example> found;
  bool inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line.rfind("```csv ", 0) == 0) {
      found.emplace_back();
      std::istringstream words(line.substr(7));
      for (std::string word; words >> word;)
        found.back().expected[word.substr(0, word.find('='))] = word.substr(word.find('=') + 1);
      inside = true;
    } else if (line == "```") {
      inside = false;
    } else if (inside) {
      found.back().text += line + "\n";
    }
  }
  return found;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) parts.push_back(part);
  return parts;
}

std::string spaced(std::string word) {
  for (char& c : word) c = c == '_' ? ' ' : c;
  return word;
}

void check_read(const Example& example, const Json& recording) {
  std::string channels;
  for (const Json& c : recording.at("channels")) {
    const std::string unit = c.at("unit").get<std::string>();
    channels +=
        (channels.empty() ? "" : ",") + c.at("name").get<std::string>() + (unit.empty() ? "" : "[" + unit + "]");
  }
  CHECK(channels == example.expected.at("channels"));
  if (example.expected.count("rate") > 0)
    CHECK(recording.at("rate_hz").get<double>() == Approx(std::stod(example.expected.at("rate"))));
  CHECK(recording.at("samples") == std::stoi(example.expected.at("samples")));
  std::string repairs;
  for (const auto& repair : recording.at("repairs").items()) repairs += (repairs.empty() ? "" : ",") + repair.key();
  CHECK(repairs == (example.expected.count("repairs") > 0 ? example.expected.at("repairs") : ""));
  const std::string guesses = recording.at("guesses").dump();
  CHECK((guesses == "[]") == (example.expected.count("guesses") == 0));
  if (example.expected.count("guesses") > 0)
    for (const std::string& guess : split(example.expected.at("guesses")))
      CHECK(guesses.find("\"" + spaced(guess)) != std::string::npos);
}

}  // namespace

TEST_CASE("every CSV example of docs/formats.md is read as the page says") {
  const test::TemporaryFolder folder;
  const std::string log = (folder / "log.csv").string();
  const std::vector<Example> all = examples();
  REQUIRE(all.size() >= 9);
  for (const Example& example : all) {
    std::ofstream(log, std::ios::binary) << example.text;
    std::vector<std::string> words = {"inspect", log, "--json"};
    if (example.expected.count("options") > 0)
      for (const std::string& word : split(example.expected.at("options"))) words.push_back(word);
    const auto ran = test::run(words);
    INFO(example.text << ran.err);
    if (example.expected.count("error") > 0) {
      CHECK(ran.code == 3);
      CHECK(ran.err.find(example.expected.at("error")) != std::string::npos);
      std::string hint = example.expected.at("hint");
      hint.replace(hint.find(','), 1, " ");
      CHECK(ran.err.find(hint) != std::string::npos);
      continue;
    }
    REQUIRE(ran.code == 0);
    check_read(example, parse_json(ran.out, "stdout").at("recordings").at(0));
  }
}
