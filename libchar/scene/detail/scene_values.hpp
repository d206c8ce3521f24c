#pragma once
// Values of a scene file that are no single number or text: how the rows of its keys read and write them.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/entry.hpp"
#include "libchar/core/document/schema.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {

/// [from, to]; `end` stands for the end of the recording.
std::optional<TimeWindow> window_of(const MapReader& at, std::string_view key);
void write_window(std::string_view key,
                  const std::optional<TimeWindow>& window,
                  std::vector<Entry>& out);

/// A number, or the word for finding it out.
struct OrEstimate {
  double value = 0;
  bool estimate = false;
};
/// `expected` in the words of its refusal ("a number of seconds").
OrEstimate number_or_estimate(const MapReader& at,
                              std::string_view key,
                              const std::string& expected);
/// Nothing of zero.
void write_or_estimate(std::string_view key, const OrEstimate& said, std::vector<Entry>& out);

/// A word that needs no quotes.
Entry word_entry(std::string_view key, std::string word);

}  // namespace libchar
