#pragma once
// What the program says: results to stdout, progress and messages to stderr, and how it is interrupted.

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/core/process/progress.hpp"
#include "libchar/core/text/text_table.hpp"

namespace sensorchar {

/// Thrown when the reader of stdout went away (`| head`): nothing is wrong, nothing is left to talk to.
struct StdoutClosed {};

/// Descriptors 0 to 2 that whoever started the program has closed (cron and daemons do) are taken, so that no output
/// file gets one of them and messages into it. What is printed to such a stdout is an error as before: it goes nowhere.
void take_closed_streams();

/// SIGINT, SIGTERM and SIGHUP set a flag that the next Progress::update turns into Cancelled. Where none comes within
/// 0.15 s (a fit, a transform, a training), and with a second signal at once, the handler removes unfinished outputs
/// and ends the program itself. SIGPIPE and SIGXFSZ become ordinary write errors.
void install_signal_handlers();

/// The work is done: a signal that came during its last moments stops nothing any more.
void work_is_done();

/// Number of the signal that asked the program to stop, 0 when there is none.
int stop_signal();

/// Characters in a line where results are read: what COLUMNS says, else those of the terminal that
/// stdout is; nothing for a file or a pipe.
std::optional<std::size_t> columns_of_stdout();
/// The same for tables: 0, any width, where there is none.
std::size_t table_width();
/// Of a text that is printed there.
libchar::TextLook text_look();

/// Writes a result to stdout and checks that it went there. Throws Error(output), or StdoutClosed.
void print(std::string_view text);

/// The same for a text that is read: options of the library are named by their flags, lines are
/// wrapped between words to the width of the terminal.
void print_text(const std::string& text);

/// One message on stderr, a newline added. Lines coming from files must have gone through libchar::printable already.
void say(std::string_view line);

/// Progress on stderr: only on a terminal, after one second of work, at most ten times per second.
class Terminal : public libchar::Progress {
 public:
  Terminal();
  ~Terminal() override;
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// No progress and no warnings from now on; errors are still said.
  void be_quiet() { quiet_ = true; }
  bool quiet() const { return quiet_; }
  /// Draws when it is time to. Throws Cancelled when a signal asked to stop.
  void update(double fraction, std::string_view what) override;
  /// Removes the progress line, to make room for other text.
  void clear();
  /// Says every warning on one line each, with flags in place of the library's options (nothing when quiet).
  void warn(const libchar::Findings& warnings, std::string_view file);
  /// A note on stderr, with flags as well (nothing when quiet).
  void note(const std::string& line);

 private:
  using Clock = std::chrono::steady_clock;
  std::string time_left(double fraction, std::string_view what, Clock::time_point now);

  bool draws_ = false, escapes_ = false, quiet_ = false;
  std::size_t shown_ = 0;  ///< characters of the line now on the terminal
  Clock::time_point start_, drawn_;
  std::string phase_;              ///< what is being done
  Clock::time_point phase_start_;  ///< since when
  double phase_fraction_ = 0;      ///< where it began
};

}  // namespace sensorchar
