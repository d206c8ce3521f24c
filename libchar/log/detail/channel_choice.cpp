#include "libchar/log/detail/channel_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/detail/column_name.hpp"

namespace libchar {
namespace {

std::vector<std::size_t> all_but_time(const TableColumns& table) {
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < table.names.size(); ++i)
    if (i != table.time && i != table.more_time) columns.push_back(i);
  return columns;
}

std::vector<std::size_t> all_channels(const TableColumns& table) {
  std::vector<std::size_t> columns = all_but_time(table);
  std::erase_if(columns, [&](std::size_t i) {
    return std::find(table.left_out.begin(), table.left_out.end(), i) != table.left_out.end();
  });
  return columns;
}

std::optional<std::size_t> find_column(const TableColumns& table, const std::string& wanted) {
  const std::vector<std::size_t> values = all_but_time(table);
  for (const std::size_t i : values)
    if (table.names[i] == wanted) return i;
  for (const std::size_t i : values)
    if (i < table.texts.size() && table.texts[i] == wanted) return i;
  const auto k = position_in(wanted, table.positions_skip_time ? values.size() : table.names.size());
  if (k) return table.positions_skip_time ? values[*k] : *k;
  for (const std::size_t i : values)  // lists of names lose the blanks around them
    if (trimmed(table.names[i]) == wanted) return i;
  return std::nullopt;
}

std::size_t column_of(const TableColumns& table, const std::string& wanted, const ReadOptions& options,
                      const std::string& file) {
  const auto column = find_column(table, wanted);
  if (column && column != table.time) return *column;
  if (table.time && (column || table.names[*table.time] == wanted))
    throw usage_error("E0320", file)
        .says("this is the time column, not a channel")
        .got(wanted)
        .hint("`time_column` none reads it as a channel");
  std::vector<std::string> names;
  for (const std::size_t i : all_channels(table)) names.push_back(table.names[i]);
  refuse_channel(wanted, names, options, file);
}

// A name wins over a pattern.
std::vector<std::size_t> columns_of(const TableColumns& table, const std::string& wanted, const ReadOptions& options,
                                    const std::string& file) {
  std::vector<std::size_t> out;
  if (is_pattern(wanted) && !find_column(table, wanted))
    for (const std::size_t i : all_channels(table))
      if (matches(wanted, table.names[i]) || (i < table.texts.size() && matches(wanted, table.texts[i])))
        out.push_back(i);
  if (out.empty()) out.push_back(column_of(table, wanted, options, file));
  return out;
}

[[noreturn]] void refuse_time_alone(const TableColumns& table, const std::string& file) {
  std::vector<std::string> others;
  for (const std::size_t i : table.left_out)
    if (i != table.time && i != table.more_time) others.push_back(table.names[i]);
  throw input_error("E0310", file)
      .says(others.empty() ? "there is a time column and nothing else"
                           : "only the time column holds numbers, not " + first_names(others))
      .hint(others.empty() ? "`time_column` none reads it as a channel"
                           : "`channels` " + shell_word(others.front()) + " says what is wrong there");
}

}  // namespace

std::optional<std::size_t> position_in(std::string_view word, std::size_t count) {
  if (word.size() < 2 || word[0] != 'c') return std::nullopt;
  std::size_t index = 0;
  const char* const end = word.data() + word.size();
  const auto read = std::from_chars(word.data() + 1, end, index);
  const bool whole = read.ec == std::errc() && read.ptr == end;
  return whole && index < count ? std::optional(index) : std::nullopt;
}

bool excludes(std::string_view word) { return word.size() > 1 && word[0] == '!'; }

bool chooses(const ReadOptions& options) {
  return !std::all_of(options.channels.begin(), options.channels.end(), excludes);
}

std::string channel_hint(const std::string& wanted, const std::vector<std::string>& names, const ReadOptions& options) {
  const std::string all = first_names(names);
  if (std::find(options.names.begin(), options.names.end(), wanted) != options.names.end())
    return "`channels` chooses by the names in the log, " + all + ", and `names` then name what was chosen";
  const auto near = is_pattern(wanted) ? std::nullopt : nearest(wanted, names);
  return did_you_mean(near, "it has " + all);
}

void refuse_channel(const std::string& wanted, const std::vector<std::string>& names, const ReadOptions& options,
                    const std::string& file) {
  throw usage_error("E0320", file)
      .says(is_pattern(wanted) ? "no channel matches this pattern" : "there is no channel of this name")
      .got(wanted)
      .hint(channel_hint(wanted, names, options));
}

std::vector<std::size_t> choose_channels(const TableColumns& table, const ReadOptions& options,
                                         const std::string& file) {
  std::vector<std::size_t> chosen = all_channels(table);
  if (chosen.empty() && !chooses(options)) refuse_time_alone(table, file);
  if (options.channels.empty()) return chosen;
  if (chooses(options)) chosen.clear();
  for (const std::string& word : options.channels)
    if (!excludes(word))
      for (const std::size_t i : columns_of(table, word, options, file)) chosen.push_back(i);
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  for (const std::string& word : options.channels)
    if (excludes(word))
      for (const std::size_t i : columns_of(table, word.substr(1), options, file)) std::erase(chosen, i);
  if (chosen.empty()) throw usage_error("E0320", file).says("no channel is left").got(options.channels.back());
  return chosen;
}

}  // namespace libchar
