#include "terminal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "flag_names.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/text_table.hpp"
#include "libchar/core/unfinished_files.hpp"

namespace sensorchar {
namespace {

// A signal handler has nowhere else to write and to look.
volatile std::sig_atomic_t g_stop_signal = 0;
volatile std::sig_atomic_t g_line_drawn = 0;

void write_text(std::string_view text) {
  [[maybe_unused]] const ssize_t ignored = ::write(STDERR_FILENO, text.data(), text.size());
}

/// Ends the program from within a handler, unless outputs get their names right now: then the timer asks again.
void end_now(int) {
  const libchar::Discarded discarded = libchar::discard_unfinished();
  if (discarded == libchar::Discarded::not_now) return;
  if (g_line_drawn != 0) write_text("\r\x1b[K");
  write_text(discarded == libchar::Discarded::nothing_written
                 ? "sensorchar: stopped; no output was written\n"
                 : "sensorchar: stopped\n");
  ::_exit(128 + g_stop_signal);
}

void start_timer(suseconds_t first_us, suseconds_t then_us) {
  const itimerval when = {{0, then_us}, {0, first_us}};
  ::setitimer(ITIMER_REAL, &when, nullptr);
}

void remember(int number) {
  const bool again = g_stop_signal != 0;
  g_stop_signal = number;
  start_timer(again ? 1 : 150000, 50000);
}

// Returns errno, 0 when everything was written.
int write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(descriptor, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  return 0;
}

}  // namespace

void take_closed_streams() {
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(number, F_GETFD) >= 0 || errno != EBADF) continue;
    // The lowest free number is this one: those below are open.
    [[maybe_unused]] const int taken =
        ::open("/dev/null", number == STDOUT_FILENO ? O_RDONLY : O_RDWR);
  }
}

void install_signal_handlers() {
  struct sigaction action {};
  action.sa_handler = remember;
  ::sigemptyset(&action.sa_mask);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGALRM}) ::sigaddset(&action.sa_mask, number);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    ::sigaction(number, nullptr, &before);
    if (before.sa_handler != SIG_IGN) ::sigaction(number, &action, nullptr);  // nohup stays nohup
  }
  action.sa_handler = end_now;
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGALRM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

void work_is_done() {
  std::signal(SIGALRM, SIG_IGN);
}

int stop_signal() {
  return g_stop_signal;
}

void print(std::string_view text) {
  const int status = write_all(STDOUT_FILENO, text);
  if (status == EPIPE) throw StdoutClosed{};
  if (status != 0) {
    throw libchar::Error({libchar::ErrorKind::output,
                          "E0510",
                          "stdout",
                          fmt::format("cannot write the result: {}", std::strerror(status)),
                          "",
                          "free some space, or send the output elsewhere"});
  }
}

void print_text(const std::string& text) {
  print(with_flags(text));
}

void say(std::string_view line) {
  write_all(STDERR_FILENO, std::string(line) + "\n");
}

Terminal::Terminal() : start_(Clock::now()), drawn_(start_) {
  const char* term = std::getenv("TERM");
  const bool dumb = term == nullptr || std::strcmp(term, "dumb") == 0;
  const char* no_color = std::getenv("NO_COLOR");
  draws_ = ::isatty(STDERR_FILENO) == 1 && !dumb;
  escapes_ = draws_ && (no_color == nullptr || *no_color == '\0');
}

Terminal::~Terminal() {
  try {
    clear();
  } catch (const std::exception&) {
    // No memory for a line of blanks.
  }
}

void Terminal::update(double fraction, std::string_view what) {
  if (const int number = stop_signal(); number != 0) throw libchar::Cancelled(number);
  if (!draws_ || quiet_) return;
  const Clock::time_point now = Clock::now();
  if (now - start_ < std::chrono::seconds(1) || now - drawn_ < std::chrono::milliseconds(100))
    return;
  drawn_ = now;
  std::string line = libchar::printable(what, 60);
  if (fraction >= 0) line += fmt::format(" {:3.0f} %", 100 * std::min(fraction, 1.0));
  const std::size_t places = libchar::width_of(line);
  const std::string rest =
      escapes_ ? "\x1b[K" : std::string(shown_ > places ? shown_ - places : 0, ' ');
  write_all(STDERR_FILENO, "\r" + line + rest);
  shown_ = places;
  g_line_drawn = 1;
}

void Terminal::clear() {
  if (shown_ == 0) return;
  write_all(STDERR_FILENO,
            escapes_ ? std::string("\r\x1b[K") : "\r" + std::string(shown_, ' ') + "\r");
  shown_ = 0;
  g_line_drawn = 0;
}

void Terminal::warn(const libchar::Warnings& warnings, std::string_view file) {
  if (quiet_) return;
  clear();
  for (const libchar::Warning& warning : warnings.list())
    say(with_flags(libchar::one_line(warning, file)));
}

void Terminal::note(const std::string& line) {
  if (quiet_) return;
  clear();
  say(with_flags(line));
}

}  // namespace sensorchar
