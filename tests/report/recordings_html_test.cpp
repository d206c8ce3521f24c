// Pages of several recordings: a lot, pooled runs, limits.

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "libchar/characterize/characterization_view.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/report/html/fleet_report.hpp"
#include "libchar/report/html/html_report.hpp"
#include "tests/report/page_text.hpp"
#include "tests/report/synthetic.hpp"
#include "tests/support/schemas.hpp"

using namespace libchar;

namespace {

/// A lot of one recording, which is in memory.
struct OneLot {
  explicit OneLot(const Characterization& device) : devices{device}, records(records_of(devices)) {
    records[0].report = "folder";
    lot = fleet_lot(records);
    report = {records, &lot, "", {"sensorchar", "characterize"}, devices};
  }
  std::vector<Characterization> devices;
  std::vector<DeviceRecord> records;
  FleetLot lot;
  FleetReport report;
};

std::string lot_page(const Characterization& device) { return fleet_html(OneLot(device).report); }

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
  out.findings = {finding("not_computed", runs[0].log.file)};
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
  const std::string plain_runs = runs_page(test::synthetic_imu()), runs = runs_page(test::hostile());
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
  CHECK(test::count(page, "</title></path>") == 2 * 40);  // a drawing for wide windows and one for narrow ones
  CHECK(test::count(page, "folder/report.html") == 40);
  CHECK(test::count(page, "24 more have no name here") >= 1);  // the legend is not
  CHECK(page.size() < 800000);
}

TEST_CASE("the page of runs says which differs, and draws each with the pooled model") {
  const std::string page = runs_page(test::synthetic_imu());
  CHECK(test::count(page, ">differs</span>") == test::count(page, "The runs one by one"));
  CHECK(test::count(page, "the pooled model") >= 1);
}

TEST_CASE("the numbers of a lot whose recordings are in memory keep the schema") {
  const OneLot one(test::hostile());
  const std::string document = dump_json(fleet_json(one.report));
  CHECK(test::schema_fault(document) == "");
  CHECK(parse_json(document, "lot.json").at("input").size() == 1);
  CHECK_FALSE(fleet_text(one.report).empty());
}

TEST_CASE("Allan curves of one quantity stand on one pair of axes, in one unit") {
  const std::vector<Characterization> devices(2, test::synthetic_imu());
  std::vector<DeviceRecord> records;
  for (const Characterization& one : devices) records.push_back(record_of(one));
  const FleetLot lot = fleet_lot(records);
  const std::string both = fleet_html({records, &lot, "", {}, devices});
  std::vector<Characterization> other = devices;
  for (ChannelResult& c : other[1].channels) {
    if (c.channel.unit != "deg/s") continue;
    c.channel.unit = "rad/s";
    for (AllanPoint& point : c.allan.points) point.deviation *= std::numbers::pi / 180;
  }
  const std::string converted = fleet_html({records, &lot, "", {}, other});
  const auto curves = [](const std::string& page) {
    const std::size_t at = page.find("<h2>Allan curves"), end = page.find("</section>", at);
    return page.substr(at, end - at);
  };
  CHECK(test::count(curves(both), "</title></path>") == 2 * 12);
  CHECK(test::count(curves(both), "<h3>") == 2);
  CHECK(curves(both) == curves(converted));
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
