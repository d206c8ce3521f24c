#pragma once
// Allan curves and spectra as documents hold them: what `allan` and `psd` print as JSON, and the
// parts of a report with these names.

#include <optional>
#include <string>
#include <vector>

#include "libchar/allan/noise_type.hpp"
#include "libchar/characterize/characterization_view.hpp"
#include "libchar/characterize/compare/verification.hpp"
#include "libchar/core/document/fields.hpp"

namespace libchar {

/// What a model predicts at the points of a curve; NaN: not known there.
struct PredictedCurve {
  std::vector<double> model;
  std::vector<Interval> model_ci95;  ///< of the Allan curve
  std::vector<Asymptote> asymptotes;
  bool known = false;
};

struct AllanOfChannel {
  std::string name, unit;
  std::string value_unit;  ///< of the deviation, where it is not that of the channel: time errors
  AllanCurve curve;        ///< its type is said by `type`
  PredictedCurve predicted;
  std::vector<NoiseType> noise_types;
  std::vector<double> data_sheet;  ///< a sensor at its limits, at the same points
  std::string type;                ///< where a document has several
  std::vector<Finding> findings;
};

struct AllanDocument {
  std::string type;                ///< of the first channel
  std::vector<std::string> types;  ///< where there are several
  std::vector<AllanOfChannel> channels;
};

struct SpectrumOfChannel {
  std::string name, unit, value_unit;
  Spectrum spectrum;           ///< its sides and scaling are said by the document
  std::vector<Interval> ci95;  ///< one per bin; NaN: unknown
  PredictedCurve predicted;
  std::vector<SpectralLine> lines;
  bool with_lines = false;  ///< they were asked for
  std::vector<Finding> findings;
};

struct SpectrumDocument {
  std::string sides = "one", scaling = "psd";
  std::vector<SpectrumOfChannel> channels;
};

/// Numbers that follow from the coefficients and that one asks for.
struct DerivedNumbers {
  std::optional<double> per_sample_sd, noise_density_one_sided;
  std::optional<AllanPoint> allan_minimum;
  std::vector<ReadOff> read_off_points;
  double plain_from_s = 0;
};

/// A record in blocks, with what was found in it; `low` and `high` with the digits that a picture needs.
struct TraceOfChannel {
  std::string name, unit;
  Trace trace;
  std::vector<TraceMark> marks;
  double own_rate_hz = 0;  ///< of a channel on a grid of its own; 0: the log's
};

/// A recording's channel against a simulation of its model.
struct VerificationOfChannel {
  std::string name;
  ChannelVerification result;
  AllanOfChannel allan;  ///< of the simulation
  SpectrumOfChannel spectrum;
};

AllanOfChannel allan_of_channel(const Channel& channel, const AllanCurve& curve, const ModelCurve* model = nullptr);
/// `ci95`: one per bin.
SpectrumOfChannel spectrum_of_channel(const Channel& channel, const Spectrum& spectrum,
                                      const std::vector<std::optional<Interval>>& ci95,
                                      const ModelCurve* model = nullptr);

/// Reads what these rows wrote. Throws Error(input) with the place, also where lists do not go together.
AllanDocument read_allan(const MapReader& document);
SpectrumDocument read_spectra(const MapReader& document);

const Fields<AllanDocument>& allan_fields();
const Fields<SpectralLine>& line_fields();
const Fields<SpectrumOfChannel>& spectrum_channel_fields();
const Fields<SpectrumDocument>& spectrum_fields();
const Fields<DerivedNumbers>& derived_fields();
const Fields<TraceOfChannel>& trace_fields();
const Fields<VerificationOfChannel>& verification_fields();

}  // namespace libchar
