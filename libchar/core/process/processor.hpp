#pragma once
// May instructions be used that only some processors have? On x86-64, each behind a question at run
// time; nowhere when the build says LIBCHAR_PORTABLE (an option of CMake), which tests the code that
// every other processor runs.

#if defined(__x86_64__) && !defined(LIBCHAR_PORTABLE)
#define LIBCHAR_X86_64
#endif
