#include "libchar/characterize/stretches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "libchar/characterize/detail/channel_stage.hpp"
#include "libchar/characterize/detail/rest_doubt.hpp"
#include "libchar/characterize/detail/stretch_state.hpp"
#include "libchar/characterize/settings.hpp"
#include "libchar/core/file/file_text.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/process/free_memory.hpp"
#include "libchar/core/process/version.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/log/channel_names.hpp"

namespace libchar {
namespace {

// States of stretches as they arrive: are they of one log, and do they cover it?

struct OrderedState {
  const NamedState* state;
  StretchHead head;
};

void check_log(const OrderedState& one, const OrderedState& first, const std::string& settings) {
  const StretchHead &head = one.head, &other = first.head;
  if (head.identity != other.identity || head.samples != other.samples || head.channels != other.channels)
    throw input_error("E0724", one.state->name)
        .says("is of another log than {}: {} of {} samples of {} channels, not {} of {} of {}", first.state->name,
              head.identity, head.samples, head.channels, other.identity, other.samples, other.channels)
        .hint("join states of one log");
  if (head.settings != settings)
    throw input_error("E0724", one.state->name)
        .says("was made with other settings, or by another version of the program")
        .hint("give the settings of all stretches, and make them with one version");
}

/// " of channel 2" where there are several.
std::string of_channel(const StretchHead& head) {
  return head.channels > 1 ? fmt::format(" of channel {}", head.channel + 1) : "";
}

[[noreturn]] void refuse_hole(const OrderedState& at, std::uint64_t first, std::uint64_t last, const char* where) {
  throw input_error("E0725", at.state->name)
      .says("no state has the leaves {} to {}{} {} it", first, last, of_channel(at.head), where)
      .hint("characterize that stretch, and give its state");
}

/// The states of a channel, in order: do they cover the log?
void check_cover(const std::vector<OrderedState>& states) {
  std::uint64_t next = 0;
  const OrderedState* before = &states.front();
  for (const OrderedState& one : states) {
    const auto [from, end] = one.head.range;
    if (from < next)
      throw input_error("E0725", one.state->name)
          .says("covers leaf {}{}, which {} does too", from, of_channel(one.head), before->state->name)
          .hint("leave one of them out");
    if (from > next) refuse_hole(one, next, from - 1, "before");
    next = end;
    before = &one;
  }
  const std::uint64_t leaves = leaves_of(before->head.samples);
  if (next < leaves) refuse_hole(*before, next, leaves - 1, "after");
}

/// Of each channel, in the order of their leaves. Throws Error(input) by name unless they are of one log and of these
/// settings (E0724) and cover it, no leaf of a channel twice (E0725).
std::vector<std::vector<OrderedState>> states_in_order(std::span<const NamedState> states,
                                                       const std::string& settings) {
  std::vector<OrderedState> all;
  for (const NamedState& state : states) all.push_back({&state, stretch_head(state)});
  if (all.empty()) throw input_error("E0725").says("there is no state to be joined");
  std::stable_sort(all.begin(), all.end(), [](const OrderedState& a, const OrderedState& b) {
    return std::pair(a.head.channel, a.head.range.first_leaf) < std::pair(b.head.channel, b.head.range.first_leaf);
  });
  std::vector<std::vector<OrderedState>> channels;
  for (OrderedState& one : all) {
    check_log(one, all.front(), settings);
    channels.resize(detail::in_memory(all.front().head.channels));
    channels[detail::in_memory(one.head.channel)].push_back(one);
  }
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (channels[c].empty())
      throw input_error("E0725", all.front().state->name)
          .says("no state is of channel {} of {}", c + 1, channels.size())
          .hint("give the states of all channels");
    check_cover(channels[c]);
  }
  return channels;
}

/// Channels that are taken in one pass over the rows of a stretch: more of them take 15 to 30 MB
/// each, fewer take more passes.
constexpr std::size_t kAtOnce = 3;

/// The segment in samples.
CharacterizeOptions in_samples(const LogInfo& log, CharacterizeOptions options) {
  const double rate_hz = options.reading.rate_hz.value_or(log.time.rate_hz);
  if (options.wanted.spectrum && options.spectrum.segment == 0 && options.segment_s > 0)
    options.spectrum.segment = segment_samples(options.segment_s, rate_hz);
  return options;
}

/// Of one leaf, the samples of a few channels.
struct LeafSamples final : BlockSink {
  ChannelRange range;
  std::vector<std::vector<double>> channels;  ///< of the range
  explicit LeafSamples(ChannelRange wanted) : range(wanted), channels(wanted.end - wanted.first) {}
  void begin(const LogInfo&) override {
    for (std::vector<double>& channel : channels) channel.clear();
  }
  void block(const SampleBlock& samples) override {
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const double* from = samples.channels[range.first + c];
      channels[c].insert(channels[c].end(), from, from + samples.rows);
    }
  }
};

