#pragma once
// Which columns of a log the options ask for: by name, or by position c0, c1… among all columns.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/log/read.hpp"

namespace libchar {

struct ColumnChoice {
  std::vector<std::size_t> values;  ///< in file order
  std::optional<std::size_t> time;
};

/// `named`: the names were read from the file, so that one called t, time or timestamp is the time
/// column unless the options say otherwise. Throws Error(usage) for an unknown name, with the
/// nearest known one.
ColumnChoice choose_columns(const std::vector<std::string>& names,
                            bool named,
                            const ReadOptions& options,
                            const std::string& file);

/// What to say of a channel that is not in the log: the nearest of its names, or all of them; that --names give new names to
/// what -c chooses, when the word is one of those.
std::string channel_hint(const std::string& wanted,
                         const std::vector<std::string>& names,
                         const ReadOptions& options);

/// Does a name say "time" ("t", "time_us", "Timestamp [ns]")?
bool is_time_name(std::string_view name);

/// The unit in such a name ("us" of "time_us"), "" when there is none.
std::string time_unit_of_name(std::string_view name);

/// The unit that stamps of this size and step are most likely in; always a guess.
std::string guess_time_unit(double first, double step, bool integer);

/// Nanoseconds in one unit ("s", "ms", "us", "ns"); 0 for another word.
std::int64_t nanoseconds_in(std::string_view unit);

}  // namespace libchar
