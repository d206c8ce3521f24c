#include "libchar/report/text/report_table.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "libchar/core/error.hpp"
#include "libchar/report/html/html_report.hpp"
#include "libchar/report/replay/replay_text.hpp"
#include "tests/report/synthetic.hpp"
#include "tests/report/synthetic_replay.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

ReportedCharacterization reported_imu() {
  return parse_characterization_report(dump_json(json_report(test::synthetic_imu())), "report.json");
}

}  // namespace

TEST_CASE("coefficients as Markdown, LaTeX and CSV, of all channels or of some") {
  const ReportedCharacterization report = reported_imu();
  const ReportedChannel& first = report.channels[0];
  const std::string csv = coefficient_table(report, {}, TableFormat::csv);
  CHECK(csv.starts_with("channel,unit,term,value,low95,high95,upper95,term_unit,status\n"));
  // all digits: the value reads back
  const std::size_t at = csv.find("white_noise,") + std::string("white_noise,").size();
  CHECK(std::stod(csv.substr(at)) == *first.term[0].value);
  const std::string latex = coefficient_table(report, {first.name}, TableFormat::latex);
  CHECK(latex.starts_with("\\begin{tabular}{llrllll}\n"));
  CHECK(latex.ends_with("\\end{tabular}\n"));
  CHECK_THAT(latex, Contains("\\sqrt{\\mathrm{s}}") && Contains("N angle random walk"));
  CHECK_THAT(latex, !Contains("√") && !Contains("·") && !Contains("…"));
  const std::string markdown = coefficient_table(report, {first.name}, TableFormat::markdown);
  CHECK_THAT(markdown, Contains("|---|---|---:|") && Contains("N angle random walk"));
  CHECK_THROWS_WITH(coefficient_table(report, {"nobody"}, TableFormat::csv), Contains("E0985"));
}

TEST_CASE("a ranking is a table, best first") {
  const ReplayReport report = parse_replay_report(dump_json(replay_json(test::synthetic_replay())), "report.json");
  const std::string csv = ranking_table(report, TableFormat::csv);
  double last = 0;
  std::size_t rows = 0;
  for (std::size_t at = csv.find('\n') + 1; at < csv.size(); at = csv.find('\n', at) + 1) {
    const std::string line = csv.substr(at, csv.find('\n', at) - at);
    const std::size_t comma = line.find(',', line.find(',') + 1);
    if (line[comma + 1] == ',') continue;
    const double rmse = std::stod(line.substr(comma + 1));
    CHECK(rmse >= last);
    last = rmse;
    ++rows;
  }
  CHECK(rows > 3);
  CHECK_THAT(ranking_table(report, TableFormat::latex), Contains("\\begin{tabular}{lrlrrr}"));
}
