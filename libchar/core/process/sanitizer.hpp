#pragma once
// Is this compiled with the address or the thread sanitizer? Both bring their own heap. gcc says
// so by macros, clang by features.

#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define LIBCHAR_SANITIZED_THREADS 1
#endif
#if __has_feature(address_sanitizer)
#define LIBCHAR_SANITIZED_HEAP 1
#endif
#endif
#if defined(__SANITIZE_THREAD__) && !defined(LIBCHAR_SANITIZED_THREADS)
#define LIBCHAR_SANITIZED_THREADS 1
#endif
#if !defined(LIBCHAR_SANITIZED_THREADS)
#define LIBCHAR_SANITIZED_THREADS 0
#endif
#if (defined(__SANITIZE_ADDRESS__) || LIBCHAR_SANITIZED_THREADS) && !defined(LIBCHAR_SANITIZED_HEAP)
#define LIBCHAR_SANITIZED_HEAP 1
#endif
#if !defined(LIBCHAR_SANITIZED_HEAP)
#define LIBCHAR_SANITIZED_HEAP 0
#endif
