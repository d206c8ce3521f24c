
#include <catch2/catch.hpp>
#include <regex>

#include "libchar/report/detail/assets.hpp"
#include "libchar/report/replay/replay_text.hpp"
#include "tests/report/page_text.hpp"
#include "tests/report/synthetic_replay.hpp"

using namespace libchar;

namespace {

// The page without the parts that are ours byte for byte.
std::string without_replay_assets(std::string page) {
  for (const std::string_view asset : {chart_js(), page_common_js(), replay_page_js(), page_css(), replay_page_css()}) {
    const std::size_t at = page.find(asset);
    REQUIRE(at != std::string::npos);
    page.erase(at, asset.size());
  }
  return page;
}

std::string tables_of(const std::string& page) { return page.substr(0, page.find("<script id=\"report-data\"")); }

}  // namespace

TEST_CASE("replay html: asks for nothing from anywhere") {
  for (const char* kind : {"plain", "blind", "inputs", "nothing", "hostile"}) {
    INFO(kind);
    const std::string page = without_replay_assets(replay_html(test::synthetic_replay_of_kind(kind)));
    for (const char* word : {" src=\"", "href=\"http", "@import", "url(", "style=\""})
      CHECK(test::count(tables_of(page), word) == 0);
    CHECK(test::count(page, "default-src 'none'; script-src 'sha256-") == 1);
    CHECK(test::count(page, "<script") == 3);
  }
}

TEST_CASE("replay html: names from a file never become elements or attributes") {
  const std::string page = without_replay_assets(replay_html(test::hostile_replay()));
  CHECK(test::count(page, "<script") == 3);
  CHECK(test::count(page, "</script") == 3);
  CHECK(test::count(page, "<!--") == 1);
  for (const char* word : {"<img", "<svg", " onerror=\"", " onmouseover=\"", "<b>;"}) {
    INFO(word);
    CHECK(test::count(page, word) == 0);
  }
  CHECK(test::count(page, "\xE2\x80\xAE") == 0);  // right-to-left override
  CHECK(page.find('\0') == std::string::npos);
  CHECK(test::count(page, "&lt;img src=x onerror=alert(1)&gt;") > 0);
}

TEST_CASE("replay html: every algorithm stands in the table, skipped ones with their sentence") {
  const ReplayResult r = test::synthetic_replay();
  const std::string page = tables_of(without_replay_assets(replay_html(r)));
  for (const AlgorithmResult& a : r.algorithms) {
    INFO(a.label);
    CHECK(test::count(page, "<th scope=\"row\">" + a.label) >= (a.ran ? 2 : 1));
  }
  CHECK(test::count(page, "needs one gyroscope axis and two accelerometer axes") >= 1);
  CHECK(test::count(page, "class=\"best\"") == 1);
  CHECK(test::count(page, "missed") > 0);
  CHECK(test::count(page, "Pareto front") >= 1);
}

TEST_CASE("replay html: without a reference the columns say what they are") {
  const std::string page = tables_of(without_replay_assets(replay_html(test::without_reference())));
  CHECK(test::count(page, "Leave-one-out RMS, rad/s") >= 1);
  CHECK(test::count(page, "Split-array RMS") >= 1);
  CHECK(test::count(page, "Neither shows an error that all sensors share") == 1);
  CHECK(test::count(page, ">Regret<") == 0);
  CHECK(test::count(page, ">RMSE") == 0);
}

TEST_CASE("replay html: a figure an input, and no figure without anything to draw") {
  const std::string two = tables_of(replay_html(test::synthetic_replay(6, 2)));
  CHECK(test::count(two, "data-kind=\"window\"") == 2);
  CHECK(test::count(two, "data-kind=\"error-allan\"") == 2);
  const std::string none = tables_of(replay_html(test::nothing_scored()));
  CHECK(test::count(none, "<figure") == test::count(none, "data-kind=\"sensors\""));
  CHECK(!std::regex_search(without_replay_assets(replay_html(test::nothing_scored())), std::regex("\\b(nan|inf)\\b")));
}

TEST_CASE("replay html: the run stands first, with the error below it and what it is beside") {
  const std::string page = tables_of(without_replay_assets(replay_html(test::synthetic_replay())));
  const std::size_t signal = page.find("data-kind=\"signal\""), error = page.find("data-kind=\"error\"");
  REQUIRE(signal != std::string::npos);
  CHECK(signal < error);
  CHECK(page.find("<figure") < signal);
  CHECK(page.find("<figure", page.find("<figure") + 1) > signal);  // it is the first one
  CHECK(error < page.find("data-kind=\"ranking\""));
  CHECK(test::count(page, "gyr_0, the best single sensor") == 1);
  CHECK(test::count(page, "data-kind=\"deviations\"") == 0);
  const std::string blind = tables_of(without_replay_assets(replay_html(test::without_reference())));
  CHECK(test::count(blind, "data-kind=\"signal\"") == 1);
  CHECK(test::count(blind, "data-kind=\"error\"") == 0);
  CHECK(test::count(blind, "data-kind=\"deviations\"") == 1);
  CHECK(test::count(blind, "best single sensor") == 0);
}

TEST_CASE("replay html: has colours for dark screens") {
  CHECK(test::count(replay_html(test::synthetic_replay()),
                    "@media screen and (prefers-color-scheme: dark) {\n  :root") == 1);
}

TEST_CASE("replay html: 24 algorithms on 12 sensors stay below 3 MB") {
  CHECK(replay_html(test::synthetic_replay(12)).size() < 3'000'000);
}

TEST_CASE("replay html: 200 sensors without a reference stay below 3 MB") {
  ReplayResult r = test::synthetic_replay(200);
  std::mt19937_64 random(3);
  r.has_reference = false;
  r.tracks.whole.deviations = test::synthetic_track(200, 2000, 0.05, 100, random);
  CHECK(replay_html(r).size() < 3'000'000);
}

TEST_CASE("replay markdown: tables keep their columns whatever the names hold") {
  const std::string text = replay_markdown(test::hostile_replay());
  CHECK(test::count(text, "<script") == test::count(text, "\\<script"));
  CHECK(test::count(text, "<img") == test::count(text, "\\<img"));
  for (const char c : {'\0', '\x01'}) CHECK(text.find(c) == std::string::npos);
  std::size_t columns = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("|")) {
      columns = 0;
      continue;
    }
    std::size_t bars = 0;
    for (std::size_t i = 0; i < line.size(); ++i) bars += line[i] == '|' && (i == 0 || line[i - 1] != '\\');
    INFO(line);
    if (columns == 0) columns = bars;
    CHECK(bars == columns);
  }
}
