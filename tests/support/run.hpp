#pragma once
// Runs the built program as a user does, and keeps what it printed.

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/places.hpp"
#include "tests/support/schemas.hpp"
#include "tests/support/shared.hpp"

namespace test {

struct Ran {
  int code = -1;  ///< exit code, or 128 + signal
  std::string out, err;
};

struct RunOptions {
  std::vector<std::string> environment;  ///< "NAME=VALUE", added to ours
  std::string folder;                    ///< working directory, "" = ours
  std::string stdout_path;               ///< where stdout goes instead of Ran::out ("/dev/full")
  std::string stdin_path = "/dev/null";
};

/// Runs `words` (program first) without a shell and waits for its end.
inline Ran run_words(const std::vector<std::string>& words, const RunOptions& options = {}) {
  const TemporaryFolder folder;
  const std::string out = options.stdout_path.empty() ? (folder / "out").string() : options.stdout_path;
  const std::string err = (folder / "err").string();
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) {
    const int in_file = ::open(options.stdin_path.c_str(), O_RDONLY);
    const int out_file = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int err_file = ::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (in_file < 0 || out_file < 0 || err_file < 0) ::_exit(125);
    ::dup2(in_file, 0);
    ::dup2(out_file, 1);
    ::dup2(err_file, 2);
    if (!options.folder.empty() && ::chdir(options.folder.c_str()) != 0) ::_exit(125);
    for (const std::string& variable : options.environment) ::putenv(const_cast<char*>(variable.c_str()));
    ::execvp(argv[0], argv.data());
    ::_exit(125);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  Ran ran;
  ran.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (options.stdout_path.empty()) ran.out = slurp(out);
  ran.err = slurp(err);
  return ran;
}

/// Runs sensorchar with these arguments. Documents that it prints and writes are held against docs/schema.
inline Ran run(std::vector<std::string> arguments, const RunOptions& options = {}) {
  arguments.insert(arguments.begin(), test::program());
  Ran ran = run_words(arguments, options);
  if (const auto fault = faults_of_run(arguments, ran.out, options.folder); !fault.empty())
    throw std::runtime_error(fault);
  return ran;
}

}  // namespace test
