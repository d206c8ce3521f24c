// Preloaded into a program under test: it is loaded once, and forked for each command line, which saves loading some
// eighty libraries again and again (as the fork server of AFL; M. Zalewski, "Fuzzing random programs without execve()",
// 2014). Each child runs the program's own main from its beginning and ends as it would.
//   LIBCHAR_FORK_SERVER=IN,OUT   descriptors on which commands come and results go; without it the program runs as ever
// A command: its length (4 bytes), then, each with a NUL behind it, the folder to run in, the files for standard output
// and standard error, and the words. A result, 8 bytes each: status of wait, processor time in microseconds,
// largest resident set in kB.

#include <dlfcn.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <vector>

namespace {

using Main = int (*)(int, char**, char**);
using Start = int (*)(Main, int, char**, void (*)(), void (*)(), void (*)(), void*);

Main program;

bool read_all(int from, void* to, size_t bytes) {
  for (char* place = static_cast<char*>(to); bytes > 0;) {
    const ssize_t n = read(from, place, bytes);
    if (n <= 0) return false;
    place += n;
    bytes -= static_cast<size_t>(n);
  }
  return true;
}

void direct(int descriptor, const char* file) {
  const int opened = open(file, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND, 0600);
  if (opened < 0 || dup2(opened, descriptor) < 0) _exit(125);
  close(opened);
}

[[noreturn]] void run(std::string& command, char* name, char** environment) {
  std::vector<char*> words;
  for (size_t at = 0; at < command.size(); at += strlen(&command[at]) + 1) words.push_back(&command[at]);
  if (words.size() < 3 || chdir(words[0]) != 0) _exit(125);
  direct(STDOUT_FILENO, words[1]);
  direct(STDERR_FILENO, words[2]);
  words.erase(words.begin(), words.begin() + 2);
  words.front() = name;
  words.push_back(nullptr);
  exit(program(static_cast<int>(words.size() - 1), words.data(), environment));
}

struct Result {
  int64_t status, microseconds, kilobytes;
};

int64_t microseconds(const timeval& time) { return int64_t{time.tv_sec} * 1000000 + time.tv_usec; }

int serve(int argc, char** argv, char** environment) {
  int in = 0, out = 0;
  const char* const where = getenv("LIBCHAR_FORK_SERVER");
  if (where == nullptr || sscanf(where, "%d,%d", &in, &out) != 2) return program(argc, argv, environment);
  unsetenv("LIBCHAR_FORK_SERVER");
  unsetenv("LD_PRELOAD");
  std::string command;
  for (uint32_t bytes = 0; read_all(in, &bytes, sizeof bytes);) {
    command.resize(bytes);
    if (!read_all(in, command.data(), bytes)) return 1;
    const pid_t child = fork();
    if (child == 0) {
      close(in);
      close(out);
      run(command, argv[0], environ);
    }
    int status = 0;
    rusage used{};
    if (child < 0 || wait4(child, &status, 0, &used) != child) return 1;
    const Result result = {status, microseconds(used.ru_utime) + microseconds(used.ru_stime), used.ru_maxrss};
    if (write(out, &result, sizeof result) != sizeof result) return 1;
  }
  return 0;
}

}  // namespace

extern "C" int __libc_start_main(Main main, int argc, char** argv, void (*init)(), void (*fini)(), void (*rtld)(),
                                 void* stack) {
  program = main;
  const auto start = reinterpret_cast<Start>(dlsym(RTLD_NEXT, "__libc_start_main"));
  return start(serve, argc, argv, init, fini, rtld, stack);
}
