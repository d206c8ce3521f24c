// Digests that somebody else took: read as sha256sum writes them, trusted by the plan, checked by the workers.

#include <catch2/catch.hpp>
#include <chrono>
#include <filesystem>

#include "libchar/core/error.hpp"
#include "libchar/fleet/detail/log_seen.hpp"
#include "libchar/fleet/detail/result_store.hpp"
#include "libchar/fleet/jobs.hpp"
#include "libchar/fleet/manifest.hpp"
#include "libchar/fleet/plan.hpp"
#include "tests/fleet/fleet_folder.hpp"

using namespace libchar;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

const std::string kDigestA(64, 'a'), kDigestB(64, 'b');

std::string refused_sums(const std::string& text) {
  try {
    parse_sums(text, "/logs/SUMS");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// A plan in which the digests of these logs are stated.
FleetPlan stated_plan(const std::vector<std::string>& logs, const std::vector<std::string>& digests,
                      const FleetPlanOptions& options = {}) {
  CharacterizeOptions reading;
  reading.reading.rate_hz = 100;  // of logs without stamps
  Manifest manifest = manifest_of_logs(logs, reading);
  for (std::size_t d = 0; d < digests.size(); ++d) manifest.devices[d].sha256 = digests[d];
  return plan_fleet(manifest, options);
}

}  // namespace

TEST_CASE("sums of sha256sum, in text and binary mode, with escapes, and of BSD") {
  const StatedDigests sums = parse_sums(
      "# logs of line 7\r\n" + kDigestA + "  a.npy\n\n" + kDigestB + " *../b b.npy\r\n" + "\\" + kDigestA +
          "  c\\\\d\\ne.npy\n" + "SHA256 (f (1).npy) = " + std::string(64, 'C') + "\n" + kDigestB + "  /other/g.npy",
      "/logs/SUMS");
  REQUIRE(sums.size() == 5);
  CHECK(sums.at("/logs/a.npy").sha256 == kDigestA);
  CHECK(sums.at("/logs/a.npy").where == "/logs/SUMS:2:1");
  CHECK(sums.at("/b b.npy").sha256 == kDigestB);
  CHECK(sums.at("/logs/c\\d\ne.npy").sha256 == kDigestA);
  CHECK(sums.at("/logs/f (1).npy").sha256 == std::string(64, 'c'));
  CHECK(sums.at("/other/g.npy").sha256 == kDigestB);
}

TEST_CASE("a line that is no sum, and two sums of one log, are refused with their places") {
  for (const std::string& line :
       {std::string("a.npy"), kDigestA, kDigestA + "  ", kDigestA + " a.npy", kDigestA.substr(1) + "  a.npy",
        kDigestA + "a  a.npy", "g" + kDigestA.substr(1) + "  a.npy", "SHA256 () = " + kDigestA,
        "SHA256 (a.npy) = " + kDigestA.substr(1), "MD5 (a.npy) = " + kDigestA, std::string("\\")})
    CHECK_THAT(refused_sums(kDigestB + "  b.npy\n" + line + "\n"),
               Contains("/logs/SUMS:2:1: error E0792: expected a digest"));
  CHECK_THAT(refused_sums(kDigestA + "  a.npy\n" + kDigestB + "  x/../a.npy\n"),
             Contains("/logs/SUMS:2:1: error E0794") && Contains("at /logs/SUMS:1:1"));
  CHECK(refused_sums(kDigestA + "  a.npy\n" + kDigestA + "  a.npy\n").empty());
}

TEST_CASE("a manifest states digests by entry and by column, and they have 64 digits") {
  const std::string head = "format: fleet-manifest\nversion: 1\ndevices:\n";
  const Manifest tree = parse_manifest(
      head + "  - {log: a.npy, sha256: " + std::string(64, 'A') + "}\n  - {log: b.npy}\n", "/logs/m.yaml");
  CHECK(tree.devices[0].sha256 == kDigestA);
  CHECK(tree.devices[1].sha256.empty());
  Manifest table = parse_manifest("log,sha256\na.npy," + kDigestA + "\nb.npy,\nc.npy,\n", "/logs/m.csv");
  CHECK(table.devices[0].sha256 == kDigestA);
  CHECK(table.devices[1].sha256.empty());
  CHECK_THROWS_WITH(parse_manifest("log,sha256\na.npy,12ab\n", "m.csv"),
                    Contains("m.csv:2:1") && Contains("sha256") && Contains("64 hexadecimal"));
  CHECK_THROWS_WITH(parse_manifest(head + "  - {log: a.npy, sha256: " + kDigestA + "0}\n", "m.yaml"),
                    Contains("m.yaml:4") && Contains("64 hexadecimal"));
  // Sums beside it: what is in neither stays open, what differs is refused.
  CHECK(state_digests(parse_sums(kDigestB + "  b.npy\n", "/logs/SUMS"), table) == 1);
  CHECK(table.devices[1].sha256 == kDigestB);
  CHECK_THROWS_WITH(state_digests(parse_sums(kDigestB + "  a.npy\n", "/logs/SUMS"), table),
                    Contains("/logs/m.csv:2:1: error E0794") && Contains("/logs/SUMS:1:1"));
}

TEST_CASE("digests that are stated give the plan and the results of digests that were taken") {
  const test::TemporaryFolder folder;
  const auto logs = test::write_logs(folder.path(), 2);
  const FleetPlan taken = stated_plan(logs, {});
  const FleetPlan claimed = stated_plan(logs, {digest_of_log(logs[0]), digest_of_log(logs[1])});
  REQUIRE(claimed.units.size() == 2);
  CHECK(claimed.units[0].stated);
  CHECK(claimed.units[0].id == taken.units[0].id);
  CHECK(parse_unit(unit_text(claimed.units[0]), "task").stated);
  test::run_all(taken, folder / "A");
  test::run_all(claimed, folder / "B");
  const auto a = merged_records(taken, folder / "A", {true, folder / "A"});
  const auto b = merged_records(claimed, folder / "B", {true, folder / "B"});
  CHECK(a == b);
  CHECK_THROWS_WITH(stated_plan(logs, {kDigestA, kDigestA}), Contains("d0 and d1 have one digest, as it is stated"));
}

TEST_CASE("a wrong digest is told by the worker, whatever the log holds") {
  const test::TemporaryFolder folder;
  const auto logs = test::write_logs(folder.path(), 1);
  FleetPlan plan = stated_plan(logs, {kDigestA});
  const std::string sentence = "d0.csv: error E0785: the log is not the one that was planned";
  CHECK_THROWS_WITH(run_unit(plan.units[0], folder / "F"), Contains(sentence));
  // Nor is it a result of that digest that this log cannot be characterized.
  std::string text = test::slurp(logs[0]);
  const std::string rows = text.substr(text.find('\n') + 1);
  while (text.size() < (std::size_t{3} << 20U)) text += rows;
  test::write_file(logs[0], text + "7.00,abc,1\n");
  plan = stated_plan(logs, {kDigestA});
  CHECK_THROWS_WITH(run_unit(plan.units[0], folder / "F"), Contains(sentence));
  CHECK_FALSE(stored_record(folder / "F", plan.units[0].id));
  CHECK(fleet_status(plan, folder / "F").missing.size() == 1);
}

TEST_CASE("a result that is there does not make a wrong digest right") {
  const test::TemporaryFolder folder;
  const auto logs = test::write_logs(folder.path(), 2);
  const fs::path fleet = folder / "F";
  const std::vector<std::string> digests = {digest_of_log(logs[0]), digest_of_log(logs[1])};
  const FleetPlan right = stated_plan(logs, digests);
  test::run_all(right, fleet);
  CHECK(fleet_status(right, fleet).done == 2);
  // Two lines of a manifest changed places: there are results of both digests.
  const FleetPlan wrong = stated_plan(logs, {digests[1], digests[0]});
  CHECK(fleet_status(wrong, fleet).done == 0);
  CHECK_THROWS_WITH(merged_records(wrong, fleet), Contains("2 of 2 units have no result"));
  CHECK_THROWS_WITH(run_unit(wrong.units[0], fleet), Contains("not the one that was planned"));
  // The same log under another name needs no work, only a look.
  fs::create_directory(folder / "moved");
  const std::string moved = (folder / "moved" / "d0.csv").string();
  fs::copy_file(logs[0], moved);
  const FleetPlan there = stated_plan({moved}, {digests[0]});
  CHECK(fleet_status(there, fleet).done == 0);
  CHECK(run_unit(there.units[0], fleet).outcome == UnitOutcome::already_there);
  CHECK(fleet_status(there, fleet).done == 1);
  // Sums that are older than the log.
  std::string text = test::slurp(moved);
  text[text.size() - 3] = text[text.size() - 3] == '1' ? '2' : '1';
  test::write_file(moved, text);
  fs::last_write_time(moved, fs::last_write_time(moved) + std::chrono::seconds(1));
  CHECK(fleet_status(stated_plan({moved}, {digests[0]}), fleet).done == 0);
  CHECK_THROWS_WITH(run_unit(there.units[0], fleet), Contains("not the one that was planned"));
  // Where logs cannot be looked at, a merge believes the worker.
  fs::remove(logs[1]);
  fs::remove(moved);
  CHECK(fleet_status(there, fleet).done == 1);
}

TEST_CASE("stretches of another log are none of this one") {
  const test::TemporaryFolder folder;
  const std::size_t rows = std::size_t{3} << 20U;
  const std::vector<std::string> logs = {test::write_long_log(folder / "a.npy", 1, rows),
                                         test::write_long_log(folder / "b.npy", 2, rows)};
  const std::string a = digest_of_log(logs[0]), b = digest_of_log(logs[1]);
  FleetPlanOptions options;
  options.split_bytes = 1U << 20U;
  options.stretch_bytes = std::uint64_t{12} << 20U;
  options.reports = false;
  const fs::path fleet = folder / "F";
  const FleetPlan wrong = stated_plan(logs, {b, a}, options);
  REQUIRE(wrong.units.size() == 6);
  for (const FleetUnit& unit : wrong.units) {
    if (unit.kind == UnitKind::stretch)
      run_unit(unit, fleet);
    else
      CHECK_THROWS_WITH(run_unit(unit, fleet), Contains("not the one that was planned"));
  }
  // The digests are put right: states of those names are there, made of the other log.
  const FleetPlan right = stated_plan(logs, {a, b}, options);
  CHECK(right.units[0].id == wrong.units[3].id);
  CHECK(fleet_status(right, fleet).done == 0);
  CHECK_THROWS_WITH(run_unit(right.units[2], fleet), Contains("2 of 2 stretches"));
  test::run_all(right, fleet);
  test::run_all(right, folder / "G");
  CHECK(merged_records(right, fleet, {false, fleet}) == merged_records(right, folder / "G", {false, folder / "G"}));
}
