#include "libchar/core/process/silent_glog.hpp"

#include <glog/logging.h>

#include <iostream>
#include <mutex>
#include <utility>

namespace libchar {
namespace {

#if __has_include(<glog/log_severity.h>)
int set_level(int level) { return std::exchange(FLAGS_minloglevel, level); }
constexpr int kSilent = google::GLOG_FATAL;
#else
// Ceres was built with the small log of its own (a web page), which writes to std::cerr as nothing else here does.
int set_level(int level) {
  const auto before = std::cerr.rdstate();
  std::cerr.clear(static_cast<std::ios_base::iostate>(level));
  return static_cast<int>(before);
}
constexpr int kSilent = static_cast<int>(std::ios_base::badbit);
#endif

std::mutex glog_door;
int glog_silencers = 0;
int glog_level_before = 0;

}  // namespace

SilentGlog::SilentGlog() {
  const std::lock_guard lock(glog_door);
  if (glog_silencers++ > 0) return;
  glog_level_before = set_level(kSilent);
}

SilentGlog::~SilentGlog() {
  const std::lock_guard lock(glog_door);
  if (--glog_silencers == 0) set_level(glog_level_before);
}

}  // namespace libchar
