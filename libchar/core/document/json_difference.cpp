#include "libchar/core/document/json_difference.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace libchar {
namespace {

constexpr std::size_t kExcerpt = 60;

std::string excerpt(const Json& value) {
  std::string text = value.is_object()  ? "an object"
                     : value.is_array() ? "a list of " + std::to_string(value.size())
                                        : value.dump(-1, ' ', true);
  if (text.size() > kExcerpt) text = text.substr(0, kExcerpt) + "…";
  return text;
}

class Comparison {
 public:
  explicit Comparison(const std::vector<std::string>& ignored) : ignored_(ignored) {}

  void compare(const std::string& at, const Json& was, const Json& now) {
    if (was.is_number() && now.is_number()) return compare_numbers(at, was, now);
    if (was.is_object() && now.is_object()) return compare_objects(at, was, now);
    if (was.is_array() && now.is_array() && was.size() == now.size()) {
      for (std::size_t i = 0; i < was.size(); ++i)
        compare(at + "/" + std::to_string(i), was[i], now[i]);
      return;
    }
    if (was != now) found.push_back({at, excerpt(was), excerpt(now)});
  }

  std::vector<JsonDifference> found;

 private:
  bool is_ignored(const std::string& key) const {
    return std::find(ignored_.begin(), ignored_.end(), key) != ignored_.end();
  }
  void compare_numbers(const std::string& at, const Json& was, const Json& now) {
    if (was == now) return;
    const auto a = was.get<double>(), b = now.get<double>();
    found.push_back(
        {at, excerpt(was), excerpt(now), std::abs(a - b) / std::max(std::abs(a), std::abs(b))});
  }
  void compare_objects(const std::string& at, const Json& was, const Json& now) {
    for (const auto& [key, value] : was.items()) {
      if (is_ignored(key)) continue;
      if (now.contains(key))
        compare(at + "/" + key, value, now[key]);
      else
        found.push_back({at + "/" + key, excerpt(value), "nothing"});
    }
    for (const auto& [key, value] : now.items())
      if (!is_ignored(key) && !was.contains(key))
        found.push_back({at + "/" + key, "nothing", excerpt(value)});
  }
  const std::vector<std::string>& ignored_;
};

}  // namespace

std::vector<JsonDifference> json_differences(const Json& was,
                                             const Json& now,
                                             const std::vector<std::string>& ignored) {
  Comparison comparison(ignored);
  comparison.compare("", was, now);
  return std::move(comparison.found);
}

}  // namespace libchar
