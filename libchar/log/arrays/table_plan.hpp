#pragma once
// Which arrays of a container form which table: found once, before anything is read.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "libchar/log/arrays/log_array.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

/// Where the values of a field of a table stand.
struct TableField {
  std::size_t array = 0;     ///< in the container's list
  std::uint64_t column = 0;  ///< of that array
  std::uint64_t byte = 0;    ///< within an element
  NumberFormat number;
  bool integer = false;
};

struct ArrayTable {
  LogTopic topic;
  std::vector<TableField> fields;  ///< beside topic.fields
  double rate_hz = 0;              ///< stated, for want of stamps
};

struct TablePlan {
  std::vector<ArrayTable> tables;  ///< the longest first, those that cannot be read at the end
  std::vector<ArrayRows> rows;     ///< of each array of the container
  std::vector<std::string> said;   ///< what was decided, in words
};

/// `single` gives the number that array i of one element holds. Throws Error(input) E0307 for two arrays of one name.
TablePlan plan_tables(const ArrayContainer& container, const std::function<double(std::size_t array)>& single,
                      const std::string& file);

}  // namespace libchar
