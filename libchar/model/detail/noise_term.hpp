#pragma once
// One noise term of a model file: a bare number, or value, unit, interval and status; converted to
// the two-sided density in the channel's unit.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/fields.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/model/sensor_model.hpp"

namespace libchar {

/// The keys of a term, for readers and docs.
const Fields<Coefficient>& term_fields();

/// Reads the term `key` of kTermNames; `model.unit` is known by then. What was converted is said in `model.remarks`.
void read_term(const MapReader& at, std::string_view key, SensorModel& model);
void write_term(const Field& row, const SensorModel& model, std::vector<Entry>& out);

// Units of noise coefficients as data sheets and papers write them.

/// A unit text understood for one term of a channel.
struct NoiseUnit {
  double factor = 1;     ///< multiply by this to get the term's own unit (U·√s, U, U/√s, U·s, U/s)
  bool density = false;  ///< written per √Hz: one- or two-sided has to be known
};

/// Reads "deg/√h", "°/s/√Hz", "mdps/rtHz", "µg/√Hz", "m/s/sqrt(hr)", "deg/h", "rad/s^2/√Hz",
/// "deg/h/√h", "arcsec", "U/√Hz" (U: the channel's unit, whatever it is) for `term` of a channel in
/// `channel_unit`. Nothing when the text is unknown or its dimension is not that of the term.
std::optional<NoiseUnit> find_noise_unit(Term term, std::string_view text, std::string_view channel_unit);

/// A few texts that would be right, for messages.
std::vector<std::string> noise_unit_examples(Term term, std::string_view channel_unit);

}  // namespace libchar
