// Any bytes as report.json of a characterization (first byte even) or of a replay (odd). A report
// compared with itself shows no difference.

#include "libchar/characterize/compare/characterization_comparison.hpp"
#include "libchar/characterize/compare/reported_characterization.hpp"
#include "libchar/replay/comparison.hpp"
#include "tests/fuzz/fuzz_support.hpp"

using namespace libchar;

namespace {

void replay_report(std::string_view text) {
  const Comparison comparison =
      compare_replays(parse_replay_report(text, "a.json"), parse_replay_report(text, "b.json"));
  fuzz::expect(comparison.unlike.empty(), "a report that is unlike itself");
  for (const ComparedAlgorithm& row : comparison.algorithms)
    fuzz::expect(row.a != nullptr && row.b != nullptr && row.difference != Difference::better &&
                     row.difference != Difference::worse,
                 "an algorithm better or worse than itself");
  fuzz::expect(!comparison.verdict.empty(), "a comparison without a verdict");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  try {
    if (data[0] % 2 == 1)
      replay_report(text);
    else
      compare_characterizations(
          {parse_characterization_report(text, "a.json"), parse_characterization_report(text, "b.json")});
  } catch (const Error& error) {
    fuzz::said(error);
  }
  return 0;
}
