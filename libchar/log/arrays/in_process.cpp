// Where there are no processes (LIBCHAR_SERIAL).
#include <cstring>

#include "libchar/log/arrays/child_process.hpp"

namespace libchar {

struct ChildProcess::State {
  std::unique_ptr<Answering> parser;
  std::string said;
  std::size_t read = 0;
};

ChildProcess::ChildProcess(std::unique_ptr<Answering> (*make)(const std::string& path), const std::string& path)
    : state_(detail::hidden<State>()) {
  state_->parser = make(path);
  state_->said = state_->parser->begin();
}

void ChildProcess::ask(std::span<const std::byte> question) {
  state_->said = state_->parser->answer(question);
  state_->read = 0;
}

void ChildProcess::answer(std::span<std::byte> to) {
  State& s = *state_;
  if (to.size() > s.said.size() - s.read) throw ChildGone{"gave up"};
  std::memcpy(to.data(), s.said.data() + s.read, to.size());
  s.read += to.size();
}

}  // namespace libchar
