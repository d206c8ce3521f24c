#pragma once
// A run of benchmarks as its reports show it: sections with sentences, a table and a chart.
// Terminal, Markdown and page only print it.

#include <string>
#include <vector>

#include "libchar/benchmark/bench_document.hpp"
#include "libchar/core/table/table.hpp"

namespace libchar {

struct BenchPoint {
  std::string name;
  double x = 0, y = 0;
  Interval x95, y95;      ///< infinite: not known
  bool on_front = false;  ///< nobody is better in both
  bool is_ours = true;
  bool told = false;  ///< has a front of its own: it knows what the others have to find out
};

struct BenchChart {
  std::string x, y;  ///< names of the axes
  std::vector<BenchPoint> points;
};

struct BenchSection {
  std::string title;
  std::vector<std::string> sentences;
  Table table;                     ///< without columns: none
  std::vector<std::string> notes;  ///< below the table
  std::vector<BenchChart> charts;  ///< none or one
};

std::vector<BenchSection> bench_view(const BenchReport& report);

namespace detail {
/// A sentence a part: who is best.
std::vector<std::string> bench_verdict(const BenchReport& report);
}  // namespace detail

/// "12.3 [11.9, 12.8]", without limits where they are not known, "–" where it was not measured.
std::string figure_text(const Figure& figure, int digits = 3, double factor = 1);

}  // namespace libchar
