#include "libchar/fusion/options.hpp"

#include <cassert>
#include <cmath>
#include <string>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/spelling.hpp"

namespace libchar::fusion {
namespace {

std::string range_of(const Option& option) {
  std::string text = option.whole ? "a whole number" : "a number";
  if (std::isfinite(option.low)) text += " of at least " + shortest(option.low);
  if (std::isfinite(option.high))
    text += (std::isfinite(option.low) ? " and at most " : " of at most ") + shortest(option.high);
  if (!option.unit.empty()) text += ", in " + std::string(option.unit);
  return text;
}

[[noreturn]] void unknown(std::span<const Option> table, std::string_view name) {
  std::vector<std::string> names;
  for (const Option& option : table) names.emplace_back(option.name);
  throw usage_error("E0850")
      .says("no such option")
      .got(std::string(name))
      .hint(did_you_mean(nearest(name, names),
                         names.empty() ? "this algorithm has no options" : "its options are " + first_names(names)));
}

}  // namespace

Settings::Settings(std::span<const Option> table) : table_(table) {
  for (const Option& option : table) values_.push_back(option.standard);
}

void Settings::set(std::string_view name, double value) {
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const Option& option = table_[i];
    if (option.name != name) continue;
    // Written so that NaN fails.
    const bool fits = value >= option.low && value <= option.high && std::isfinite(value) &&
                      (!option.whole || value == std::floor(value));
    if (!fits) throw usage_error("E0851").says(std::string(name) + " takes " + range_of(option)).got(shortest(value));
    values_[i] = value;
    return;
  }
  unknown(table_, name);
}

double Settings::operator[](std::string_view name) const {
  for (std::size_t i = 0; i < table_.size(); ++i)
    if (table_[i].name == name) return values_[i];
  assert(false && "an option that is not in the table");
  return std::nan("");
}

}  // namespace libchar::fusion
