#pragma once
// Lines of inertial units that say what they are, as rows of a table.

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "libchar/log/csv/unpacker.hpp"

namespace libchar::csv {

/// By the first bytes: a line of VectorNav, or one of NovAtel's of raw inertial samples.
bool is_sentences(std::string_view front);

/// Text of a table of the lines of the first kind, in constant memory; others are counted in the dialect.
std::unique_ptr<Unpacker> open_sentence_rows(std::function<std::size_t(char*, std::size_t)> stored,
                                             const std::string& file);

}  // namespace libchar::csv