void check_range(const std::string& path, StretchRange range, std::uint64_t leaves) {
  if (range.first_leaf < range.end_leaf && range.end_leaf <= leaves) return;
  throw usage_error("E0727", path)
      .says("the log has {} leaves of {} samples; a stretch is of some of them", leaves, kLeafSamples)
      .got("{}..{}", range.first_leaf, range.end_leaf)
      .hint("choose from 0..{}", leaves);
}

/// What is the same whichever leaf a head was read with.
void keep_head(LogInfo read, LogInfo& log) {
  Findings warnings = std::move(log.warnings);
  warnings.merge(read.warnings);
  log = std::move(read);
  log.warnings = std::move(warnings);
}

/// Every part is of as many samples as the node has, or of what was not asked for.
void check_samples(const ChannelSums& sums, std::uint64_t samples, std::uint64_t whole, const StateReader& from) {
  std::vector<std::uint64_t> seen = {sums.meters.trace.samples(), sums.kept.size()};
  // Differences of a phase: the last leaf has one less.
  for (const std::uint64_t n :
       {sums.spectrum.samples, sums.record.plain.allan.samples, sums.record.plain.means.samples(),
        sums.record.cleaned ? sums.record.cleaned->allan.samples : 0})
    seen.push_back(n + 1 == samples ? samples : n);
  for (const std::uint64_t n : seen)
    if (n != samples && n != 0) from.refuse("a node has another number of samples than its leaves");
  if (whole <= kLeafSamples && samples > 0 && sums.kept.empty()) from.refuse("a log of one leaf has no samples");
}

/// The nodes of a state into the tree; they are of its range, and follow each other.
void add_nodes(StateReader& from, const StretchHead& head, const LeafStage& stage, ChannelTree& tree) {
  std::uint64_t next = head.range.first_leaf;
  for (std::size_t left = read_node_count(from); left > 0; --left) {
    ChannelNode node = read_node(from, stage);
    if (node.first_leaf() != next) from.refuse("its nodes do not follow each other");
    next = std::min(node.end_leaf(), leaves_of(head.samples));
    const std::uint64_t samples = std::min(next * kLeafSamples, head.samples) - node.first_leaf() * kLeafSamples;
    check_samples(node.sums, samples, head.samples, from);
    tree.add(std::move(node));
  }
  if (next != head.range.end_leaf) from.refuse("its nodes are not those of its range");
  from.finish();
}

/// One channel of a log, from its states.
ChannelSums joined(const std::vector<OrderedState>& states, LeafStage& stage, LogInfo& log, Progress& progress) {
  ChannelTree tree(stage);
  for (const OrderedState& one : states) {
    progress.update(-1, "reading " + one.state->name);
    const std::string bytes = one.state->bytes();
    StateReader from = stretch_reader(bytes, one.state->name);
    const StretchState state = read_stretch(from);
    add_nodes(from, state.head, stage, tree);
    log.warnings.merge(state.log.warnings);
  }
  return tree.whole();
}

/// The head of a log without what was found in it.
LogInfo head_in(const OrderedState& one) {
  const std::string bytes = one.state->bytes();
  StateReader from = stretch_reader(bytes, one.state->name);
  StretchState state = read_stretch(from);
  LogInfo log = std::move(state.log);
  log.warnings = {};
  log.rows = log.rows_used = log.samples = state.head.samples;
  return log;
}

/// A log of one leaf is looked at as a whole.
ChannelSums kept_leaf(std::vector<double> samples) {
  ChannelSums sums;
  sums.meters.push(samples);
  sums.kept = std::move(samples);
  return sums;
}

/// A pass over a stretch: the states of a few channels.
void take_channels(const std::string& path, const CharacterizeOptions& options, ChannelRange channels,
                   StretchState state, CharacterizeWorkspace& workspace, const StateSink& sink,
                   const std::function<void(std::uint64_t leaf)>& at) {
  const std::uint64_t samples = state.head.samples, leaves = leaves_of(samples);
  std::vector<LeafStage> stages;
  for (std::size_t c = channels.first; c < channels.end; ++c) stages.emplace_back(options, workspace.welch);
  std::vector<ChannelTree> trees(stages.begin(), stages.end());
  LeafSamples read(channels);
  for (std::uint64_t leaf = state.head.range.first_leaf; leaf < state.head.range.end_leaf; ++leaf) {
    at(leaf);
    const std::uint64_t first = leaf * kLeafSamples;
    keep_head(read_rows(path, options.reading, first, std::min(first + stages[0].rows(), samples), read, channels),
              state.log);
    const bool last = leaf + 1 == leaves;
    parallel::for_each(0, stages.size(), [&](std::size_t c) {
      trees[c].add(
          {0, leaf,
           last && leaf == 0 ? kept_leaf(std::move(read.channels[c])) : stages[c].take(read.channels[c], last)});
    });
  }
  read.channels.clear();
  for (std::size_t c = 0; c < stages.size(); ++c) {
    state.head.channel = channels.first + c;
    sink(write_stretch(state, trees[c].nodes()));
    state.log.warnings = {};  // said once: with the first of them
  }
}

}  // namespace

