#pragma once
// Figures of a replay, from its report.

#include "libchar/figure/make_figure.hpp"

namespace libchar {

Chart front_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart memory_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart ranking_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart timeline_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart error_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart window_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart weights_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart variances_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart faults_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart error_allan_figure(std::span<const FigureSource> sources, const FigureOptions& options);

}  // namespace libchar
