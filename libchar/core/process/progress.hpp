#pragma once
// Long work reports its progress and lets itself be stopped; the library never prints and never reads signals itself.

#include <string_view>

namespace libchar {

/// The library calls `update` from time to time from the thread that entered it. A sink that wants the work to stop
/// throws Cancelled from it. The default sink does nothing.
class Progress {
 public:
  virtual ~Progress() = default;
  /// fraction in [0, 1], or < 0 when the total is unknown; `what` is a short verb phrase ("reading gyro.csv").
  virtual void update(double fraction, std::string_view what) {
    static_cast<void>(fraction);
    static_cast<void>(what);
  }
};

/// A sink that reports nothing, for callers that do not care.
inline Progress& no_progress() {
  static Progress silent;
  return silent;
}

}  // namespace libchar
