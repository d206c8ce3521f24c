#include "libchar/report/detail/tables/replay_tables.hpp"

#include <catch2/catch.hpp>
#include <regex>
#include <string>

#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/replay/replay_text.hpp"
#include "tests/report/page_text.hpp"
#include "tests/report/synthetic_replay.hpp"

using namespace libchar;

namespace {

std::string ranking_of(const ReplayResult& r) {
  return html_table(algorithms_table(replay_view(r)), {.css = "ranking", .sorted = true});
}
std::string inputs_of(const ReplayResult& r) {
  std::string out;
  for (const Table& table : input_tables(replay_view(r))) out += html_table(table);
  return out;
}
std::string needs_of(const ReplayResult& r) { return html_table(needs_table(replay_view(r))); }

// The page without what is ours byte for byte, and without the document in it.
std::string body_of(const ReplayResult& result) {
  const std::string page = replay_html(result);
  const std::size_t from = page.find("<body>"), to = page.find("<script id=\"report-data\"");
  REQUIRE(from != std::string::npos);
  REQUIRE(to != std::string::npos);
  return page.substr(from, to - from);
}

// Each kind of result that a replay can end in.
const std::vector<std::string>& kinds() {
  static const std::vector<std::string> all = {"plain", "large", "inputs", "blind", "nothing", "hostile"};
  return all;
}

}  // namespace

TEST_CASE("replay page: bounds stand behind all methods, in a body of their own") {
  const ReplayResult r = test::synthetic_replay();
  const std::string table = ranking_of(r);
  const std::size_t bounds = table.find("<tbody class=\"bounds\">");
  REQUIRE(bounds != std::string::npos);
  CHECK(test::count(table.substr(0, bounds), "<tr class=\"bound\">") == 0);
  std::size_t expected = 0;
  for (const AlgorithmResult& a : r.algorithms) expected += a.ran && a.bound;
  REQUIRE(expected > 0);
  CHECK(test::count(table.substr(bounds), "<tr class=\"bound\">") == expected);
  CHECK(test::count(table, "<tr class=\"best\">") == 1);
}

TEST_CASE("replay page: methods stand in the order of their score") {
  const std::string table = ranking_of(test::synthetic_replay());
  const std::string methods = table.substr(0, table.find("<tbody class=\"bounds\">"));
  static const std::regex score("</th><td class=\"n\" data-value=\"([^\"]+)\"");
  double last = 0;
  std::size_t rows = 0;
  for (std::sregex_iterator it(methods.begin(), methods.end(), score), end; it != end; ++it) {
    const double value = std::stod((*it)[1]);
    CHECK(value >= last);
    last = value;
    ++rows;
  }
  CHECK(rows > 10);
}

TEST_CASE("replay page: the error stands beside the best possible one") {
  ReplayResult r = test::synthetic_replay();
  for (AlgorithmResult& a : r.algorithms) a.regret = 16.013;
  CHECK(test::count(ranking_of(r), ">17 ×<") > 5);
  for (AlgorithmResult& a : r.algorithms) a.regret = 0.0034;
  CHECK(test::count(ranking_of(r), ">0.34 %<") > 5);
  for (AlgorithmResult& a : r.algorithms) a.regret = test::kNan;
  CHECK(test::count(ranking_of(r), ">0.34 %<") == 0);
}

TEST_CASE("replay page: nanoseconds stand in front only where the rate makes them matter") {
  ReplayResult r = test::synthetic_replay();
  const std::string folded = "<th scope=\"col\" class=\"more\">Time per sample</th>",
                    in_front = "<th scope=\"col\">Time per sample</th>";
  for (AlgorithmResult& a : r.algorithms) a.ns_per_sample = 1000;
  r.rate_hz = 990;  // 0.099 % of a core
  CHECK(test::count(ranking_of(r), folded) == 1);
  CHECK(test::count(body_of(r), "run time decides nothing here") == 1);
  CHECK(test::count(body_of(r), "ns per sample, ") == 0);
  const auto reads = [&](const std::vector<std::string>& verdict) {
    const ReplayView view = replay_view(r);
    return replay_text(view).find(verdict.front()) != std::string::npos &&
           replay_markdown(view).find(markdown_text(verdict.front())) != std::string::npos;
  };
  const ReplayView measured = replay_view(r);
  REQUIRE(measured.verdict.front() != measured.steady_verdict.front());
  CHECK(reads(measured.steady_verdict));
  r.rate_hz = 1010;
  CHECK(reads(measured.verdict));
  CHECK(test::count(ranking_of(r), in_front) == 1);
  CHECK(test::count(body_of(r), "run time decides nothing here") == 0);
}

