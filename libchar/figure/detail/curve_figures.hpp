#pragma once
// Figures of characterizations, curves and models.

#include "libchar/figure/make_figure.hpp"

namespace libchar {

Chart allan_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart psd_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart residuals_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart trace_figure(std::span<const FigureSource> sources, const FigureOptions& options);

}  // namespace libchar
