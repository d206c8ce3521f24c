#pragma once
// Power sums through the bytes of a state.

#include <catch2/catch.hpp>
#include <string>

#include "libchar/fit/record/power_sums.hpp"

namespace test {

inline void check_power_state(const libchar::PowerSums& sums) {
  using namespace libchar;
  StateWriter to("power", 1);
  write_state(sums, to);
  const std::string bytes = to.finish();
  StateReader from(bytes, "x", "power", 1);
  const std::vector<PowerBin> a = power_bins(powers_of(sums), 1), b = power_bins(powers_of(read_power_sums(from)), 1);
  from.finish();
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) REQUIRE(a[i].energy == b[i].energy);
}

}  // namespace test
