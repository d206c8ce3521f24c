#pragma once
// Which figures there are, and each made of its source.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/characterize/compare/characterization_comparison.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/figure/figure.hpp"
#include "libchar/figure/figure_source.hpp"

namespace libchar {
namespace detail {
/// More curves than these have no colours of their own in one figure.
inline constexpr std::size_t kMostCurves = 35;
}  // namespace detail

struct FigureOptions {
  std::string kind;                   ///< a word of figure_kinds(); empty: the first that the source has
  std::vector<std::string> channels;  ///< names or patterns: channels, of a replay sensors or algorithms; empty: all
  std::string algorithm;              ///< whose weights, variances and findings; empty: the best that has them
  std::string input;                  ///< of a replay with several: whose figure; empty: the first
  std::vector<std::string> labels;    ///< one per file, in place of names made of theirs
  std::string title;
  std::optional<Interval> x_range, y_range;  ///< in the units of the axes
};

struct FigureKind {
  std::string_view word;
  std::string_view title;
  bool of_replay = false;
  Chart (*make)(std::span<const FigureSource> sources, const FigureOptions& options) = nullptr;
  bool of_algorithm = false;  ///< of one of the replay: `FigureOptions::algorithm`
};

/// In the order of the help.
std::span<const FigureKind> figure_kinds();
std::vector<std::string> figure_words();

/// Throws Error(usage) where the source has no such figure or nothing of the channels, Error(input) where units differ.
Chart make_figure(std::span<const FigureSource> sources, const FigureOptions& options);

}  // namespace libchar

// The curves of sensors that are compared, over each other.

namespace libchar::detail {

/// Allan deviation of the candidates of a group with 95 % bands, and a data sheet's line. Without series where
/// none has a curve.
Chart compared_chart(const ComparedGroup& group);

}  // namespace libchar::detail
