// sensorchar page: the program as a web page, for a colleague. This verb is there where the page was
// built (LIBCHAR_PAGE).

#include <filesystem>
#include <memory>
#include <string>

#include "libchar/core/file/file_text.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPage = "sensorchar.html";
constexpr std::size_t kMost = std::size_t{64} << 20U;

struct PageVerb {
  std::string output = kPage;
  bool force = false;
};

/// Where this program was installed, or built.
std::string installed_page() {
  std::error_code none;
  const fs::path folder = fs::read_symlink("/proc/self/exe", none).parent_path();
  for (const fs::path& place : {folder / "../share/sensorchar" / kPage, folder / kPage})
    if (fs::is_regular_file(place, none)) return place.string();
  throw libchar::input_error("E0101", kPage)
      .says("the page is not where this program is installed")
      .hint("install the package sensorchar again");
}

void run_page(Session& session, const PageVerb& verb) {
  libchar::check_output(verb.output, verb.force);
  libchar::write_whole_file(verb.output, libchar::file_text(installed_page(), kMost), verb.force);
  session.wrote = true;
  print_summary(session, verb.output,
                "wrote " + libchar::printable(verb.output) +
                    "\nnext: open it in a browser and drop logs on it; nothing leaves the machine\n");
}

std::function<void()> page_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<PageVerb>();
  options.add_text("-o,--output", verb->output, "file to write (default: sensorchar.html)").value_name("FILE");
  options.add_flag("--force", verb->force, "overwrite the output file");
  return [&session, verb] { run_page(session, *verb); };
}

}  // namespace

VerbEntry verb_page() {
  return {14,
          "page",
          "This program as one web page that needs no installation and no network",
          page_options,
          {{"for a colleague who cannot install anything", "sensorchar page"},
           {"under another name", "sensorchar page -o noise-tool.html"}}};
}

}  // namespace sensorchar
