#include "command.hpp"
#include "libchar/core/version.hpp"
#include "verbs.hpp"

int main(int argc, char** argv) {
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
