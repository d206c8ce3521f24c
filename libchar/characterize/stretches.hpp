#pragma once
// One long log characterized by many machines, and merged exactly (docs/theory/stretches.md).
//
// A log is divided in leaves of 2^20 samples (the last may be short); a stretch is a range of whole leaves. Leaves are
// taken one by one and joined in a tree that depends on their numbers only. So the result has the same bits, however
// the log was divided in stretches and in whatever order their states arrive.
//
//   const LogInfo head = read_log_head(path, options.reading);  // channel_names.hpp. head.rows: samples.
//   if (const auto why = why_not_divided(head, options); !why.empty()) …  // Not every log can be divided.
//   const std::uint64_t leaves = leaves_of(head.rows);
//   // On one machine; one file per channel. On another: {leaves / 2, leaves}.
//   characterize_stretch(path, options, {0, leaves / 2}, sha256_of_the_log, sink);
//   …
//   result = characterize_from_stretches({{state_in_file("a.state"), state_in_file("b.state")}}, options);

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/core/numeric/leaf_tree.hpp"

namespace libchar {

/// Leaves first_leaf … end_leaf - 1.
struct StretchRange {
  std::uint64_t first_leaf = 0, end_leaf = 0;
};

/// How many leaves a log of this many samples has.
std::uint64_t leaves_of(std::uint64_t samples);

/// "" or why this log, or what these options ask for, cannot be divided: "its rows have no fixed
/// places (csv)". `log`: its head (read_log_head).
std::string why_not_divided(const LogInfo& log, const CharacterizeOptions& options);

/// Takes the partial states of a stretch, a channel each in their order, as bytes for a file.
using StateSink = std::function<void(const std::string& bytes)>;

/// The partial states of all channels over some leaves. Nothing before them is read, and nothing of the whole log
/// is: `identity` (its digest, or whatever tells it from others) goes into the states as it is. Three channels are
/// taken in one pass over the rows. Memory: that of three, each 8 MB and some 1 MB for each of up to 2 log2(leaves)
/// nodes of the tree. Throws Error(usage) where the log or the options cannot be divided (E0726) or the range is not
/// in the log (E0727), Error(input) as read_log.
void characterize_stretch(const std::string& path, const CharacterizeOptions& options, StretchRange range,
                          const std::string& identity, const StateSink& sink, Progress& progress = no_progress());

/// A state under the name that messages have for it. It is read twice, one state at a time: they
/// need not be in memory together.
struct NamedState {
  std::string name;
  std::function<std::string()> bytes;
};
NamedState state_in_memory(std::string name, std::string bytes);
NamedState state_in_file(const std::string& path);

/// What a state says of itself.
struct StretchHead {
  std::string identity;  ///< as it was given
  std::string settings;  ///< digest of the options that a state depends on (settings_digest)
  StretchRange range;
  std::uint64_t samples = 0;                ///< of the whole log
  std::uint64_t channel = 0, channels = 0;  ///< which one it is of, from 0; and of how many
};

/// Reads and checks a whole state. Throws Error(input) by name: not a state, damaged, cut, of another version (E0723).
StretchHead stretch_head(const NamedState& state);

/// Digest of the options that a state depends on, and of the program's version. Threads, memory and
/// the like are not among them.
std::string settings_digest(const CharacterizeOptions& options);

/// Joins the states of all channels, in any order, to what one machine would have found, one channel at a time. Throws
/// Error(input) by name for a state that is damaged or not a state (E0723), and for one of another log or of other
/// settings (E0724). Throws it as well for leaves that two states have, or no state (E0725). Throws Error(numeric)
/// where no channel has a finite value. `log.sha256` of the result is empty: the caller knows the log.
Characterization characterize_from_stretches(std::span<const NamedState> states, const CharacterizeOptions& options,
                                             Progress& progress = no_progress());

}  // namespace libchar
