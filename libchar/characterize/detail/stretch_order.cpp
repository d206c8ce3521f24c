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

void check_log(const OrderedState& one, const OrderedState& first, const std::string& settings) {
  const StretchHead &head = one.head, &other = first.head;
  if (head.identity != other.identity || head.samples != other.samples ||
      head.channels != other.channels)
    refuse_states(
        "E0724",
        one.state->name,
        fmt::format("is of another log than {}: {} of {} samples of {} channels, not {} of "
                    "{} of {}",
                    first.state->name,
                    head.identity,
                    head.samples,
                    head.channels,
                    other.identity,
                    other.samples,
                    other.channels),
        "join states of one log");
  if (head.settings != settings)
    refuse_states("E0724",
                  one.state->name,
                  "was made with other settings, or by another version of the program",
                  "give the settings of all stretches, and make them with one version");
}

/// " of channel 2" where there are several.
std::string of_channel(const StretchHead& head) {
  return head.channels > 1 ? fmt::format(" of channel {}", head.channel + 1) : "";
}

[[noreturn]] void refuse_hole(const OrderedState& at,
                              std::uint64_t first,
                              std::uint64_t last,
                              const char* where) {
  refuse_states(
      "E0725",
      at.state->name,
      fmt::format(
          "no state has the leaves {} to {}{} {} it", first, last, of_channel(at.head), where),
      "characterize that stretch, and give its state");
}

/// The states of a channel, in order: do they cover the log?
void check_cover(const std::vector<OrderedState>& states) {
  std::uint64_t next = 0;
  const OrderedState* before = &states.front();
  for (const OrderedState& one : states) {
    const auto [from, end] = one.head.range;
    if (from < next)
      refuse_states("E0725",
                    one.state->name,
                    fmt::format("covers leaf {}{}, which {} does too",
                                from,
                                of_channel(one.head),
                                before->state->name),
                    "leave one of them out");
    if (from > next) refuse_hole(one, next, from - 1, "in front of");
    next = end;
    before = &one;
  }
  const std::uint64_t leaves = leaves_of(before->head.samples);
  if (next < leaves) refuse_hole(*before, next, leaves - 1, "behind");
}

}  // namespace

std::vector<std::vector<OrderedState>> states_in_order(std::span<const NamedState> states,
                                                       const std::string& settings) {
  std::vector<OrderedState> all;
  for (const NamedState& state : states) all.push_back({&state, stretch_head(state)});
  if (all.empty()) refuse_states("E0725", "", "there is no state to be joined", "");
  std::stable_sort(all.begin(), all.end(), [](const OrderedState& a, const OrderedState& b) {
    return std::pair(a.head.channel, a.head.range.first_leaf) <
           std::pair(b.head.channel, b.head.range.first_leaf);
  });
  std::vector<std::vector<OrderedState>> channels;
  for (OrderedState& one : all) {
    check_log(one, all.front(), settings);
    channels.resize(all.front().head.channels);
    channels[one.head.channel].push_back(one);
  }
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (channels[c].empty())
      refuse_states("E0725",
                    all.front().state->name,
                    fmt::format("no state is of channel {} of {}", c + 1, channels.size()),
                    "give the states of all channels");
    check_cover(channels[c]);
  }
  return channels;
}

}  // namespace libchar
