#include "libchar/core/error.hpp"

#include <utility>

#include "libchar/core/text/text.hpp"
#include "libchar/core/text/text_table.hpp"

namespace libchar {

std::string one_line(const Problem& problem, bool colours) {
  std::string line;
  if (!problem.where.empty()) line += printable(problem.where) + ": ";
  line += tinted("error", Tint::bad, colours);
  if (!problem.code.empty()) line += " " + problem.code;
  line += ": " + printable(problem.what);
  if (!problem.got.empty()) line += "; got \"" + printable(problem.got, 40) + "\"";
  if (!problem.hint.empty()) line += "; hint: " + printable(problem.hint);
  return line;
}

Error::Error(Problem problem) : problem_(std::move(problem)), message_(one_line(problem_)) {}

void Error::set(std::string Problem::*part, std::string text) {
  problem_.*part = std::move(text);
  message_ = one_line(problem_);
}

}  // namespace libchar
