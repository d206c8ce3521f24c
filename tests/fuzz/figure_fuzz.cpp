// Any bytes as what a figure is drawn from: a document in JSON or YAML (a report, curves, a sensor
// model) or a table of curves. Every figure that can be made of it is drawn: numbers in the SVG are
// numbers, its texts stay between its tags, and the second drawing is the first.

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "libchar/figure/draw_figure.hpp"
#include "libchar/figure/make_figure.hpp"
#include "tests/fuzz/fuzz_support.hpp"

using namespace libchar;

namespace {

/// One file of each kind, written anew for every input: how a source is read depends on the end of its name.
const std::string& folder() {
  static const std::string& path = *new std::string([] {  // outlives the handler of exit
    std::string made = "/dev/shm/libchar-figure-fuzz-" + std::to_string(::getpid());
    std::filesystem::create_directory(made);
    std::atexit([] { std::filesystem::remove_all(folder()); });
    return made;
  }());
  return path;
}

/// What stands within tags: shapes and where texts are, not what they say.
std::string tags_of(const std::string& svg) {
  std::string out;
  bool within = false;
  for (const char c : svg) {
    if (c == '<') {
      fuzz::expect(!within, "an SVG with < within a tag");
      within = true;
    }
    if (within) out += c;
    if (c == '>') {
      fuzz::expect(within, "an SVG with > outside of a tag");
      within = false;
    }
  }
  fuzz::expect(!within, "an SVG that ends within a tag");
  return out;
}

void draw(const Chart& figure) {
  Findings warnings;
  const std::string svg = draw_figure(figure, FigureFormat::svg, {}, warnings);
  const std::string tags = tags_of(svg);
  for (const char* none : {"nan", "inf"})
    fuzz::expect(tags.find(none) == std::string::npos, "a place in an SVG that is no number");
  fuzz::expect_same("drawn, and drawn again", svg, draw_figure(figure, FigureFormat::svg, {}, warnings));
  figure_csv(figure);
  figure_gnuplot(figure, {});
  terminal_figure(figure, {});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  constexpr const char* kNames[] = {"/f.json", "/f.yaml", "/f.csv"};
  const std::string path = folder() + kNames[data[0] % 3];
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
  std::vector<FigureSource> sources;
  try {
    sources.push_back(read_figure_source(path));
  } catch (const Error& error) {
    fuzz::said(error);
    return 0;
  }
  FigureOptions options;
  for (const std::string& kind : figure_words()) {
    options.kind = kind;
    try {
      draw(make_figure(sources, options));
    } catch (const Error& error) {
      fuzz::said(error);
    }
  }
  return 0;
}
