#pragma once
// The one exception type that leaves the library on user mistakes. Programmer mistakes are assert().

#include <exception>
#include <string>

namespace libchar {

/// Maps one to one to the exit codes of the program (docs/errors.md).
enum class ErrorKind {
  usage,    ///< the command line asks for something impossible            (exit 2)
  input,    ///< an input is missing, malformed or over a named limit      (exit 3)
  numeric,  ///< the numbers do not allow a result (singular, too few…)    (exit 4)
  output,   ///< a result cannot be written                                (exit 5)
  check,    ///< a requested check failed                                  (exit 6)
  again,    ///< not possible now; the same call may succeed later         (exit 75, as schedulers know it)
};

/// What happened, in the parts of one sentence. Text fields may hold untrusted bytes of a file: they are escaped by
/// `one_line`, so a thrower passes them as they are.
struct Problem {
  ErrorKind kind = ErrorKind::input;
  std::string code = {};  ///< "E0312"; "" when there is none
  /// "FILE:LINE:COL (byte N)" or "FILE (byte N, field NAME)"; "" when nowhere in particular
  std::string where = {};
  std::string what = {};  ///< what was found and what was expected
  std::string got = {};   ///< offending excerpt, shown quoted and cut to 40 characters; "" when there is none
  std::string hint = {};  ///< what to do; "" when there is nothing to do
};

/// "WHERE: error CODE: WHAT; got "GOT"; hint: HINT", on one line, control characters escaped.
std::string one_line(const Problem& problem, bool colours = false);

class Error : public std::exception {
 public:
  explicit Error(Problem problem);
  const char* what() const noexcept override { return message_.c_str(); }
  const Problem& problem() const noexcept { return problem_; }

 protected:
  void set(std::string Problem::*part, std::string text);

 private:
  Problem problem_;
  std::string message_;
};

/// Thrown out of long work when the user pressed Ctrl-C or the process was asked to stop (see progress.hpp).
struct Cancelled : std::exception {
  int signal = 2;
  explicit Cancelled(int number) : signal(number) {}
  const char* what() const noexcept override { return "cancelled"; }
};

}  // namespace libchar
