#pragma once
// A parser that others wrote, in a process of its own: what crashes it or makes it run for ever ends that process and
// nothing else. No program is started; the process is a copy of this one that answers questions through pipes and may
// write no file. Where there are no processes, as in a web page, the parser runs in this
// one (in_process.cpp): there the page's worker is what it can end.

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "libchar/core/hidden.hpp"

namespace libchar {

/// What answers. An answer has its length where its reader looks for it.
class Answering {
 public:
  virtual ~Answering() = default;
  /// Of every question.
  virtual std::size_t question_bytes() const = 0;
  /// The first answer, without a question.
  virtual std::string begin() = 0;
  virtual std::string answer(std::span<const std::byte> question) = 0;
};

/// Why a child gave no answer, in words: "it crashed (signal 11)".
struct ChildGone {
  std::string why;
};

class ChildProcess {
 public:
  /// `make` runs in the child.
  ChildProcess(std::unique_ptr<Answering> (*make)(const std::string& path), const std::string& path);
  /// Throw ChildGone.
  void ask(std::span<const std::byte> question);
  void answer(std::span<std::byte> to);

 private:
  struct State;
  detail::Hidden<State> state_;
};

}  // namespace libchar