TEST_CASE("replay page: every row of every table has the cells of its head") {
  for (const std::string& kind : kinds()) {
    INFO(kind);
    CHECK(test::rows_that_do_not_fit(body_of(test::synthetic_replay_of_kind(kind))) == std::vector<std::string>());
  }
}

TEST_CASE("replay page: how long each sensor was out, those that never were left away") {
  ReplayResult r = test::synthetic_replay();
  for (AlgorithmResult& a : r.algorithms) a.watches_faults = false;
  AlgorithmResult& a = r.algorithms[0];
  a.watches_faults = true;
  a.faults = {{1, "bias", 40, 60}, {1, "gain", 95, {}}, {2, "noise", 10, 90}};
  const std::string table = html_table(out_share_table(replay_view(r)));
  CHECK(test::count(table, "<tr><th scope=\"row\">gyr_1</th><td>25 %</td></tr>") == 1);
  CHECK(test::count(table, "<tr><th scope=\"row\">") == 1);  // noise only re-weights
  a.faults.clear();
  CHECK(out_share_table(replay_view(r)).rows.empty());
}

TEST_CASE("replay page: a table for each input when there are several, none for one") {
  CHECK(inputs_of(test::synthetic_replay()).empty());
  const ReplayResult r = test::synthetic_replay(6, 2);
  const std::string tables = inputs_of(r);
  CHECK(test::count(tables, "<table") == 2);
  CHECK(test::count(tables, "<h3>Input axis_0</h3>") == 1);
  CHECK(test::count(tables, "<h3>Input axis_1</h3>") == 1);
  // An algorithm that estimates fewer inputs has no row in the other tables.
  ReplayResult fewer = r;
  std::size_t ran = 0;
  for (const AlgorithmResult& a : r.algorithms) ran += a.ran;
  for (AlgorithmResult& a : fewer.algorithms)
    if (a.ran) {
      a.inputs.resize(1);
      break;
    }
  CHECK(test::count(tables, "<th scope=\"row\">") == 2 * ran);
  CHECK(test::count(inputs_of(fewer), "<th scope=\"row\">") == 2 * ran - 1);
}

TEST_CASE("replay page: without a reference the scores have their own names and their limit") {
  const std::string body = body_of(test::without_reference());
  CHECK(test::count(body, "Leave-one-out RMS") > 0);
  CHECK(test::count(body, "Split-array RMS") > 0);
  CHECK(test::count(body, "Neither shows an error that all sensors share") == 1);
  CHECK(test::count(body, ">Regret<") == 0);
  CHECK(test::count(body, ">RMSE") == 0);
  CHECK(test::count(body, "data-kind=\"sensors\"") == 0);
}

TEST_CASE("replay page: what could not be computed leaves a dash, never a name of a bit pattern") {
  for (const std::string& kind : kinds()) {
    INFO(kind);
    const std::string body = body_of(test::synthetic_replay_of_kind(kind));
    CHECK(!std::regex_search(body, std::regex("\\b(nan|NaN|inf|Infinity)\\b")));
  }
  CHECK(test::count(body_of(test::nothing_scored()), "data-kind=\"cost-time\"") == 0);
}

TEST_CASE("replay page: every algorithm has a row, and who was skipped a sentence") {
  const ReplayResult r = test::synthetic_replay();
  const std::string body = body_of(r), needs = needs_of(r);
  std::size_t skipped = 0;
  for (const AlgorithmResult& a : r.algorithms) {
    INFO(a.label);
    CHECK(test::count(needs, ">" + a.label + "</th>") == 1);
    skipped += !a.ran;
  }
  REQUIRE(skipped == 3);
  CHECK(test::count(needs, "skipped: ") == skipped);
  // One reason, said once for all three.
  CHECK(test::count(body, "needs one gyroscope axis and two accelerometer axes</li>") == 1);
}

TEST_CASE("replay page: the same result gives the same bytes") {
  const ReplayResult r = test::synthetic_replay(6, 2);
  CHECK(replay_html(r) == replay_html(r));
}

TEST_CASE("replay page: heads that are names of sensors and methods stay as they are written") {
  const ReplayResult r = test::synthetic_replay();
  const std::string page = replay_html(r);
  for (const SensorResult& s : r.sensors) CHECK(test::count(page, "<th scope=\"col\">" + s.name + "</th>") >= 1);
  CHECK(test::count(page, "(false_alarm_s)") == 0);
}
