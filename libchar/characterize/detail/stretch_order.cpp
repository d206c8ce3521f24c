#include "libchar/characterize/detail/stretch_order.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "libchar/core/error.hpp"

namespace libchar {
namespace {

[[noreturn]] void refuse_states(const char* code,
                                std::string name,
                                std::string what,
                                std::string hint) {
  throw Error({ErrorKind::input, code, std::move(name), std::move(what), "", std::move(hint)});
}

}  // namespace

std::vector<OrderedState> states_in_order(std::span<const NamedState> states,
                                          const std::string& settings) {
  std::vector<OrderedState> all;
  for (const NamedState& state : states) all.push_back({&state, stretch_head(state)});
  std::stable_sort(all.begin(), all.end(), [](const OrderedState& a, const OrderedState& b) {
    return a.head.range.first_leaf < b.head.range.first_leaf;
  });
  if (all.empty()) refuse_states("E0725", "", "there is no state to be joined", "");
  std::uint64_t next = 0;
  const std::string* before = &all.front().state->name;
  for (const OrderedState& one : all) {
    const StretchHead &head = one.head, &first = all.front().head;
    const std::string& name = one.state->name;
    if (head.identity != first.identity || head.samples != first.samples)
      refuse_states("E0724",
                    name,
                    fmt::format("is of another log than {}: {} of {} samples, not {} of {}",
                                all.front().state->name,
                                head.identity,
                                head.samples,
                                first.identity,
                                first.samples),
                    "join states of one log");
    if (head.settings != settings)
      refuse_states("E0724",
                    name,
                    "was made with other settings, or by another version of the program",
                    "give the settings of all stretches, and make them with one version");
    const auto [from, end] = head.range;
    if (from < next)
      refuse_states("E0725",
                    name,
                    fmt::format("covers leaf {}, which {} does too", from, *before),
                    "leave one of them out");
    if (from > next)
      refuse_states("E0725",
                    name,
                    fmt::format("no state has the leaves {} to {} in front of it", next, from - 1),
                    "characterize that stretch, and give its state");
    next = end;
    before = &name;
  }
  const std::uint64_t leaves = leaves_of(all.front().head.samples);
  if (next < leaves)
    refuse_states("E0725",
                  *before,
                  fmt::format("no state has the leaves {} to {} behind it", next, leaves - 1),
                  "characterize that stretch, and give its state");
  return all;
}

}  // namespace libchar
