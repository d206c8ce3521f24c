#pragma once
// A characterization as its report shows it, computed once: verdict, what was found, what asks for a look, the curves
// of the fitted model, where its coefficients are read off, which number goes where. HTML, JSON and CSV only print it.

#include <optional>
#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/curves/model_curve.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/export/exports.hpp"

namespace libchar {

/// What the fit predicts for a measured curve.
struct ModelCurve {
  std::vector<std::optional<double>> values;       ///< one per point of the curve; none: unknown there
  std::vector<std::optional<Interval>> intervals;  ///< of the Allan curve, as many; empty: not stated (spectra)
  std::vector<Asymptote> asymptotes;               ///< of its terms
};

/// A coefficient as the fit of the Allan curve sees it.
struct OtherOpinion {
  Term term = Term::white;
  double value = 0, sd = 0;
  std::optional<double> apart;  ///< from the first fit, in combined standard deviations
};

/// Something found in the record, at its place in time.
struct TraceMark {
  std::string kind;             ///< "step", "warm-up", "ramp", "motion", "strength", "frozen", "filled"
  double from_s = 0, to_s = 0;  ///< alike for an instant
  std::string label;            ///< "step 0.0031 deg/s"
};

/// "Angular rate" of "deg/s"; "" of a unit that is not known.
namespace detail {
std::string quantity_title(const std::string& unit);
}

/// Channels of one kind, which share a plot.
struct ChannelGroup {
  std::string title;  ///< "Angular rate"
  std::string unit;   ///< for its axis
  std::vector<std::size_t> channels;
};

struct ChannelView {
  const ChannelResult* result = nullptr;
  std::string unit;        ///< in its usual spelling, "m/s²"; "" where none is stated
  std::string shown_unit;  ///< in texts: "U" where none is stated, "" for a ratio
  std::string trace_unit;  ///< the same of the trace's
  Judgement judgement;
  std::string summary;                            ///< one sentence
  std::vector<TraceMark> marks;                   ///< in the trace
  double plain_from_s = 0;                        ///< averaging time from which on the noise terms alone are the curve
  std::vector<std::string> findings;              ///< sentences with numbers
  std::vector<std::string> beside_terms;          ///< those of them that are not about a noise term
  std::vector<std::string> cautions;              ///< what asks for a look before the numbers are used
  std::string goodness;                           ///< how well the model explains the channel; "" without a fit
  const AllanPoint* allan_minimum = nullptr;      ///< lowest reliable point; null: none
  std::optional<double> per_sample_sd;            ///< N·√f: what white noise alone gives in a sample
  std::optional<double> noise_density_one_sided;  ///< √2·N, as in data sheets
  std::vector<ReadOff> read_off;                  ///< points of the Allan curve
  std::optional<ModelCurve> allan_model, spectrum_model;              ///< none: no fit
  std::vector<std::optional<Interval>> spectrum_ci68, spectrum_ci95;  ///< one per bin; none: no dof
  std::vector<std::optional<Interval>> verification_ci95;             ///< of the simulation's spectrum
  std::vector<OtherOpinion> other_opinions;
  std::vector<ConsumerNumber> consumers;  ///< which number goes where
  /// of the Allan curve, one per point: a sensor at the limits of its data sheet; empty: no limits for this channel
  std::vector<std::optional<double>> data_sheet;
  bool draws_allan = false, draws_spectrum = false;  ///< something can be drawn on logarithmic axes
  bool in_detail = true;                             ///< has curves and a part of its own on a page
};

/// Most channels that a page shows in detail: those that ask for a look most. The others get a sentence and a row of
/// the table.
inline constexpr std::size_t kMostInDetail = 100;

/// Points into the result that it is a view of, which must live as long.
struct CharacterizationView {
  const Characterization* result = nullptr;
  std::string verdict;           ///< a paragraph
  Rating rating = Rating::good;  ///< the worst of the channels
  double duration_s = 0;         ///< of the recording; 0: not known
  std::vector<ChannelView> channels;
  std::vector<ChannelGroup> groups;  ///< in the order of their first channels
};

CharacterizationView characterization_view(const Characterization& result);
CharacterizationView characterization_view(Characterization&&) = delete;

}  // namespace libchar
