#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "libchar/core/error.hpp"
#include "libchar/log/raw_rows.hpp"
#include "tests/support/rows.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

TEST_CASE("control npy") {
  NEEDS_SHARED("oracle/badinputs");
  const auto got = test::read_rows("npy", test::shared("oracle/badinputs/npy/000_control.npy"));
  REQUIRE(got.columns.size() == 1);
  CHECK(got.columns[0] == std::vector<double>{1, 2, 3, 4});
}
