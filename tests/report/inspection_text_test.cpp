#include <catch2/catch.hpp>

#include "libchar/report/text/characterization_text.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

// With one blank where a table has several.
std::string squeezed(const std::string& text) {
  std::string out;
  for (const char c : text)
    if (c != ' ' || out.empty() || out.back() != ' ') out += c;
  return out;
}

}  // namespace

TEST_CASE("an inspection in text: how it was read, guesses, repairs, a line a channel") {
  Inspection inspection;
  inspection.info.file = "log.csv";
  inspection.info.format = "csv";
  inspection.info.dialect = {"delimiter ;", "decimal comma"};
  inspection.info.guesses = {"time unit: us"};
  inspection.info.warnings.add("gap", "gaps in the stamps", "line 12");
  inspection.info.channels = {{"gyro", "deg/s", false}, {"still", "", false}};
  inspection.quality.resize(2);
  inspection.quality[0].samples = inspection.quality[1].samples = 100;
  inspection.quality[0].minimum = -1;
  inspection.quality[0].maximum = 1;
  inspection.quality[0].standard_deviation = 0.5;
  inspection.quality[0].missing = 3;
  inspection.quality[1].findings = {finding("no_value", "is it connected?")};
  const std::string text = inspection_text(inspection);
  CHECK_THAT(text, Contains("  read as csv: delimiter ;; decimal comma\n"));
  CHECK_THAT(text, Contains("  guessed: time unit: us\n"));
  CHECK_THAT(text, Contains("  note: ") && Contains("gaps in the stamps") && Contains("line 12"));
  CHECK_THAT(squeezed(text), Contains("gyro deg/s 3 "));
  CHECK_THAT(squeezed(text), Contains("still - 0 0 constant "));
  CHECK_THAT(text, Contains("  still: is it connected?\n"));
}

TEST_CASE("one line for each kind of finding: what the first channel says, and which are alike") {
  Inspection inspection;
  inspection.info.file = "log.csv";
  inspection.info.channels = {{"gx", "deg/s", false}, {"gy", "deg/s", false}, {"n", "1", false}};
  inspection.quality.resize(3);
  inspection.quality[0].findings = {finding("spiky", "kurtosis 12.5 (3 for noise)")};
  inspection.quality[1].findings = {finding("spiky", "kurtosis 1e3 (3 for noise)"),
                                    finding("no_value", "is it connected?")};
  const std::string text = inspection_text(inspection);
  CHECK_THAT(text, Contains("  gx: kurtosis 12.5 (3 for noise) (alike: gy)\n"));
  CHECK_THAT(text, Contains("  gy: is it connected?\n"));
  CHECK_THAT(squeezed(text), Contains("n 0 "));  // the unit of numbers without one is not printed
}

TEST_CASE("the worst kinds of finding come first, and of more than five the others are counted") {
  Inspection inspection;
  inspection.info.file = "log.csv";
  inspection.info.channels = {{"gx", "deg/s", false}};
  inspection.quality.resize(1);
  for (const char* code : {"spiky", "saturated", "held_values", "coarse_resolution", "float_step", "constant"})
    inspection.quality[0].findings.push_back(finding(code, std::string("that is ") + code));
  inspection.quality[0].findings.push_back(finding("dead_band", "that is the worst"));
  const std::string text = inspection_text(inspection);
  CHECK_THAT(text, Contains("  gx: that is the worst\n  gx: that is spiky\n") && Contains("  and 2 findings more\n"));
  CHECK_THAT(text, !Contains("float_step") && !Contains("constant"));
}

TEST_CASE("of very many channels or topics the first thousand have a line, the others are counted") {
  Inspection inspection;
  inspection.info.file = "log.csv";
  for (int c = 0; c < 1003; ++c) inspection.info.channels.push_back({"c" + std::to_string(c), "V", false});
  inspection.quality.resize(1003);
  const std::string text = inspection_text(inspection);
  CHECK_THAT(text, Contains("  c999 ") && !Contains("c1000 ") && Contains("  … and 3 more, which JSON lists\n"));
  inspection = {};
  inspection.info.topics.resize(1002);
  for (int t = 0; t < 1002; ++t) inspection.info.topics[static_cast<std::size_t>(t)].name = "/t" + std::to_string(t);
  inspection.info.topics.back().sensor = true;
  CHECK_THAT(inspection_text(inspection),
             Contains("/t1001 ") && Contains("/t998 ") && !Contains("/t999 ") && Contains("… and 2 more"));
}
