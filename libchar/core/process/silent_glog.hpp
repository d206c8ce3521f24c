#pragma once
// Ceres reports through glog what its caller learns from return values anyway, and glog writes it
// to standard error unless it is set up.

namespace libchar {

/// While one of these lives glog writes nothing below FATAL; afterwards what it did before. Any
/// number may live at once, in any threads.
class SilentGlog {
 public:
  SilentGlog();
  ~SilentGlog();
  SilentGlog(const SilentGlog&) = delete;
  SilentGlog& operator=(const SilentGlog&) = delete;
};

}  // namespace libchar
