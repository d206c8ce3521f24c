#pragma once
// Says which pass of several it is; the source knows its progress.

#include <string>
#include <string_view>
#include <utility>

#include "libchar/core/process/progress.hpp"

namespace libchar {

struct PassProgress final : Progress {
  PassProgress(Progress& to, std::string name) : next(to), what(std::move(name)) {}
  void update(double fraction, std::string_view) override { next.update(fraction, what); }
  Progress& next;
  std::string what;
};

}  // namespace libchar
