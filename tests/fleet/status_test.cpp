// How far a fleet is.

#include <catch2/catch.hpp>
#include <filesystem>

#include "libchar/fleet/detail/result_store.hpp"
#include "libchar/fleet/jobs.hpp"
#include "tests/fleet/fleet_folder.hpp"

using namespace libchar;
namespace fs = std::filesystem;

TEST_CASE("a log that has been joined needs its stretches no more") {
  const test::TemporaryFolder folder;
  const std::string log = test::write_long_log(folder / "a.npy", 1, std::size_t{3} << 20U);
  FleetPlanOptions options;
  options.split_bytes = 1U << 20U;
  options.stretch_bytes = std::uint64_t{12} << 20U;
  options.reports = false;
  const fs::path fleet = folder / "F";
  CharacterizeOptions reading;
  reading.reading.rate_hz = 100;
  const FleetPlan plan = plan_fleet(manifest_of_logs({log}, reading), options);
  REQUIRE(plan.units.size() == 3);
  run_unit(plan.units[0], fleet);
  run_unit(plan.units[1], fleet);
  const auto state = [&](const FleetUnit& unit) { return fleet / "results" / result_folder(unit.id) / state_file(0); };
  // Cut before it is joined: a stretch that is missing.
  const auto whole = fs::file_size(state(plan.units[1]));
  const std::string kept = test::slurp(state(plan.units[1]));
  fs::resize_file(state(plan.units[1]), whole / 2);
  CHECK(fleet_status(plan, fleet).missing == std::vector<std::size_t>{1, 2});
  CHECK(fleet_status(plan, fleet).damaged.size() == 1);
  CHECK(joined_stretches(plan, fleet).empty());
  test::write_file(state(plan.units[1]).string(), kept);
  run_unit(plan.units[2], fleet);
  // Cut or taken away behind it: nobody asks for them.
  fs::resize_file(state(plan.units[1]), whole / 2);
  fs::remove_all(state(plan.units[0]).parent_path());
  CHECK(joined_stretches(plan, fleet).size() == 2);
  FleetStatus status = fleet_status(plan, fleet);
  CHECK(status.done == 3);
  CHECK(status.damaged.empty());
  // Until the joined result is gone as well.
  fs::remove_all(fleet / "results" / result_folder(plan.units[2].id));
  CHECK(joined_stretches(plan, fleet).empty());
  CHECK(fleet_status(plan, fleet).missing.size() == 3);
}
