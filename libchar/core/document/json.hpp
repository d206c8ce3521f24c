#pragma once
// JSON at the borders: nlohmann's type, with the guards it lacks. Whoever builds a document includes
// <nlohmann/json.hpp>.

#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace libchar {

using Json = nlohmann::ordered_json;

/// Parses one JSON document strictly: no duplicate keys, no NaN or Infinity, numbers that fit a double, depth <= 64,
/// valid UTF-8, nothing after the document, at most 16 MiB. Throws Error(input) with FILE:LINE:COL (byte N).
Json parse_json(std::string_view text, const std::string& file);

namespace detail {
/// JSON of strangers, which may be large, in time linear in its size: nlohmann's own parser compares each key with all
/// before it. Of the outermost object only these members, or all if there are none named. Discarded unless it is JSON
/// of at most 64 levels.
Json parse_loose_json(std::string_view text, const std::vector<std::string_view>& members = {});
/// Adds a member that the object does not have.
Json& add_member(Json& object, std::string key, Json value);
}  // namespace detail

/// JSON has no infinity and no NaN: infinite, NaN and absent values are null; a status next to them says why.
Json json_number(double value);
Json json_number(const std::optional<double>& value);

/// The text itself when it is valid UTF-8, else escaped by `printable`: JSON carries nothing else.
std::string json_text(std::string_view text);

/// The document with every string that is not UTF-8 escaped by `printable`.
Json with_valid_text(Json document);

/// The document as text, doubles in shortest round-trip form, two-space indent, newline at the end. Strings that are
/// not UTF-8 are escaped by `printable`. A NaN or infinity in the document is a programmer's mistake and throws.
std::string dump_json(const Json& document);

// Where two documents differ, and by how many digits their numbers agree.

struct JsonDifference {
  std::string at;        ///< "/fit/0/terms/1/value"
  std::string was, now;  ///< short
  /// of numbers: |now - was| over the larger; infinite for anything else, and for what is missing on a side
  double relative = std::numeric_limits<double>::infinity();
};

/// Differences in order of the first document; members named in `ignored` are skipped at every depth.
std::vector<JsonDifference> json_differences(const Json& was, const Json& now,
                                             const std::vector<std::string>& ignored = {});

}  // namespace libchar
