#include "libchar/characterize/detail/channel_stages.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "libchar/core/error.hpp"
#include "libchar/core/pattern.hpp"
#include "libchar/core/spelling.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

// Where a segment was asked for nothing needs the whole record; short logs are still kept, because exact
// forms cost nothing there.
constexpr std::uint64_t kSmallLogBytes = std::uint64_t{64} << 20U;

constexpr std::size_t kFittedAtOnce = 2;

/// Curves, fit and their part of the reports take up to .6 MB a channel, which all stand in memory in the end.
constexpr std::size_t kMostFitted = 5000;

void refuse_too_many(const LogInfo& log) {
  if (log.channels.size() > kMostFitted)
    throw Error({ErrorKind::input,
                 "E0707",
                 log.file,
                 fmt::format("{} channels are more than are characterized at a time, {}",
                             log.channels.size(),
                             kMostFitted),
                 "",
                 "choose some of them with `channels`"});
}

std::uint64_t budget_of(const CharacterizeOptions& options) {
  const bool whole_record_needed =
      options.wanted.spectrum && options.spectrum.segment == 0 && !(options.segment_s > 0);
  return whole_record_needed || !what_needs_all_samples(options).empty()
             ? options.memory_bytes
             : std::min(options.memory_bytes, kSmallLogBytes);
}

}  // namespace

ChannelStages::ChannelStages(const CharacterizeOptions& options, CharacterizeWorkspace& workspace)
    : options_(options),
      workspace_(workspace),
      budget_(budget_of(options)),
      needs_all_samples_(what_needs_all_samples(options)) {}

void ChannelStages::begin(const LogInfo& so_far) {
  const std::size_t channels = so_far.channels.size();
  if (options_.wanted.quality && options_.wanted.fit) refuse_too_many(so_far);
  if (options_.wanted.spectrum && options_.spectrum.segment == 0 && options_.segment_s > 0)
    options_.spectrum.segment = segment_samples(options_.segment_s, so_far.time.rate_hz);
  if (!options_.temperature.empty()) find_temperature(so_far);
  for (std::size_t c = 0; c < channels; ++c)
    stages_.emplace_back(
        !options_.temperature.empty() && c == temperature_index_ ? temperature_options_ : options_,
        workspace_);
  arena_.initialize(threads_beside_reading(so_far, options_.reading.threads));
  too_long_ = needs_all_samples_.empty() && surely_too_long(so_far);
  if (too_long_) return;
  // No value takes less than a byte of the file, and no more than the budget is kept.
  const std::uint64_t most =
      std::min(so_far.bytes, budget_ / sizeof(double)) / std::max<std::size_t>(channels, 1);
  for (ChannelStage& stage : stages_) stage.reserve(most);
}

