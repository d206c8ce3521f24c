// Any bytes as the task of a unit, under the name of its content unless the first byte is odd: what
// is read is written, and read back as the same unit.

#include "libchar/fleet/unit.hpp"
#include "tests/fuzz/fleet_support.hpp"
#include "tests/fuzz/fuzz_support.hpp"

using namespace libchar;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  std::string written;
  try {
    const FleetUnit unit = parse_unit(data[0] % 2 == 1 ? std::string(text) : fuzz::named_task(text), "t.json");
    fuzz::expect(unit.kind != UnitKind::stretch || unit.stretch.first_leaf < unit.stretch.end_leaf,
                 "a stretch of no leaves");
    written = unit_text(unit);
  } catch (const Error& error) {
    fuzz::said(error);
    return 0;
  }
  std::string again;
  try {
    again = unit_text(parse_unit(written, "t.json"));
  } catch (const Error& error) {
    again = error.what();
  }
  fuzz::expect_same("a task, and what is read of it", written, again);
  return 0;
}
