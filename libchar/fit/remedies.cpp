#include "libchar/fit/remedies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libchar/core/numeric/moments.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fit/detail/curve/coefficients.hpp"

namespace libchar {

double detail::kurtosis_sd(std::uint64_t samples) {
  // sqrt(24/n), times 1.4 for the correlation of -1/2 of neighbours.
  return 1.4 * std::sqrt(24.0 / static_cast<double>(std::max<std::uint64_t>(samples, 1)));
}

double spike_alarm(std::uint64_t samples) { return std::max(3.1, 3 + 5 * detail::kurtosis_sd(samples)); }

double kurtosis_of_differences(std::span<const double> record) {
  Moments moments;
  std::array<double, 4096> piece;
  for (std::size_t t = 1; t < record.size();) {
    const std::size_t n = std::min(piece.size(), record.size() - t);
    for (std::size_t i = 0; i < n; ++i) piece[i] = record[t + i] - record[t + i - 1];
    moments.push(std::span<const double>(piece).first(n));
    t += n;
  }
  return moments.kurtosis();
}

SpikeAnswer spike_answer(double kurtosis, double alarm, const SpikeCount& count) {
  SpikeAnswer answer;
  const SpikeVerdict verdict = judge_spikes(count);
  if (const std::string why = spike_sentence(count); !why.empty()) {
    answer.kept = finding("spikes_kept", why);
    answer.kept->count = count.left_out;
    if (verdict == SpikeVerdict::too_many) answer.kept->severity = Severity::caution;
  }
  if (verdict == SpikeVerdict::spikes)
    answer.remedy = {"spikes", fmt::format("kurtosis of differences {} > {}", brief_text(kurtosis), brief_text(alarm)),
                     plural(count.left_out, "sample") + " left out", count.left_out};
  const bool cleaned = answer.remedy.has_value();
  answer.outliers = outlier_variance(cleaned ? count.without : count.with, cleaned);
  return answer;
}

DespikedRecord without_spikes(std::span<const double> record, std::optional<double> known) {
  const double kurtosis = known ? *known : kurtosis_of_differences(record);
  const double alarm = spike_alarm(record.size());
  if (!(kurtosis > alarm)) return {};
  DespikedRecord out;
  SpikeCount count;
  out.samples = cleaned_record(record, count);
  out.answer = spike_answer(kurtosis, alarm, count);
  if (!out.answer.remedy) out.samples = std::vector<double>();  // `{}` would keep the memory
  return out;
}

void add_spike_answer(const SpikeAnswer& answer, NoiseFit& fit) {
  if (answer.remedy) fit.remedies.insert(fit.remedies.begin(), *answer.remedy);
  if (answer.kept) fit.findings.insert(fit.findings.begin(), *answer.kept);
}

Remedy lines_remedy(std::uint64_t clipped) {
  return {"lines", "coefficients of the spectrum above 32 times the floor around them",
          fmt::format("{} coefficients in and next to spectral lines left out", clipped), clipped};
}

double detail::share_of_lines(const ClippedBins& lines) {
  std::array<double, 2> with{}, line{};
  for (const PowerBin& bin : lines.all) {
    const auto rest = std::find_if(lines.bins.begin(), lines.bins.end(), [&](const PowerBin& other) {
      return other.low_hz == bin.low_hz && other.high_hz == bin.high_hz;
    });
    const double square = bin.frequency_hz * bin.frequency_hz;
    for (std::size_t i = 0; i < with.size(); ++i) {
      const double power = bin.dof * bin.energy * (i == 0 ? 1 : square);
      with[i] += power;
      if (rest != lines.bins.end()) line[i] += power * std::max(0.0, 1 - rest->energy / bin.energy);
    }
  }
  return std::max(line[0] / with[0], line[1] / with[1]);
}

Finding detail::lines_finding(const ClippedBins& lines, bool in_allan) {
  Finding found =
      finding("lines_left_out",
              fmt::format("Spectral lines: {} coefficients in and next to them were left out of the fit{}.",
                          lines.clipped, in_allan ? "; the Allan curve has them, and lies above the noise" : ""),
              in_allan ? "spectral lines were left out, and are in the Allan curve" : "spectral lines were left out");
  if (in_allan) found.severity = Severity::caution;
  return found;
}

Finding detail::cycle_finding(std::span<const Event> cycles) {
  const Event& strongest =
      *std::max_element(cycles.begin(), cycles.end(), [](const Event& a, const Event& b) { return a.size < b.size; });
  const std::size_t further = cycles.size() - 1;
  Finding found =
      finding("cycle",
              fmt::format("The record holds a cycle of {} (amplitude {}{}): it was removed before the noise was "
                          "fitted, and stays in the Allan curve.",
                          duration_text(strongest.period_s), brief_text(strongest.size, 3),
                          further > 0 ? fmt::format(", {} further line{}", further, further > 1 ? "s" : "") : ""),
              "a cycle was taken out");
  for (const Event& cycle : cycles) found.where.frequency_hz.push_back({1 / cycle.period_s, 1 / cycle.period_s});
  return found;
}

const Remedy* find_remedy(const NoiseFit& fit, std::string_view kind) {
  const auto found =
      std::find_if(fit.remedies.begin(), fit.remedies.end(), [&](const Remedy& r) { return r.kind == kind; });
  return found == fit.remedies.end() ? nullptr : &*found;
}

// Draws of what is there say nothing new, and a bootstrap of many follows the noise less well: a coefficient is then
// known to a twentieth of their share at best.
void detail::doubt_bridged(double share, NoiseFit& fit) {
  constexpr double kHarmless = 0.05, kSd = 0.05, kMost = 0.4;
  if (!(share > kHarmless)) return;
  bool doubted = false;
  for (Coefficient& term : fit.term) {
    if (!term.value) continue;
    widen_by(kSd * share, term);
    if (!(share > kMost) || term.status != Status::detected) continue;
    term.status = Status::undetermined;
    doubted = true;
  }
  if (doubted)
    fit.findings.push_back(
        finding("undetermined",
                fmt::format("{} of the readings of the phase are missing: the coefficients are those "
                            "of a phase that was filled.",
                            percent_text(share)),
                "the coefficients are those of a phase that was filled"));
}

}  // namespace libchar
