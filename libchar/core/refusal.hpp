#pragma once
// An error in the parts of its sentence, each only where there is something to say:
//
//   throw input_error("E0331", path).says("column {} has no finite value", name).got(cell).hint("`channels` chooses");

#include <fmt/core.h>

#include <string>
#include <string_view>
#include <utility>

#include "libchar/core/error.hpp"

namespace libchar {

class Refusal : public Error {
 public:
  Refusal(ErrorKind kind, std::string code, std::string where = "")
      : Error({kind, std::move(code), std::move(where)}) {}

  /// "SUBJECT: " before the message.
  Refusal& about(const std::string& subject) { return with(&Problem::what, subject + ": "); }
  Refusal& says(std::string_view what) { return with(&Problem::what, problem().what + std::string(what)); }
  Refusal& got(std::string_view excerpt) { return with(&Problem::got, std::string(excerpt)); }
  Refusal& hint(std::string_view what_to_do) { return with(&Problem::hint, std::string(what_to_do)); }

  template <class First, class... Rest>
  Refusal& says(fmt::format_string<First, Rest...> what, First&& first, Rest&&... rest) {
    return says(fmt::format(what, std::forward<First>(first), std::forward<Rest>(rest)...));
  }
  template <class First, class... Rest>
  Refusal& got(fmt::format_string<First, Rest...> excerpt, First&& first, Rest&&... rest) {
    return got(fmt::format(excerpt, std::forward<First>(first), std::forward<Rest>(rest)...));
  }
  template <class First, class... Rest>
  Refusal& hint(fmt::format_string<First, Rest...> what_to_do, First&& first, Rest&&... rest) {
    return hint(fmt::format(what_to_do, std::forward<First>(first), std::forward<Rest>(rest)...));
  }

 private:
  Refusal& with(std::string Problem::*part, std::string text) {
    set(part, std::move(text));
    return *this;
  }
};

// Of the kinds that are raised in many places.
inline Refusal usage_error(std::string code, std::string where = "") {
  return {ErrorKind::usage, std::move(code), std::move(where)};
}
inline Refusal input_error(std::string code, std::string where = "") {
  return {ErrorKind::input, std::move(code), std::move(where)};
}
inline Refusal numeric_error(std::string code, std::string where = "") {
  return {ErrorKind::numeric, std::move(code), std::move(where)};
}
inline Refusal output_error(std::string code, std::string where = "") {
  return {ErrorKind::output, std::move(code), std::move(where)};
}

}  // namespace libchar
