#include <fmt/format.h>

#include <algorithm>

#include "libchar/characterize/detail/channel_stage.hpp"
#include "libchar/characterize/detail/thermometers.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

// What the leaves of a channel take: the one that is filled, what is made of it, and the nodes of the tree.
constexpr std::uint64_t kChannelBytes = std::uint64_t{24} << 20U;
constexpr std::uint64_t kSpectrumBytes = std::uint64_t{14} << 20U;  // where nothing else is made
constexpr std::uint64_t kMostOfPass = std::uint64_t{192} << 20U;

constexpr std::size_t kFittedAtOnce = 2;

/// Curves, fit and their part of the reports take up to .6 MB a channel, which all stand in memory in the end.
constexpr std::size_t kMostFitted = 5000;

void refuse_too_many(const LogInfo& log) {
  if (log.channels.size() > kMostFitted)
    throw input_error("E0707", log.file)
        .says("{} channels are more than are characterized at a time, {}", log.channels.size(), kMostFitted)
        .hint("choose some of them with `channels`");
}

}  // namespace

ChannelStages::ChannelStages(const CharacterizeOptions& options, CharacterizeWorkspace& workspace, std::size_t first,
                             bool all)
    : options_(options),
      workspace_(workspace),
      first_(first),
      all_(all),
      needs_all_samples_(what_needs_all_samples(options)) {}

// No value takes less than a byte of the file.
std::size_t ChannelStages::channels_at_once(const LogInfo& so_far) const {
  const std::size_t channels = so_far.channels.size();
  if (all_ || !needs_all_samples_.empty()) return channels;
  const std::uint64_t most_rows = so_far.samples > 0 ? so_far.samples : so_far.bytes / channels;
  const bool fitted = options_.wanted.fit || options_.wanted.allan;
  const std::uint64_t each = std::min(fitted ? kChannelBytes : kSpectrumBytes, (most_rows + 1) * sizeof(double));
  const std::uint64_t some = std::min(options_.memory_bytes, kMostOfPass) / each;
  return std::clamp<std::size_t>(detail::in_memory(some), 1, channels);
}

void ChannelStages::begin(const LogInfo& so_far) {
  const std::size_t channels = so_far.channels.size();
  if (options_.wanted.quality && options_.wanted.fit) refuse_too_many(so_far);
  if (options_.wanted.spectrum && options_.spectrum.segment == 0 && options_.segment_s > 0)
    options_.spectrum.segment = segment_samples(options_.segment_s, so_far.time.rate_hz);
  if (!options_.temperature.empty()) find_temperature(so_far);
  const std::size_t end = std::min(channels, first_ + channels_at_once(so_far));
  for (std::size_t c = first_; c < end; ++c) {
    const bool temperature = !options_.temperature.empty() && c == temperature_index_;
    stages_.emplace_back(temperature ? temperature_options_ : options_, workspace_, !needs_all_samples_.empty());
    stages_.back().reserve(detail::in_memory(so_far.bytes / std::max<std::size_t>(channels, 1)));
  }
  arena_.limit_to(options_.reading.threads);
}

void ChannelStages::block(const SampleBlock& samples) {
  rows_ += samples.rows;
  if (refused()) {
    for (ChannelStage& stage : stages_) stage.drop();
    return;
  }
  arena_.run([&] {
    parallel::for_each(0, stages_.size(), [&](std::size_t c) {
      stages_[c].push({samples.channels[first_ + c], samples.rows});
    });
  });
}

