// A library that is loaded when it is needed: known values of the C library's mathematics, and what is not there.

#include "libchar/core/process/late_library.hpp"

#include <catch2/catch.hpp>
#include <stdexcept>

namespace {

using libchar::detail::LateLibrary;
using libchar::detail::LateName;

using Hypotenuse = double(double, double);
LateLibrary mathematics("libm.so.6"), absent("libsensorchar-has-no-such.so.1");

}  // namespace

TEST_CASE("a function of a library that was loaded late is that of the library") {
  const LateName<Hypotenuse, mathematics, "hypot"> late{};
  CHECK(mathematics.is_here());
  CHECK(late(3.0, 4.0) == 5);
  Hypotenuse* const taken = late;
  CHECK(taken(5.0, 12.0) == 13);
}

TEST_CASE("a library that is not installed is not there, and a name that a library has not is not found") {
  CHECK_FALSE(absent.is_here());
  CHECK_THROWS_AS(absent.address("hypot"), std::runtime_error);
  CHECK_THROWS_AS(mathematics.address("no_such_function"), std::runtime_error);
}
