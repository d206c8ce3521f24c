#include "libchar/core/warnings.hpp"

#include <algorithm>

#include "libchar/core/text/text.hpp"
#include "libchar/core/text/text_table.hpp"

namespace libchar {

Warning& Warnings::entry(std::string_view code, std::string_view message) {
  const auto found =
      std::find_if(list_.begin(), list_.end(), [&](const Warning& w) { return w.code == code; });
  if (found != list_.end()) return *found;
  list_.push_back({std::string(code), std::string(message), 0, {}});
  return list_.back();
}

void Warnings::add(std::string_view code,
                   std::string_view message,
                   std::string_view place,
                   std::uint64_t count) {
  Warning& w = entry(code, message);
  w.count += count;
  if (!place.empty() && w.places.size() < 3) w.places.emplace_back(place);
}

void Warnings::merge(const Warnings& other) {
  for (const Warning& o : other.list_) {
    Warning& w = entry(o.code, o.message);
    w.count += o.count;
    for (const std::string& place : o.places)
      if (w.places.size() < 3) w.places.push_back(place);
  }
}

const Warning* Warnings::find(std::string_view code) const {
  const auto found =
      std::find_if(list_.begin(), list_.end(), [&](const Warning& w) { return w.code == code; });
  return found == list_.end() ? nullptr : &*found;
}

std::string sentence_of(const Warning& warning) {
  std::string line;
  if (warning.count != 1) line = std::to_string(warning.count) + " × ";
  line += printable(warning.message);
  if (!warning.places.empty()) {
    line += warning.count > warning.places.size() ? " (first: " : " (";
    for (std::size_t i = 0; i < warning.places.size(); ++i)
      line += (i ? ", " : "") + printable(warning.places[i]);
    line += ")";
  }
  return line;
}

std::string one_line(const Warning& warning, std::string_view file, bool colours) {
  return printable(file) + ": " + tinted("warning", Tint::doubtful, colours) + ": " +
         sentence_of(warning);
}

}  // namespace libchar
