#include "libchar/characterize/stretches.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "libchar/characterize/detail/channel_stage.hpp"
#include "libchar/characterize/detail/leaf_tree.hpp"
#include "libchar/characterize/detail/stretch_order.hpp"
#include "libchar/characterize/detail/stretch_state.hpp"
#include "libchar/characterize/settings.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/file_text.hpp"
#include "libchar/core/free_memory.hpp"
#include "libchar/core/json.hpp"
#include "libchar/core/sha256.hpp"
#include "libchar/core/version.hpp"
#include "libchar/log/channel_names.hpp"

namespace libchar {
namespace {

/// As a streamed log has them: the segment in samples.
CharacterizeOptions in_samples(const LogInfo& log, CharacterizeOptions options) {
  const double rate_hz = options.reading.rate_hz.value_or(log.time.rate_hz);
  if (options.wanted.spectrum && options.spectrum.segment == 0 && options.segment_s > 0)
    options.spectrum.segment = segment_samples(options.segment_s, rate_hz);
  options.spectrum = streamed_spectrum(options.spectrum);
  return options;
}

std::vector<LeafStage> stages_for(std::size_t channels,
                                  const CharacterizeOptions& options,
                                  CharacterizeWorkspace& workspace,
                                  std::uint64_t samples) {
  std::vector<LeafStage> stages;
  for (std::size_t c = 0; c < channels; ++c)
    stages.emplace_back(options, workspace.welch, samples);
  return stages;
}

/// The samples of one leaf.
struct LeafSamples final : BlockSink {
  std::vector<std::vector<double>> channels;
  void begin(const LogInfo& log) override {
    channels.resize(log.channels.size());
    for (std::vector<double>& channel : channels) channel.clear();
  }
  void block(const SampleBlock& samples) override {
    for (std::size_t c = 0; c < channels.size(); ++c)
      channels[c].insert(
          channels[c].end(), samples.channels[c], samples.channels[c] + samples.rows);
  }
};

void check_range(const std::string& path, StretchRange range, std::uint64_t leaves) {
  if (range.first_leaf < range.end_leaf && range.end_leaf <= leaves) return;
  throw Error({ErrorKind::usage,
               "E0727",
               path,
               fmt::format("the log has {} leaves of {} samples; a stretch is of some of them",
                           leaves,
                           kLeafSamples),
               fmt::format("{}..{}", range.first_leaf, range.end_leaf),
               fmt::format("choose from 0..{}", leaves)});
}

/// What is the same whichever leaf a head was read with.
void keep_head(LogInfo read, LogInfo& log) {
  Warnings warnings = std::move(log.warnings);
  warnings.merge(read.warnings);
  log = std::move(read);
  log.warnings = std::move(warnings);
}

/// The nodes of a state into the tree; they are of its range, and follow each other.
void add_nodes(StateReader& from,
               const StretchHead& head,
               const std::vector<LeafStage>& stages,
               LeafTree& tree) {
  std::uint64_t next = head.range.first_leaf;
  for (std::size_t left = read_node_count(from); left > 0; --left) {
    LeafNode node = read_node(from, stages);
    if (node.first_leaf() != next) from.refuse("its nodes do not follow each other");
    next = std::min(node.end_leaf(), leaves_of(head.samples));
    const std::uint64_t samples =
        std::min(next * kLeafSamples, head.samples) - node.first_leaf() * kLeafSamples;
    for (const ChannelSums& sums : node.channels)
      for (const std::uint64_t seen : {sums.allan.samples,
                                       sums.spectrum.samples,
                                       sums.trace.samples(),
                                       sums.cleaned ? sums.cleaned->allan.samples : 0})
        if (seen != samples && seen != 0)  // 0: of what was not asked for
          from.refuse("a node has another number of samples than its leaves");
    tree.add(std::move(node));
  }
  if (next != head.range.end_leaf) from.refuse("its nodes are not those of its range");
  from.finish();
}

/// Counts are those of the whole log, and channels without a value are named as read_log names them.
void finish_log(std::uint64_t samples, const std::vector<ChannelSums>& sums, LogInfo& log) {
  log.rows = log.rows_used = log.samples = samples;
  std::size_t with_values = 0;
  for (std::size_t c = 0; c < sums.size(); ++c) {
    if (sums[c].quality.finish().samples > 0)
      ++with_values;
    else
      log.warnings.add("no_finite_value",
                       "channels without any finite value",
                       "channel " + log.channels[c].name);
  }
  if (with_values == 0)
    throw Error({ErrorKind::input, "E0318", log.file, "no channel has a finite value", "", ""});
}

std::vector<ChannelResult> finish_channels(std::vector<ChannelSums> sums,
                                           const LogInfo& log,
                                           const CharacterizeOptions& options,
                                           CharacterizeWorkspace& workspace,
                                           Progress& progress) {
  constexpr std::size_t kAtOnce = 2;
  std::vector<ChannelResult> results(sums.size());
  for (std::size_t first = 0; first < sums.size(); first += kAtOnce) {
    progress.update(static_cast<double>(first) / static_cast<double>(sums.size()), "fitting");
    tbb::parallel_for(first, std::min(sums.size(), first + kAtOnce), [&](std::size_t c) {
      ChannelStage stage(options, workspace);
      stage.take_leaves(std::exchange(sums[c], {}));
      results[c] = stage.finish(log.channels[c], log.time.rate_hz);
    });
  }
  return results;
}

}  // namespace

std::uint64_t leaves_of(std::uint64_t samples) {
  return samples / kLeafSamples + (samples % kLeafSamples != 0 ? 1 : 0);
}

std::string why_not_divided(const LogInfo& log, const CharacterizeOptions& options) {
  std::string why = why_no_rows(log);
  const std::string all = what_needs_all_samples(options);
  if (why.empty() && !all.empty()) why = fmt::format("{} takes all samples at once", all);
  if (why.empty() && (options.still.search || options.still.stretch_s))
    why = "a still stretch is a part of it already";
  if (why.empty() && (options.reading.from_s || options.reading.to_s))
    why = "`from_s` and `to_s` are a part of it already";
  if (why.empty() && options.wanted.spectrum)
    why = WelchParts::why_not(in_samples(log, options).spectrum, kLeafSamples);
  return why.empty() ? "" : "the log cannot be taken in stretches: " + why;
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

std::string characterize_stretch(const std::string& path,
                                 const CharacterizeOptions& options,
                                 StretchRange range,
                                 const std::string& identity,
                                 Progress& progress) {
  StretchState state;
  state.log = read_log_head(path, options.reading);
  if (std::string why = why_not_divided(state.log, options); !why.empty())
    throw Error({ErrorKind::usage, "E0726", path, std::move(why), "", ""});
  const std::uint64_t samples = state.log.rows, leaves = leaves_of(samples);
  check_range(path, range, leaves);
  state.head = {identity, settings_digest(options), range, samples};
  const CharacterizeOptions chosen = in_samples(state.log, options);
  CharacterizeWorkspace workspace;
  std::vector<LeafStage> stages = stages_for(state.log.channels.size(), chosen, workspace, samples);
  LeafTree tree(stages);
  LeafSamples read;
  tbb::task_arena arena(options.reading.threads > 0 ? options.reading.threads
                                                    : tbb::task_arena::automatic);
  for (std::uint64_t leaf = range.first_leaf; leaf < range.end_leaf; ++leaf) {
    progress.update(static_cast<double>(leaf - range.first_leaf) /
                        static_cast<double>(range.end_leaf - range.first_leaf),
                    "reading " + path);
    keep_head(read_rows(path,
                        options.reading,
                        leaf * kLeafSamples,
                        std::min((leaf + 1) * kLeafSamples, samples),
                        read),
              state.log);
    arena.execute([&] {
      LeafNode node{0, leaf, std::vector<ChannelSums>(stages.size())};
      tbb::parallel_for(std::size_t{0}, stages.size(), [&](std::size_t c) {
        node.channels[c] = stages[c].take(read.channels[c], leaf + 1 == leaves);
      });
      tree.add(std::move(node));
    });
  }
  read = {};
  return write_stretch(state, tree.nodes());
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

Characterization characterize_from_stretches(std::span<const NamedState> states,
                                             const CharacterizeOptions& options,
                                             Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const WorkMeter work;
  const std::vector<OrderedState> ordered = states_in_order(states, settings_digest(options));
  CharacterizeWorkspace workspace;
  CharacterizeOptions chosen = options;
  std::vector<LeafStage> stages;
  LeafTree tree(stages);
  Characterization result;
  for (const OrderedState& one : ordered) {
    progress.update(-1, "reading " + one.state->name);
    const std::string bytes = one.state->bytes();
    StateReader from = stretch_reader(bytes, one.state->name);
    StretchState state = read_stretch(from);
    if (stages.empty()) {
      chosen = in_samples(state.log, options);
      stages = stages_for(state.log.channels.size(), chosen, workspace, state.head.samples);
    }
    if (state.log.channels.size() != stages.size()) from.refuse("the number of its channels");
    add_nodes(from, state.head, stages, tree);
    if (one.state == ordered.front().state)
      result.log = std::move(state.log);
    else
      result.log.warnings.merge(state.log.warnings);
  }
  std::vector<ChannelSums> whole = tree.whole();
  finish_log(ordered.front().head.samples, whole, result.log);
  give_back_free_memory();  // the transform of a long series of means takes much of its own
  // The result says where nothing was asked for.
  if (options.spectrum.segment == 0 && !(options.segment_s > 0)) chosen.spectrum.segment = 0;
  result.channels = finish_channels(std::move(whole), result.log, chosen, workspace, progress);
  result.work = work.done();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace libchar
