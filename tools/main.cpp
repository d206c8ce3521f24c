#include <malloc.h>

#include "allowed_threads.hpp"
#include "libchar/core/version.hpp"
#include "verb.hpp"

int main(int argc, char** argv) {
  using namespace sensorchar;
  // Blocks of a few megabytes come and go all the time: kept instead of given back to the system, they need no new pages.
  mallopt(M_MMAP_THRESHOLD, 256 << 20);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
  const auto threads = keep_to_allowed_threads();
  take_closed_streams();
  install_signal_handlers();
  Session session;
  session.command.assign(argv, argv + argc);
  return exit_code_of(session, [&] {
    CommandLine line(
        "sensorchar",
        "What sensors do to what they measure: noise, models and fusion from recordings.",
        "sensorchar " + std::string(libchar::version()),
        "Begin with: sensorchar inspect LOG");
    for (const VerbEntry& verb : verbs()) line.add(verb, session);
    if (const auto text = line.run(session.command)) print(*text);
  });
}
