#pragma once
// A shared library that is loaded when its first function is called (POSIX dlopen). HDF5 and Cairo bring forty others
// with them: a program that starts with those spends more time on them than on a short log, and most runs need neither.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <type_traits>

namespace libchar::detail {

class LateLibrary {
 public:
  constexpr explicit LateLibrary(const char* file) : file_(file) {}
  /// Whether it can be loaded; it is afterwards.
  bool is_here();
  /// Where a function or variable of it is. Throws std::runtime_error, when it has none of that name or is not
  /// installed.
  void* address(const char* name);

 private:
  const char* file_;
  std::atomic<void*> handle_ = nullptr;
};

template <std::size_t N>
struct LateText {
  char text[N];
  constexpr LateText(const char (&given)[N]) { std::copy_n(given, N, text); }  // NOLINT: of a literal
};

/// Is called, or read, as what a header declares; found in the library at first use.
template <class Declared, LateLibrary& library, LateText name>
struct LateName {
  operator std::add_lvalue_reference_t<Declared>() const {  // NOLINT: in place of the name itself
    static void* const found = library.address(name.text);
    return *reinterpret_cast<std::add_pointer_t<Declared>>(found);
  }
};

}  // namespace libchar::detail

/// In a namespace of ours the name then means that of the library, not the declaration that would have to be linked.
#define LIBCHAR_LATE(library, name) LIBCHAR_LATE_NAME(library, name)  // which may be a macro for a version of it
#define LIBCHAR_LATE_NAME(library, name) \
  [[maybe_unused]] constexpr libchar::detail::LateName<decltype(::name), library, #name> name
