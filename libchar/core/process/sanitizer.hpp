#pragma once
// Is this compiled with the address sanitizer, which brings a heap of its own? gcc says so by a macro, clang by a
// feature.

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define LIBCHAR_SANITIZED_HEAP 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) && !defined(LIBCHAR_SANITIZED_HEAP)
#define LIBCHAR_SANITIZED_HEAP 1
#endif
#if !defined(LIBCHAR_SANITIZED_HEAP)
#define LIBCHAR_SANITIZED_HEAP 0
#endif