std::optional<std::size_t> temperature_channel(const LogInfo& log, const std::string& wanted) {
  std::vector<std::string> names;
  names.reserve(log.channels.size());
  for (const Channel& channel : log.channels) names.push_back(channel.name);
  auto found = std::find(names.begin(), names.end(), wanted);
  for (std::size_t c = 0; found == names.end() && c < names.size(); ++c)
    if (wanted == fmt::format("c{}", c)) found = names.begin() + static_cast<std::ptrdiff_t>(c);
  if (found == names.end() && is_pattern(wanted)) {
    const auto means_it = [&](const std::string& name) { return matches(wanted, name); };
    found = std::find_if(names.begin(), names.end(), means_it);
    if (found != names.end() && std::any_of(found + 1, names.end(), means_it))
      throw usage_error("E0702", log.file)
          .says("several channels match this pattern, and one is the `temperature`")
          .got(wanted)
          .hint("`temperature` " + *found + " is the first of them");
  }
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

void ChannelStages::find_temperature(const LogInfo& so_far) {
  const auto& channels = so_far.channels;
  const std::string& wanted = options_.temperature;
  const auto found = temperature_channel(so_far, wanted);
  if (!found) {
    std::vector<std::string> names;
    for (const Channel& channel : channels) names.push_back(channel.name);
    const auto near = nearest(wanted, names);
    throw usage_error("E0702", so_far.file)
        .says("there is no channel of this name to be the `temperature`")
        .got(wanted)
        .hint(did_you_mean(near, "it has " + first_names(names)));
  }
  temperature_index_ = *found;
  const std::string& name = channels[temperature_index_].name;
  const std::string& unit = channels[temperature_index_].unit;
  const auto known = find_unit(unit);
  if (known && known->quantity != Quantity::temperature)
    throw usage_error("E0702", so_far.file)
        .says("the channel {} is in {}, which is not a temperature", name, unit)
        .hint("choose a channel in degC, K or degF, or one without a unit, which is taken for degC");
  if (channels.size() < 2)
    throw usage_error("E0702", so_far.file).says("{} is the only channel: no other channel can depend on it", name);
  temperature_options_ = options_;
  temperature_options_.data = SampleKind::rate;
}

// In degC or K: what is said per degree is said per K.
void ChannelStages::give_temperature(const LogInfo& log) {
  const Channel& channel = log.channels[temperature_index_];
  auto record = std::make_shared<TemperatureRecord>();
  record->name = channel.name;
  const std::span<const double> kept = stages_[temperature_index_].kept();
  record->samples.assign(kept.begin(), kept.end());
  LeafStage(temperature_options_, workspace_.welch).make_rate(record->samples);
  const auto unit = find_unit(channel.unit);
  record->unit = unit && unit->symbol == "K" ? "K" : "°C";
  if (unit && unit->symbol == "°F")
    for (double& value : record->samples) value = (value - 32) * unit->to_si;
  check_temperature(*record, log.time.rate_hz > 0 ? log.time.rate_hz : 1);
  temperature_ = record;
  for (std::size_t c = 0; c < stages_.size(); ++c)
    if (c != temperature_index_) stages_[c].set_temperature(temperature_);
}

// More than a leaf, of which something needs all samples, and more than is allowed.
bool ChannelStages::refused() const {
  return !needs_all_samples_.empty() && rows_ > kLeafSamples &&
         rows_ * stages_.size() * sizeof(double) > options_.memory_bytes;
}

// The log was read to its end for this sentence: only then is it known how much memory would do.
void ChannelStages::refuse(const LogInfo& log) const {
  const std::uint64_t allowed = options_.memory_bytes;
  const std::uint64_t unit = allowed < (1U << 20U) ? 1U << 10U : 1U << 20U;
  const std::string_view name = allowed < (1U << 20U) ? "KiB" : "MiB";
  const std::uint64_t needed = (rows_ * stages_.size() * sizeof(double) + unit - 1) / unit;
  throw usage_error("E0701", log.file)
      .says("{} takes all samples at once: {} {}, and {} {} are allowed", needs_all_samples_, needed, name,
            allowed / unit, name)
      .hint("give `memory_bytes` {}{}, or read less with `channels`, `from_s`, `to_s`", needed, name);
}

std::vector<ChannelResult> ChannelStages::finish(const LogInfo& log, Progress& progress) {
  if (refused()) refuse(log);
  if (!options_.temperature.empty()) give_temperature(log);
  std::vector<ChannelResult> results(stages_.size());
  const bool thermometer = options_.temperature.empty() && detail::has_thermometer(log);
  for (std::size_t first = 0; first < stages_.size(); first += kFittedAtOnce) {
    progress.update(static_cast<double>(first_ + first) / static_cast<double>(log.channels.size()), "fitting");
    const std::size_t last = std::min(stages_.size(), first + kFittedAtOnce);
    parallel::for_each(first, last, [&](std::size_t c) {
      results[c] = stages_[c].finish(log.channels[first_ + c], log.time);
      if (!thermometer) results[c].means = {};
    });
  }
  if (thermometer) detail::ask_thermometers(results);
  for (ChannelResult& result : results) result.means = {};
  return results;
}

}  // namespace libchar
