// Pages of several recordings: a lot, pooled runs, limits.

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "libchar/characterize/characterization_view.hpp"
#include "libchar/core/json.hpp"
#include "libchar/report/html_report.hpp"
#include "libchar/report/lot_report.hpp"
#include "libchar/report/runs_report.hpp"
#include "tests/report/page_text.hpp"
#include "tests/report/synthetic.hpp"

using namespace libchar;

namespace {

std::string lot_page(const Characterization& device) {
  const std::vector<Characterization> devices = {device};
  const Lot lot = lot_of(devices);
  return lot_html({devices, &lot, {"folder"}, {"sensorchar", "characterize"}});
}

PooledRuns pooled_of(const std::vector<Characterization>& runs) {
  PooledRuns out;
  out.runs = {{runs[0].log.file, 1000, 10, 100}, {runs[1].log.file, 1000, 10, 100}};
  for (const ChannelResult& c : runs[0].channels) {
    if (!c.fit) continue;
    PooledChannel channel;
    channel.channel = c.channel;
    channel.fit = *c.fit;
    channel.runs = {{0, 1, 0.1, 2, 0.5, false}, {1, 1.2, 0.1, 40, 0.005, true}};
    channel.sentences = {c.channel.name + " " + runs[1].log.file};
    out.channels.push_back(std::move(channel));
  }
  out.problems = {runs[0].log.file};
  return out;
}

std::string runs_page(const Characterization& run) {
  const std::vector<Characterization> runs = {run, run};
  const PooledRuns pooled = pooled_of(runs);
  return runs_html({runs, &pooled, nullptr, {"a", "b"}, {}});
}

}  // namespace

TEST_CASE("pages of several recordings: names from files never become elements") {
  const std::string plain_lot = lot_page(test::synthetic_imu()), lot = lot_page(test::hostile());
  const std::string plain_runs = runs_page(test::synthetic_imu()),
                    runs = runs_page(test::hostile());
  for (const auto& [page, plain] : {std::pair(&lot, &plain_lot), std::pair(&runs, &plain_runs)}) {
    CHECK(test::count(*page, "<script") == test::count(*plain, "<script"));
    CHECK(test::count(*page, "<img") == 0);
    CHECK(test::count(*page, "<svg onload") == 0);
    // In the numbers of the page alone, where the quote is escaped.
    CHECK(test::count(*page, "\" onmouseover=") == test::count(*page, "\\\" onmouseover="));
    CHECK(test::count(*page, "&lt;img src=x") > 0);
    CHECK(test::count(*page, " style=\"") == 0);
    CHECK(test::count(*page, "unsafe-") == 0);
  }
}

TEST_CASE("a lot of forty channels is one page with a row and a curve each") {
  const Characterization device = test::many_channels(40);
  const std::string page = lot_page(device);
  CHECK(test::count(page, "<polyline") == 40);
  CHECK(test::count(page, "folder/report.html") == 40);
  CHECK(test::count(page, "and 28 more") >= 1);  // the legend is not
  CHECK(page.size() < 800000);
}

TEST_CASE("the page of runs says which differs, and draws each with the pooled model") {
  const std::string page = runs_page(test::synthetic_imu());
  CHECK(test::count(page, "class=\"out\">differs") == test::count(page, "The runs one by one"));
  CHECK(test::count(page, "the pooled model") >= 1);
}

TEST_CASE("the numbers of a lot and of runs hold no infinity, and read back") {
  const std::vector<Characterization> devices = {test::hostile()};
  const Lot lot = lot_of(devices);
  const LotReport report{devices, &lot, {""}, {}};
  CHECK(parse_json(dump_json(lot_json(report)), "lot.json").at("format") == "lot");
  CHECK_FALSE(lot_text(report).empty());
}

TEST_CASE("limits stand in the page, in their order, with a word and not by colour alone") {
  Characterization imu = test::synthetic_imu();
  auto report = std::make_shared<LimitReport>();
  report->sensor = test::hostile_names()[0];
  report->judgements.resize(3);
  for (std::size_t i = 0; i < 3; ++i) {
    report->judgements[i].channel = test::hostile_names()[i];
    report->judgements[i].status = static_cast<LimitStatus>(i);
    report->judgements[i].sentence = test::hostile_names()[i];
  }
  imu.limits = report;
  const std::string page = html_report(imu);
  CHECK(test::count(page, "<section id=\"limits\">") == 1);
  CHECK(test::count(page, "<img") == 0);
  CHECK(test::count(page, ">pass</span>") == 1);
  CHECK(test::count(page, ">fail</span>") == 1);
  CHECK(test::count(page, ">not decided</span>") == 1);
}
