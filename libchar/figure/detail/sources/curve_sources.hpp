#pragma once
// Curves of each kind of file that a figure is drawn from.

#include <string>

#include "libchar/core/document/schema.hpp"
#include "libchar/figure/figure_source.hpp"
#include "libchar/model/sensor_model.hpp"

namespace libchar {

/// `channels` of what allan and psd print, and of the parts of a characterization with these names.
void add_allan_curves(FigureSource& out, const MapReader& document);
void add_spectra(FigureSource& out, const MapReader& document);
/// Of a fit: its residuals, and what belongs to the curves that were added before: coefficients, what was left out.
void add_residuals(FigureSource& out, const MapReader& fit);
void add_fit_to_curves(FigureSource& out, const MapReader& fit);
void add_traces(FigureSource& out, const MapReader& trace);
void add_simulated(FigureSource& out, const MapReader& verification);

/// A table with a row a point (fit/curve_table.hpp).
void add_table(FigureSource& out, const std::string& file, bool is_allan);
/// What psd prints: frequency_hz and a column NAME[UNIT] a channel. Adds nothing where the file is none.
void add_wide_spectra(FigureSource& out, const std::string& file);

/// Allan curve and spectrum that a model implies, with its terms.
void add_model(FigureSource& out, const SensorModel& model);

/// "N = 0.00401 deg/s·√s": a coefficient as a mark says it.
std::string mark_text(Term term, double value, const std::string& unit);

/// "overlapping Allan deviation", "One-sided PSD".
std::string spectrum_statistic(Sides sides, Scaling scaling);

}  // namespace libchar
