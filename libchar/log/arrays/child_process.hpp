#pragma once
// A parser that others wrote, in a process of its own: what crashes it or makes it run for ever
// ends that process and nothing else. No program is started; the process is a copy of this one that
// answers questions through pipes and may write no file.

#include <sys/types.h>

#include <cstddef>
#include <span>
#include <string>

namespace libchar {

/// The answers' end, for the code that runs in the child. False when the parent is gone.
bool read_all(int descriptor, std::span<std::byte> to);
bool write_all(int descriptor, std::span<const std::byte> from);

/// Why a child gave no answer, in words: "it crashed (signal 11)".
struct ChildGone {
  std::string why;
};

class ChildProcess {
 public:
  /// `serve` runs in the child until the other end of `questions` is closed; `context` is its own.
  ChildProcess(void (*serve)(const void* context, int questions, int answers), const void* context);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  /// Throw ChildGone.
  void ask(std::span<const std::byte> question);
  void answer(std::span<std::byte> to);

 private:
  [[noreturn]] void gone(const char* otherwise);
  pid_t child_ = -1;
  int questions_ = -1, answers_ = -1;
};

}  // namespace libchar
