#pragma once
// What a document says, before it is written: keys with their values, in order. JSON and YAML come from the same
// entries.

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "libchar/core/numeric/interval.hpp"

namespace libchar {

using Value =
    std::variant<std::monostate,  // null
                 bool, double, std::uint64_t, std::int64_t, std::string, std::vector<double>, std::vector<std::string>,
                 std::vector<bool>, std::vector<std::uint64_t>, Interval, std::vector<Interval>>;

/// One key of a document with its value, or with the keys below it.
struct Entry {
  enum class Form {
    value,
    block,  ///< the keys of `below`, a line each
    flow,   ///< the keys of `below` in one line of YAML
    list,   ///< `below` are elements: entries without a key, in blocks or in flow
  };
  std::string key;
  Value value = {};          ///< a list in Form::block has a line for each element
  std::string comment = "";  ///< YAML only
  bool bare = false;         ///< a text that YAML writes without quotes: a word of ours
  bool in_json = true;       ///< YAML says a null where JSON leaves the key out
  bool gap = false;          ///< YAML has an empty line in front
  Form form = Form::value;
  std::vector<Entry> below = {};
};

/// A key with keys below it.
Entry part_entry(std::string key, std::vector<Entry> below, Entry::Form form = Entry::Form::block);

/// The number, or null when it is not finite.
Value finite_or_null(double value);

/// {name, version} of this program.
Entry tool_entry(std::string_view key = "tool");

/// Numbers that are not finite are null, and so is an interval with an end that is NaN.
Json json_of(const std::vector<Entry>& entries);

/// Numbers read back to the same double in YAML 1.1 and 1.2 readers; what is not finite is null.
std::string yaml_of(const std::vector<Entry>& entries, const std::string& indent = "", bool comments = true);

// What to do with a variant, one case a type: std::visit(Match{[](double x) {…}, [](const std::string& s) {…}}, value).

namespace detail {
template <class... Cases>
struct Match : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Match(Cases...) -> Match<Cases...>;
}  // namespace detail

}  // namespace libchar
