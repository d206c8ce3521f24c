#pragma once
// Which columns of a log the options ask for: by name, by position c0, c1…, or by a pattern.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/log/read.hpp"

namespace libchar {

struct TableColumns {
  std::vector<std::string> names;
  std::vector<std::string> texts;        ///< as written, where that differs from the names; else empty
  std::optional<std::size_t> time;       ///< the time column, which is no channel
  std::optional<std::size_t> more_time;  ///< the rest of its stamps
  std::vector<std::size_t> left_out;     ///< no channels unless they are asked for
  bool positions_skip_time = false;      ///< c0, c1… count the columns that are not the time (else all)
};

/// The columns of options.channels, or all but the time, in file order, without those of "!name".
/// Throws Error(usage) for an unknown name, with the nearest known one, and Error(input) when nothing is left.
std::vector<std::size_t> choose_channels(const TableColumns& table, const ReadOptions& options,
                                         const std::string& file);

/// Throws Error(usage): no channel of this name, or none that matches this pattern.
[[noreturn]] void refuse_channel(const std::string& wanted, const std::vector<std::string>& names,
                                 const ReadOptions& options, const std::string& file);

/// What to say of a channel that is not in the log: the nearest of its names, or all of them; that
/// --names give new names to what -c chooses, when the word is one of those.
std::string channel_hint(const std::string& wanted, const std::vector<std::string>& names, const ReadOptions& options);

/// "!temp": all but those.
bool excludes(std::string_view word);

/// Does a word of options.channels say which to read, and not only which not to?
bool chooses(const ReadOptions& options);

/// k of a word "ck" with k < count.
std::optional<std::size_t> position_in(std::string_view word, std::size_t count);

}  // namespace libchar
