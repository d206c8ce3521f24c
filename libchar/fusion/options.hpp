#pragma once
// Numbers that change how an algorithm works: a table of rows next to the algorithm, values set by name.

#include <span>
#include <string_view>
#include <vector>

namespace libchar::fusion {

/// One row of an algorithm's table; serves `--set NAME.OPTION=VALUE`, scenes, JSON and the pages on algorithms.
struct Option {
  std::string_view name;
  std::string_view unit;     ///< "" for a pure number
  double standard = 0;       ///< the value unless stated otherwise
  double low = 0, high = 0;  ///< both allowed; infinite where there is no limit
  std::string_view meaning;
  bool whole = false;  ///< takes whole numbers only
};

/// The values of one algorithm's options, in the order of its table.
class Settings {
 public:
  explicit Settings(std::span<const Option> table = {});
  /// Throws Error(usage): no such option (with the nearest one), not finite, out of range, not whole.
  void set(std::string_view name, double value);
  /// The name must be one of the table.
  double operator[](std::string_view name) const;
  std::span<const Option> table() const { return table_; }
  std::span<const double> values() const { return values_; }

 private:
  std::span<const Option> table_;
  std::vector<double> values_;
};

}  // namespace libchar::fusion
