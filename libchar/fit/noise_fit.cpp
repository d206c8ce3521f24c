#include "libchar/fit/noise_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/fit/coefficients.hpp"
#include "libchar/fit/goodness.hpp"

namespace libchar {

std::string_view name_of(Status status) {
  switch (status) {
    case Status::detected:
      return "detected";
    case Status::not_detected:
      return "not_detected";
    case Status::undetermined:
      return "undetermined";
    case Status::given:
      return "given";
    case Status::not_fitted:
      return "not_fitted";
  }
  return "";
}

namespace {

void require_enough(std::size_t bins, const TermSet& terms) {
  const std::size_t wanted = count_of(terms);
  if (wanted == 0)
    throw Error({ErrorKind::usage,
                 "",
                 "",
                 "no noise term was asked for",
                 "",
                 "offer at least white noise"});
  if (bins >= wanted) return;
  throw Error(
      {ErrorKind::numeric,
       "",
       "",
       fmt::format(
           "{} bins of the spectrum are fewer than the {} noise terms to fit", bins, wanted),
       "",
       "use a longer record"});
}

NoiseFit fit_once(const std::vector<PowerBin>& bins,
                  double rate_hz,
                  std::uint64_t samples,
                  const FitOptions& options) {
  require_enough(bins.size(), options.terms);
  const BinProblem problem = bin_problem(bins);
  const Decision decision = decide(problem, options.terms, options.threshold);
  NoiseFit fit;
  fit.rate_hz = rate_hz;
  fit.samples = samples;
  fit.duration_s = static_cast<double>(samples) / rate_hz;
  fit.method = fmt::format("DCT-II Whittle likelihood, {} bins", bins.size());
  report_coefficients(problem, decision, options, fit);
  report_bounds(decision.kept, fit);
  fit.residuals = residuals_of(bins, fit.theta, rate_hz);
  fit.goodness = goodness_of(fit.residuals, count_of(only_positive(fit.theta)));
  return fit;
}

}  // namespace

NoiseFit fit_power_bins(const std::vector<PowerBin>& bins,
                        double rate_hz,
                        std::uint64_t samples,
                        const AllanCurve* allan,
                        const FitOptions& options) {
  NoiseFit fit = fit_once(bins, rate_hz, samples, options);
  static_cast<void>(allan);
  return fit;
}

NoiseFit fit_record(std::span<const double> record,
                    double rate_hz,
                    const AllanCurve* allan,
                    const FitOptions& options) {
  // One exact transform while it is cheap; a longer record goes by blocks.
  constexpr std::uint64_t kWhole = std::uint64_t{1} << 21U;
  const std::uint64_t block = record.size() <= kWhole ? std::max<std::uint64_t>(record.size(), 64)
                                                      : std::uint64_t{1} << 16U;
  PowerBinner binner(block);
  binner.push(record);
  std::uint64_t clipped = 0;
  const std::vector<PowerBin> bins =
      options.remedies ? binner.finish_clipped(rate_hz, clipped) : binner.finish(rate_hz);
  return fit_power_bins(bins, rate_hz, record.size(), allan, options);
}

}  // namespace libchar
