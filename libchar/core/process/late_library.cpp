#include "libchar/core/process/late_library.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <stdexcept>

namespace libchar::detail {

bool LateLibrary::is_here() {
  if (handle_ == nullptr) handle_ = ::dlopen(file_, RTLD_NOW | RTLD_LOCAL);
  return handle_ != nullptr;
}

void* LateLibrary::address(const char* name) {
  void* const found = is_here() ? ::dlsym(handle_, name) : nullptr;
  if (found == nullptr) throw std::runtime_error(fmt::format("no {} in the library {}", name, file_));
  return found;
}

}  // namespace libchar::detail
