#include "terminal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "colour.hpp"
#include "help/flag_names.hpp"
#include "libchar/core/file/unfinished_files.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/text/text_table.hpp"

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
  write_text(discarded == libchar::Discarded::nothing_written ? "sensorchar: stopped; no output was written\n"
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
    [[maybe_unused]] const int taken = ::open("/dev/null", number == STDOUT_FILENO ? O_RDONLY : O_RDWR);
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

void work_is_done() { std::signal(SIGALRM, SIG_IGN); }

int stop_signal() { return g_stop_signal; }

std::optional<std::size_t> columns_of_stdout() {
  constexpr std::size_t kMost = 10000;
  if (const char* said = std::getenv("COLUMNS"); said != nullptr) {
    const std::size_t columns = std::strtoul(said, nullptr, 10);
    if (columns > 0 && columns < kMost) return columns;
  }
  winsize size{};
  if (::isatty(STDOUT_FILENO) != 1 || ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) return std::nullopt;
  if (size.ws_col == 0) return std::nullopt;
  return size.ws_col;
}

void print(std::string_view text) {
  const int status = write_all(STDOUT_FILENO, text);
  if (status == EPIPE) throw StdoutClosed{};
  if (status != 0) {
    throw libchar::output_error("E0510", "stdout")
        .says("cannot write the result: {}", std::strerror(status))
        .hint("free some space, or send the output elsewhere");
  }
}

std::size_t table_width() { return columns_of_stdout().value_or(0); }

libchar::TextLook text_look() { return {table_width(), colours(STDOUT_FILENO)}; }

namespace {

/// Long lines broken between words, what follows two places further in.
std::string fitted(std::string_view text, std::size_t width) {
  std::string out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    if (width > 0 && libchar::width_of(line) > width) {
      const std::size_t indent = std::min(line.find_first_not_of(' '), width / 2);
      const std::string inner(indent + 2, ' ');
      out += inner.substr(2) + libchar::wrapped(line.substr(indent), width, inner).substr(inner.size());
    } else {
      out += line;
    }
    if (end < text.size()) out += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

}  // namespace

void print_text(const std::string& text) { print(fitted(with_flags(text), table_width())); }

void say(std::string_view line) { write_all(STDERR_FILENO, std::string(line) + "\n"); }

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
  if (now - start_ < std::chrono::seconds(1) || now - drawn_ < std::chrono::milliseconds(100)) return;
  drawn_ = now;
  std::string line = libchar::printable(what, 60);
  if (fraction >= 0) line += fmt::format(" {:3.0f} %", 100 * std::min(fraction, 1.0)) + time_left(fraction, what, now);
  const std::size_t places = libchar::width_of(line);
  const std::string rest = escapes_ ? "\x1b[K" : std::string(shown_ > places ? shown_ - places : 0, ' ');
  write_all(STDERR_FILENO, "\r" + line + rest);
  shown_ = places;
  g_line_drawn = 1;
}

// From how fast it went since this phase was first heard of.
std::string Terminal::time_left(double fraction, std::string_view what, Clock::time_point now) {
  if (phase_ != what || fraction < phase_fraction_) {
    phase_ = what;
    phase_start_ = now;
    phase_fraction_ = fraction;
  }
  const double seconds = std::chrono::duration<double>(now - phase_start_).count();
  const double done = fraction - phase_fraction_;
  if (seconds < 1 || done < 0.01 || fraction >= 1) return "";
  return ", " + libchar::duration_text(seconds * (1 - fraction) / done, 2) + " left";
}

void Terminal::clear() {
  if (shown_ == 0) return;
  write_all(STDERR_FILENO, escapes_ ? std::string("\r\x1b[K") : "\r" + std::string(shown_, ' ') + "\r");
  shown_ = 0;
  g_line_drawn = 0;
}

void Terminal::warn(const libchar::Findings& warnings, std::string_view file) {
  if (quiet_) return;
  clear();
  for (const libchar::Finding& warning : warnings.list())
    say(with_flags(libchar::one_line(warning, file, colours(STDERR_FILENO))));
}

void Terminal::note(const std::string& line) {
  if (quiet_) return;
  clear();
  say(with_flags(line));
}

}  // namespace sensorchar
