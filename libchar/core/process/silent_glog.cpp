#include "libchar/core/process/silent_glog.hpp"

#include <glog/logging.h>

#include <mutex>

namespace libchar {
namespace {

std::mutex glog_door;
int glog_silencers = 0;
int glog_level_before = 0;

}  // namespace

SilentGlog::SilentGlog() {
  const std::lock_guard lock(glog_door);
  if (glog_silencers++ > 0) return;
  glog_level_before = FLAGS_minloglevel;
  FLAGS_minloglevel = google::GLOG_FATAL;
}

SilentGlog::~SilentGlog() {
  const std::lock_guard lock(glog_door);
  if (--glog_silencers == 0) FLAGS_minloglevel = glog_level_before;
}

}  // namespace libchar
