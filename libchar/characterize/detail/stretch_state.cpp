#include "libchar/characterize/detail/stretch_state.hpp"

#include <bit>
#include <utility>

#include "libchar/core/process/free_memory.hpp"
#include "libchar/log/reading_fields.hpp"

namespace libchar {
namespace {

constexpr std::string_view kKind = "stretch";
constexpr std::uint32_t kVersion =
    4;  // 2: a channel; slow means, powers of means; 3: means and pieces on the clock; 4: bends

void write_time(const TimeBase& time, StateWriter& to) {
  to.real(time.rate_hz);
  to.text(time.column);
  to.text(time.unit);
  to.number(std::bit_cast<std::uint64_t>(time.unit_ns));
  to.flag(time.start_ns.has_value());
  to.number(std::bit_cast<std::uint64_t>(time.start_ns.value_or(0)));
}

TimeBase read_time(StateReader& from) {
  TimeBase time;
  time.rate_hz = from.real();
  const bool known = time.rate_hz >= kRates.lowest && time.rate_hz <= kRates.highest;
  if (!known && time.rate_hz != 0) from.refuse("its sampling rate");
  time.column = from.text();
  time.unit = from.text();
  time.unit_ns = std::bit_cast<std::int64_t>(from.number());
  const bool starts = from.flag();
  const auto start_ns = std::bit_cast<std::int64_t>(from.number());
  if (starts) time.start_ns = start_ns;
  return time;
}

void write_log(const LogInfo& log, StateWriter& to) {
  to.text(log.file);
  to.text(log.format);
  to.number(log.bytes);
  to.number(log.channels.size());
  for (const Channel& channel : log.channels) {
    to.text(channel.name);
    to.text(channel.unit);
    to.flag(channel.integer);
  }
  write_time(log.time, to);
  to.texts(log.guesses);
  to.texts(log.dialect);
  to.number(log.warnings.list().size());
  for (const Finding& warning : log.warnings.list()) {
    to.text(warning.code);
    to.text(warning.sentence);
    to.number(warning.count);
    to.texts(warning.where.rows);
  }
}

void read_warnings(StateReader& from, Findings& warnings) {
  for (std::size_t left = from.count(32); left > 0; --left) {
    const std::string code = from.text(), message = from.text();
    const std::uint64_t count = from.number();
    const std::vector<std::string> places = from.texts();
    if (places.size() > count) from.refuse("the places of a warning");
    for (const std::string& place : places) warnings.add(code, message, place);
    if (count > places.size()) warnings.add(code, message, "", count - places.size());
  }
}

LogInfo read_log_state(StateReader& from) {
  LogInfo log;
  log.file = from.text();
  log.format = from.text();
  log.bytes = from.number();
  log.channels.resize(from.count(17));
  for (Channel& channel : log.channels) {
    channel.name = from.text();
    channel.unit = from.text();
    channel.integer = from.flag();
  }
  log.time = read_time(from);
  log.guesses = from.texts();
  log.dialect = from.texts();
  read_warnings(from, log.warnings);
  return log;
}

/// About as many bytes as a node takes.
std::size_t size_of(const ChannelSums& sums) {
  std::size_t reals =
      65536 + sums.kept.size() + sums.spectrum.power.size() + sums.spectrum.head.size() + sums.spectrum.tail.size();
  const auto add = [&](const PowerSums& bins) {
    reals += bins.blocks.power.size() + bins.tail.size();
    for (const PooledSums& piece : bins.pieces) reals += piece.power.size();
    reals += bins.means.blocks.power.size();
    for (const PooledSums& piece : bins.means.pieces) reals += piece.power.size();
    for (const PowerRun& run : bins.runs) reals += 7 + run.means.size() + run.slow.size();
  };
  const auto fitted = [&](const FittedSums& one) {
    add(one.bins);
    reals += 2 * one.means.means().size();
  };
  fitted(sums.record.plain);
  if (sums.record.cleaned) fitted(*sums.record.cleaned);
  return reals * sizeof(double);
}

}  // namespace

std::string write_stretch(const StretchState& state, std::vector<ChannelNode>& nodes) {
  StateWriter to(kKind, kVersion);
  std::size_t bytes = 0;
  for (const ChannelNode& node : nodes) bytes += size_of(node.sums);
  to.reserve(bytes);
  to.text(state.head.identity);
  to.text(state.head.settings);
  to.number(state.head.range.first_leaf);
  to.number(state.head.range.end_leaf);
  to.number(state.head.samples);
  to.number(state.head.channel);
  write_log(state.log, to);
  to.number(nodes.size());
  for (ChannelNode& node : nodes) {
    to.number(node.height);
    to.number(node.place);
    LeafStage::write_state(std::exchange(node.sums, {}), to);
    give_back_free_memory();
  }
  return to.finish();
}

StateReader stretch_reader(std::string_view bytes, const std::string& name) { return {bytes, name, kKind, kVersion}; }

StretchState read_stretch(StateReader& from) {
  StretchState state;
  state.head.identity = from.text();
  state.head.settings = from.text();
  state.head.range.first_leaf = from.number();
  state.head.range.end_leaf = from.number();
  state.head.samples = from.number();
  state.head.channel = from.number();
  if (state.head.range.first_leaf >= state.head.range.end_leaf ||
      state.head.range.end_leaf > leaves_of(state.head.samples))
    from.refuse("the range of its leaves");
  state.log = read_log_state(from);
  state.head.channels = state.log.channels.size();
  if (state.head.channel >= state.head.channels) from.refuse("the number of its channel");
  return state;
}

std::size_t read_node_count(StateReader& from) { return from.count(16); }

ChannelNode read_node(StateReader& from, const LeafStage& stage) {
  ChannelNode node;
  node.height = from.number();
  node.place = from.number();
  if (node.height > 40 || node.place > (std::uint64_t{1} << (44 - node.height))) from.refuse("the place of a node");
  node.sums = stage.read_state(from);
  return node;
}

}  // namespace libchar