std::uint64_t leaves_of(std::uint64_t samples) {
  return samples / kLeafSamples + (samples % kLeafSamples != 0 ? 1 : 0);
}

std::string why_not_divided(const LogInfo& log, const CharacterizeOptions& options) {
  std::string why = why_no_rows(log);
  const std::string all = what_needs_all_samples(options);
  if (why.empty() && !all.empty()) why = fmt::format("{} takes all samples at once", all);
  if (why.empty() && (options.still.search || options.still.stretch_s)) why = "a still stretch is a part of it already";
  if (why.empty() && (options.reading.from_s || options.reading.to_s))
    why = "`from_s` and `to_s` are a part of it already";
  if (why.empty()) why = why_not_in_leaves(in_samples(log, options));
  return why;
}

std::string settings_digest(const CharacterizeOptions& options) {
  CharacterizeOptions kept = options;
  const ReadOptions defaults;
  kept.reading.block_bytes = defaults.block_bytes;
  kept.reading.threads = defaults.threads;
  kept.reading.hash = defaults.hash;
  kept.memory_bytes = CharacterizeOptions{}.memory_bytes;
  const Wanted& w = options.wanted;
  Sha256 digest;
  digest.update(fmt::format("{} {} {} {} {} ", version(), w.quality, w.allan, w.spectrum, w.fit));
  digest.update(json_of(settings_of(kept)).dump());
  return digest.finish();
}

void characterize_stretch(const std::string& path, const CharacterizeOptions& options, StretchRange range,
                          const std::string& identity, const StateSink& sink, Progress& progress) {
  StretchState state;
  state.log = read_log_head(path, options.reading);
  if (const std::string why = why_not_divided(state.log, options); !why.empty())
    throw usage_error("E0726", path).says("the log cannot be taken in stretches: " + why);
  const std::uint64_t samples = state.log.rows;
  check_range(path, range, leaves_of(samples));
  const std::size_t channels = state.log.channels.size();
  state.log.warnings = {};
  state.head = {identity, settings_digest(options), range, samples, 0, channels};
  const CharacterizeOptions chosen = in_samples(state.log, options);
  CharacterizeWorkspace workspace;
  parallel::Threads arena(options.reading.threads);
  const std::uint64_t leaves = range.end_leaf - range.first_leaf;
  for (std::size_t first = 0; first < channels; first += kAtOnce) {
    const ChannelRange few = {first, std::min(channels, first + kAtOnce)};
    const auto at = [&](std::uint64_t leaf) {
      const std::uint64_t done = first * leaves + (few.end - first) * (leaf - range.first_leaf);
      progress.update(static_cast<double>(done) / static_cast<double>(channels * leaves), "reading " + path);
    };
    arena.run([&] { take_channels(path, chosen, few, state, workspace, sink, at); });
    give_back_free_memory();
  }
}

NamedState state_in_memory(std::string name, std::string bytes) {
  return {std::move(name), [bytes = std::move(bytes)] { return bytes; }};
}

NamedState state_in_file(const std::string& path) {
  return {path, [path] { return file_text(path, SIZE_MAX); }};
}

StretchHead stretch_head(const NamedState& state) {
  const std::string bytes = state.bytes();
  StateReader from = stretch_reader(bytes, state.name);
  return read_stretch(from).head;
}

Characterization characterize_from_stretches(std::span<const NamedState> states, const CharacterizeOptions& options,
                                             Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const WorkMeter work;
  const auto ordered = states_in_order(states, settings_digest(options));
  Characterization result;
  result.log = head_in(ordered.front().front());
  const CharacterizeOptions chosen = in_samples(result.log, options);
  CharacterizeWorkspace workspace;
  std::size_t with_values = 0;
  for (std::size_t c = 0; c < ordered.size(); ++c) {
    const Channel& channel = result.log.channels[c];
    LeafStage leaves(chosen, workspace.welch);
    ReadChannel read;
    read.sums = joined(ordered[c], leaves, result.log, progress);
    if (read.sums.meters.quality.finish().samples > 0)
      ++with_values;
    else
      result.log.warnings.add("no_finite_value", "channels without any finite value", "channel " + channel.name);
    result.channels.push_back(finish_channel(std::move(read), chosen, workspace, channel, result.log.time));
    give_back_free_memory();
  }
  if (with_values == 0) throw input_error("E0318", result.log.file).says("no channel has a finite value");
  if (chosen.data == SampleKind::rate) detail::doubt_together(result.channels);
  result.work = work.done();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace libchar