void ChannelStages::block(const SampleBlock& samples) {
  bytes_ += samples.rows * samples.channels.size() * sizeof(double);
  if (bytes_ > budget_) too_long_ = true;
  if (refused()) return drop_all();
  arena_.execute([&] {
    tbb::parallel_for(std::size_t{0}, stages_.size(), [&](std::size_t c) {
      if (too_long_) stages_[c].stop_keeping();
      stages_[c].push({samples.channels[c], samples.rows});
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
      throw Error({ErrorKind::usage,
                   "E0702",
                   log.file,
                   "several channels match this pattern, and one is the `temperature`",
                   wanted,
                   "`temperature` " + *found + " is the first of them"});
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
    throw Error({ErrorKind::usage,
                 "E0702",
                 so_far.file,
                 "there is no channel of this name to be the `temperature`",
                 wanted,
                 did_you_mean(near, "it has " + first_names(names))});
  }
  temperature_index_ = *found;
  const std::string& name = channels[temperature_index_].name;
  const std::string& unit = channels[temperature_index_].unit;
  const auto known = find_unit(unit);
  if (known && known->quantity != Quantity::temperature)
    throw Error({ErrorKind::usage,
                 "E0702",
                 so_far.file,
                 fmt::format("the channel {} is in {}, which is no temperature", name, unit),
                 "",
                 "choose a channel in degC, K or degF, or one without a unit, which is taken for "
                 "degC"});
  if (channels.size() < 2)
    throw Error({ErrorKind::usage,
                 "E0702",
                 so_far.file,
                 fmt::format("{} is the only channel: there is none that it could move", name),
                 "",
                 ""});
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
  const auto unit = find_unit(channel.unit);
  record->unit = unit && unit->symbol == "K" ? "K" : "°C";
  if (unit && unit->symbol == "°F")
    for (double& value : record->samples) value = (value - 32) * unit->to_si;
  check_temperature(*record, log.time.rate_hz > 0 ? log.time.rate_hz : 1);
  temperature_ = record;
  for (std::size_t c = 0; c < stages_.size(); ++c)
    if (c != temperature_index_) stages_[c].set_temperature(temperature_);
}

std::vector<std::size_t> ChannelStages::need_second_pass() const {
  std::vector<std::size_t> out;
  for (std::size_t c = 0; c < stages_.size(); ++c)
    if (stages_[c].needs_second_pass()) out.push_back(c);
  return out;
}

bool ChannelStages::refused() const {
  return too_long_ && !needs_all_samples_.empty();
}

void ChannelStages::drop_all() {
  for (ChannelStage& stage : stages_) stage.drop();
}

// The log was read to its end for this sentence: only then is it known how much memory would do.
void ChannelStages::refuse(const LogInfo& log) const {
  const std::uint64_t unit = budget_ < (1U << 20U) ? 1U << 10U : 1U << 20U;
  const std::string_view name = budget_ < (1U << 20U) ? "KiB" : "MiB";
  const std::uint64_t needed = (bytes_ + unit - 1) / unit;
  throw Error({ErrorKind::usage,
               "E0701",
               log.file,
               fmt::format("{} takes all samples at once: {} {}, and {} {} are allowed",
                           needs_all_samples_,
                           needed,
                           name,
                           budget_ / unit,
                           name),
               "",
               fmt::format("give `memory_bytes` {}{}, or read less with `channels`, `from_s`, "
                           "`to_s`",
                           needed,
                           name)});
}

std::vector<ChannelResult> ChannelStages::finish(const LogInfo& log, Progress& progress) {
  if (refused()) refuse(log);
  if (!options_.temperature.empty()) give_temperature(log);
  std::vector<ChannelResult> results(stages_.size());
  for (std::size_t first = 0; first < stages_.size(); first += kFittedAtOnce) {
    progress.update(static_cast<double>(first) / static_cast<double>(stages_.size()), "fitting");
    const std::size_t last = std::min(stages_.size(), first + kFittedAtOnce);
    tbb::parallel_for(first, last, [&](std::size_t c) {
      results[c] = stages_[c].finish(log.channels[c], log.time.rate_hz);
    });
  }
  return results;
}

// Samples that will not be kept in the end need not be kept in the beginning. What is expected may
// be wrong by a factor; a log that would just fit must not be streamed for that.
bool ChannelStages::surely_too_long(const LogInfo& so_far) const {
  constexpr double kDoubt = 4;
  const bool window = options_.reading.from_s || options_.reading.to_s;
  const double bytes = static_cast<double>(so_far.rows) *
                       static_cast<double>(so_far.channels.size()) * sizeof(double);
  return !window && bytes > kDoubt * static_cast<double>(budget_);
}

SecondPass::SecondPass(ChannelStages& first, std::vector<std::size_t> channels, int threads)
    : stages_(first.stages()), channels_(std::move(channels)), threads_(threads) {
  for (const std::size_t c : channels_) stages_[c].begin_second_pass();
}

void SecondPass::begin(const LogInfo& so_far) {
  arena_.initialize(threads_beside_reading(so_far, threads_));
}

void SecondPass::block(const SampleBlock& samples) {
  arena_.execute([&] {
    tbb::parallel_for(std::size_t{0}, channels_.size(), [&](std::size_t k) {
      const std::size_t c = channels_[k];
      stages_[c].push({samples.channels[c], samples.rows});
    });
  });
}

}  // namespace libchar
