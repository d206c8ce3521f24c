#include "libchar/core/document/json.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "libchar/core/document/document.hpp"
#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

void check_finite(const Json& node) {
  if (node.is_number_float() && !std::isfinite(node.get<double>()))
    throw std::logic_error("a non-finite number reached a JSON document");
  if (node.is_structured())
    for (const Json& child : node) check_finite(child);
}

// nlohmann would throw, or write U+FFFD: what was there is kept readable instead.
void escape_strings(Json& node) {
  const auto bad = [](const std::string& text) { return first_invalid_utf8(text) != std::string_view::npos; };
  if (node.is_string() && bad(node.get_ref<const std::string&>())) node = printable(node.get_ref<const std::string&>());
  if (node.is_array())
    for (Json& child : node) escape_strings(child);
  if (!node.is_object()) return;
  Json copy = Json::object();
  for (auto& [key, child] : node.items()) {
    escape_strings(child);
    copy[bad(key) ? printable(key) : key] = std::move(child);
  }
  node = std::move(copy);
}

bool all_utf8(const Json& node) {
  if (node.is_string()) return first_invalid_utf8(node.get_ref<const std::string&>()) == std::string_view::npos;
  if (node.is_array())
    for (const Json& child : node)
      if (!all_utf8(child)) return false;
  if (node.is_object())
    for (const auto& [key, child] : node.items())
      if (first_invalid_utf8(key) != std::string_view::npos || !all_utf8(child)) return false;
  return true;
}

// Builds what the events say; of a key that is repeated the first is found.
class LooseReader : public nlohmann::json_sax<Json> {
 public:
  explicit LooseReader(const std::vector<std::string_view>& members) : members_(members) {}
  Json take() { return std::move(root_); }

  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t&) override { return put(value); }
  bool string(string_t& value) override { return put(std::move(value)); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    if (open_.size() == 1 && !members_.empty())
      skipping_ = std::find(members_.begin(), members_.end(), name) == members_.end();
    key_ = std::move(name);
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

 private:
  Json* place(Json value) {
    if (open_.empty()) return &(root_ = std::move(value));
    Json& parent = *open_.back();
    if (parent.is_object()) return &detail::add_member(parent, std::move(key_), std::move(value));
    parent.push_back(std::move(value));
    return &parent.back();
  }
  bool put(Json value) {
    if (!skipping_) place(std::move(value));
    return true;
  }
  bool open(Json value) {
    if (open_.size() >= kMaxDocumentDepth) return false;
    open_.push_back(skipping_ ? nullptr : place(std::move(value)));
    return true;
  }
  bool close() {
    open_.pop_back();
    if (open_.size() == 1) skipping_ = false;
    return true;
  }

  const std::vector<std::string_view>& members_;
  Json root_;
  std::vector<Json*> open_;  // nothing is added beside an open one, so that it stays where it is
  std::string key_;
  bool skipping_ = false;  // a member of the outermost object that nobody asked for
};

}  // namespace

Json& detail::add_member(Json& object, std::string key, Json value) {
  return object.get_ref<Json::object_t&>().Container::emplace_back(std::move(key), std::move(value)).second;
}

Json detail::parse_loose_json(std::string_view text, const std::vector<std::string_view>& members) {
  LooseReader reader(members);
  return Json::sax_parse(text, &reader) ? reader.take() : Json(Json::value_t::discarded);
}

Json json_number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json json_number(const std::optional<double>& value) { return value ? json_number(*value) : Json(nullptr); }

std::string json_text(std::string_view text) {
  return first_invalid_utf8(text) == std::string_view::npos ? std::string(text) : printable(text);
}

Json with_valid_text(Json document) {
  if (!all_utf8(document)) escape_strings(document);
  return document;
}

std::string dump_json(const Json& document) {
  check_finite(document);
  try {
    return document.dump(2) + "\n";
  } catch (const Json::type_error&) {  // a text that is not UTF-8
    return with_valid_text(document).dump(2) + "\n";
  }
}

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
      for (std::size_t i = 0; i < was.size(); ++i) compare(at + "/" + std::to_string(i), was[i], now[i]);
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
    found.push_back({at, excerpt(was), excerpt(now), std::abs(a - b) / std::max(std::abs(a), std::abs(b))});
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
      if (!is_ignored(key) && !was.contains(key)) found.push_back({at + "/" + key, "nothing", excerpt(value)});
  }
  const std::vector<std::string>& ignored_;
};

}  // namespace

std::vector<JsonDifference> json_differences(const Json& was, const Json& now,
                                             const std::vector<std::string>& ignored) {
  Comparison comparison(ignored);
  comparison.compare("", was, now);
  return std::move(comparison.found);
}

}  // namespace libchar
