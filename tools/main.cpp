#include <malloc.h>

#include "command.hpp"
#include "libchar/core/version.hpp"
#include "verbs.hpp"

int main(int argc, char** argv) {
  // Blocks of a few megabytes come and go all the time: kept instead of given back to the system, they need no new pages.
  mallopt(M_MMAP_THRESHOLD, 256 << 20);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
  sensorchar::install_signal_handlers();
  sensorchar::Session session;
  session.command.assign(argv, argv + argc);
  CLI::App app("What sensors do to what they measure: noise, models and fusion from recordings.",
               "sensorchar");
  app.set_version_flag("--version", "sensorchar " + std::string(libchar::version()));
  app.require_subcommand(1);
  app.footer("Begin with: sensorchar inspect LOG");
  sensorchar::add_verbs(app, session);
  return sensorchar::run(app, session);
}
