// Any bytes as a fleet's plan, its tasks under the names of their content unless the first byte is
// odd: what is read is written, and reads back as the same plan.

#include "libchar/fleet/plan.hpp"
#include "tests/fuzz/fleet_support.hpp"
#include "tests/fuzz/fuzz_support.hpp"

using namespace libchar;

namespace {

std::string named_lines(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    out += fuzz::named_task(text.substr(0, end)) + "\n";
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

std::string text_of(const FleetPlan& plan) {
  std::string out;
  for (const PlannedDevice& one : plan.devices)
    for (const std::string* text :
         {&one.device, &one.type, &one.batch, &one.limits, &one.log, &one.sha256, &one.problem})
      out += *text + "|";
  for (const FleetUnit& unit : plan.units) out += unit_text(unit) + "\n";
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static const fuzz::Folder folder;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  folder.write("plan.jsonl", data[0] % 2 == 1 ? std::string(text) : named_lines(text));
  FleetPlan plan;
  try {
    plan = read_plan(folder.path());
  } catch (const Error& error) {
    fuzz::said(error);
    return 0;
  }
  for (const FleetUnit& unit : plan.units) fuzz::expect(unit.device < plan.devices.size(), "a unit of no device");
  std::string again;
  try {
    write_plan(plan, folder.path());
    again = text_of(read_plan(folder.path()));
  } catch (const Error& error) {
    again = error.what();
  }
  fuzz::expect_same("a plan, and what is read of it", text_of(plan), again);
  return 0;
}
