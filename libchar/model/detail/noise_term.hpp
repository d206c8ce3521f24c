#pragma once
// One noise term of a model file: a bare number, or value, unit, interval and status; converted to
// the two-sided density in the channel's unit.

#include <vector>

#include "libchar/core/document/fields.hpp"
#include "libchar/model/sensor_model.hpp"

namespace libchar {

/// The keys of a term, for readers and docs.
const Fields<Coefficient>& term_fields();

/// Reads the term `key` of kTermNames; `model.unit` is known by then. What was converted is said in `model.remarks`.
void read_term(const MapReader& at, std::string_view key, SensorModel& model);
void write_term(const Field& row, const SensorModel& model, std::vector<Entry>& out);

}  // namespace libchar
