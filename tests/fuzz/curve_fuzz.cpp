// Any bytes as a table of curves, Allan deviations when the first byte is odd, spectra else: what
// is read are numbers, point by point.

#include <cmath>

#include "libchar/fit/curve/curve_table.hpp"
#include "tests/fuzz/fuzz_support.hpp"
#include "tests/support/memory_log.hpp"

using namespace libchar;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const test::MemoryLog file({reinterpret_cast<const char*>(data) + 1, size - 1});
  try {
    const auto table = read_curve_table(file.path(), data[0] % 2 == 1);
    if (!table) return 0;
    for (const NamedCurve& named : table->curves) {
      fuzz::expect(named.curve.x.size() == named.curve.y.size(), "abscissae without values");
      for (std::size_t i = 0; i < named.curve.x.size(); ++i)
        fuzz::expect(std::isfinite(named.curve.x[i]) && named.curve.x[i] > 0 && std::isfinite(named.curve.y[i]),
                     "a point that is none");
    }
  } catch (const Error& error) {
    fuzz::said(error);
  }
  return 0;
}
