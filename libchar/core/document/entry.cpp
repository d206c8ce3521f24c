#include "libchar/core/document/entry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "libchar/core/process/version.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

using detail::Match;

Json json_interval(const Interval& interval) {
  if (std::isnan(interval.low) || std::isnan(interval.high)) return nullptr;
  return Json::array({json_number(interval.low), json_number(interval.high)});
}

template <class T, class Element>
Json json_list(const std::vector<T>& list, const Element& element) {
  Json out = Json::array();
  out.get_ref<Json::array_t&>().reserve(list.size());
  for (const auto& one : list) out.push_back(element(one));
  return out;
}

Json json_value(const Value& value) {
  const auto number = [](double x) { return json_number(x); };
  const auto text = [](const std::string& x) { return Json(json_text(x)); };
  return std::visit(Match{[](std::monostate) { return Json(nullptr); }, [&](double x) { return number(x); },
                          [&](const std::string& x) { return text(x); },
                          [&](const std::vector<double>& list) { return json_list(list, number); },
                          [&](const std::vector<std::string>& list) { return json_list(list, text); },
                          [](const Interval& interval) { return json_interval(interval); },
                          [](const std::vector<Interval>& list) { return json_list(list, json_interval); },
                          [](const auto& plain) { return Json(plain); }},
                    value);
}

Json json_entry(const Entry& entry) {
  if (entry.form == Entry::Form::list) {
    Json list = Json::array();
    for (const Entry& element : entry.below) list.push_back(json_entry(element));
    return list;
  }
  const bool part = entry.form != Entry::Form::value && std::holds_alternative<std::monostate>(entry.value);
  return part ? json_of(entry.below) : json_value(entry.value);
}

std::string yaml_number(double value) { return std::isfinite(value) ? shortest_yaml(value) : "null"; }

std::string yaml_value(const Entry& entry) {
  const auto listed = [](const auto& list, auto text) {
    std::string out;
    for (const auto& one : list) out += (out.empty() ? "" : ", ") + text(one);
    return "[" + out + "]";
  };
  const auto interval = [&](const Interval& ends) { return listed(std::vector{ends.low, ends.high}, yaml_number); };
  return std::visit(Match{[](std::monostate) -> std::string { return "null"; },
                          [](bool value) -> std::string { return value ? "true" : "false"; },
                          [](double value) { return yaml_number(value); },
                          [&](const std::string& text) { return entry.bare ? text : quoted_yaml(text); },
                          [&](const std::vector<double>& list) { return listed(list, yaml_number); },
                          [&](const std::vector<std::string>& list) { return listed(list, quoted_yaml); },
                          [&](const Interval& ends) { return interval(ends); },
                          [&](const std::vector<Interval>& list) { return listed(list, interval); },
                          []<class T>(const std::vector<T>&) -> std::string {
                            throw std::logic_error("a list that only JSON documents have");
                          },
                          [](auto whole) { return std::to_string(whole); }},
                    entry.value);
}

std::string flow_of(const std::vector<Entry>& entries) {
  std::string inside;
  for (const Entry& entry : entries)
    inside += fmt::format("{}{}: {}", inside.empty() ? "" : ", ", entry.key, yaml_value(entry));
  return "{" + inside + "}";
}

// The elements of a list, each with a dash in front.
std::string list_of(const Entry& entry, const std::string& indent, bool comments) {
  std::string out;
  for (const Entry& element : entry.below) {
    if (element.form == Entry::Form::flow) {
      out += indent + "  - " + flow_of(element.below) + "\n";
      continue;
    }
    const std::string block = yaml_of(element.below, indent + "    ", comments);
    out += indent + "  - " + block.substr(std::min(block.size(), indent.size() + 4));
  }
  return out;
}

std::string block_of(const Entry& entry, const std::string& indent, bool comments) {
  if (entry.form == Entry::Form::list) return list_of(entry, indent, comments);
  const auto* texts = std::get_if<std::vector<std::string>>(&entry.value);
  if (texts == nullptr) return yaml_of(entry.below, indent + "  ", comments);
  std::string out;
  for (const std::string& text : *texts) out += indent + "  - " + quoted_yaml(text) + "\n";
  return out;
}

}  // namespace

Entry part_entry(std::string key, std::vector<Entry> below, Entry::Form form) {
  Entry entry{std::move(key)};
  entry.form = form;
  entry.below = std::move(below);
  return entry;
}

Value finite_or_null(double value) {
  if (std::isfinite(value)) return value;
  return {};
}

Entry tool_entry(std::string_view key) {
  Entry name{"name", std::string("sensorchar")};
  name.bare = true;
  return part_entry(std::string(key), {std::move(name), {"version", std::string(version())}}, Entry::Form::flow);
}

Json json_of(const std::vector<Entry>& entries) {
  Json out = Json::object();
  for (const Entry& entry : entries)
    if (entry.in_json) out[entry.key] = json_entry(entry);
  return out;
}

std::string yaml_of(const std::vector<Entry>& entries, const std::string& indent, bool comments) {
  std::string out;
  for (const Entry& entry : entries) {
    if (entry.gap && comments) out += "\n";
    const std::string comment = comments && !entry.comment.empty() ? "  # " + entry.comment : "";
    out += indent + entry.key + ":";
    if (entry.form == Entry::Form::block || entry.form == Entry::Form::list)
      out += comment + "\n" + block_of(entry, indent, comments);
    else
      out += " " + (entry.form == Entry::Form::flow ? flow_of(entry.below) : yaml_value(entry)) + comment + "\n";
  }
  return out;
}

}  // namespace libchar
