#include "libchar/log/arrays/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <vector>

#include "libchar/core/process/sanitizer.hpp"
#include "libchar/core/refusal.hpp"

namespace libchar {
namespace {

constexpr rlim_t kMostMemory = rlim_t{4} << 30U;  // of addresses, this program's own among them
constexpr int kPatienceMs = 120000;               // for one answer

void limit(__rlimit_resource what, rlim_t most) {
  rlimit now{};
  if (::getrlimit(what, &now) != 0) return;
  now.rlim_cur = std::min(most, now.rlim_max);
  ::setrlimit(what, &now);
}

// Not to outlive its parent, no core files, no files written, memory within bounds. Ctrl-C is the parent's to answer.
void confine() {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) std::signal(signal, SIG_IGN);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) std::signal(signal, SIG_DFL);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
  if (!LIBCHAR_SANITIZED_HEAP) limit(RLIMIT_AS, kMostMemory);
}

[[noreturn]] void refuse_child(const char* what) {
  throw input_error("E0465").says("no process can be started to read it in: {}: {}", what, std::strerror(errno));
}

bool read_all(int descriptor, std::span<std::byte> to) {
  while (!to.empty()) {
    const ssize_t n = ::read(descriptor, to.data(), to.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    to = to.subspan(static_cast<std::size_t>(n));
  }
  return true;
}

bool write_all(int descriptor, std::span<const std::byte> from) {
  while (!from.empty()) {
    const ssize_t n = ::write(descriptor, from.data(), from.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    from = from.subspan(static_cast<std::size_t>(n));
  }
  return true;
}

// Until the other end of `questions` is closed.
void serve(Answering& parser, int questions, int answers) {
  std::string next = parser.begin();
  std::vector<std::byte> question(parser.question_bytes());
  while (write_all(answers, std::as_bytes(std::span(next))) && read_all(questions, question))
    next = parser.answer(question);
}

}  // namespace

struct ChildProcess::State {
  pid_t child = -1;
  int questions = -1, answers = -1;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (questions >= 0) ::close(questions);
    if (answers >= 0) ::close(answers);
    if (child <= 0) return;
    ::kill(child, SIGKILL);
    while (::waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  [[noreturn]] void gone(const char* otherwise);
};

ChildProcess::ChildProcess(std::unique_ptr<Answering> (*make)(const std::string& path), const std::string& path)
    : state_(detail::hidden<State>()) {
  int to_child[2], to_parent[2];
  if (::pipe2(to_child, O_CLOEXEC) != 0) refuse_child("pipe");
  if (::pipe2(to_parent, O_CLOEXEC) != 0) {
    ::close(to_child[0]);
    ::close(to_child[1]);
    refuse_child("pipe");
  }
  State& s = *state_;
  s.child = ::fork();
  if (s.child == 0) {
    ::close(to_child[1]);
    ::close(to_parent[0]);
    confine();
    serve(*make(path), to_child[0], to_parent[1]);
    ::_exit(0);
  }
  ::close(to_child[0]);
  ::close(to_parent[1]);
  s.questions = to_child[1];
  s.answers = to_parent[0];
  if (s.child < 0) refuse_child("fork");
}

void ChildProcess::State::gone(const char* otherwise) {
  int status = 0;
  if (child > 0) {
    ::kill(child, SIGKILL);  // without effect where it crashed by itself
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    child = -1;
  }
  if (WIFSIGNALED(status) && WTERMSIG(status) != SIGKILL)
    throw ChildGone{fmt::format("crashed (signal {})", WTERMSIG(status))};
  throw ChildGone{otherwise};
}

void ChildProcess::ask(std::span<const std::byte> question) {
  // A child that is gone must not end this process by SIGPIPE.
  struct sigaction ignore {};
  struct sigaction before {};
  ignore.sa_handler = SIG_IGN;
  ::sigaction(SIGPIPE, &ignore, &before);
  const bool done = write_all(state_->questions, question);
  ::sigaction(SIGPIPE, &before, nullptr);
  if (!done) state_->gone("gave up");
}

void ChildProcess::answer(std::span<std::byte> to) {
  while (!to.empty()) {
    pollfd waiting{state_->answers, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, kPatienceMs);
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0) state_->gone("does not come to an end");
    const ssize_t n = ::read(state_->answers, to.data(), to.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) state_->gone("gave up");
    to = to.subspan(static_cast<std::size_t>(n));
  }
}

}  // namespace libchar
