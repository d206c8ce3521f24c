#include "libchar/report/text/curves_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "libchar/characterize/curves/curve_document.hpp"
#include "libchar/characterize/curves/model_curve.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/core/text/markup.hpp"
#include "libchar/report/detail/report_rows.hpp"
#include "libchar/spectrum/spectrum.hpp"
#include "libchar/spectrum/spectrum_words.hpp"

namespace libchar {
namespace {

/// What is known of a curve: of its channel, and of the recording where a quantity depends on it.
std::string known_of(std::vector<Finding> findings, const Findings& recording) {
  detail::add_findings_of(recording, findings);
  return detail::findings_cell(findings);
}

}  // namespace

std::string allan_csv(const std::vector<Channel>& channels, const std::vector<AllanCurve>& curves,
                      const std::vector<std::vector<Finding>>& findings, const Findings& recording) {
  std::string text = "channel,unit,tau_s,deviation,low68,high68,low95,high95,edf,terms,curve,findings\n";
  for (std::size_t c = 0; c < std::min(channels.size(), curves.size()); ++c) {
    const std::string known_of_it = known_of(c < findings.size() ? findings[c] : std::vector<Finding>{}, recording);
    for (const AllanPoint& p : curves[c].points) {
      const bool stated = !deviation_row(curves[c].type).without_interval();
      const auto known = [&](double value) { return stated ? value : kNone; };
      text += csv_line(channels[c].name, deviation_unit(curves[c].type, channels[c].unit), p.tau_s, p.deviation,
                       known(p.ci68.low), known(p.ci68.high), known(p.ci95.low), known(p.ci95.high), known(p.edf),
                       p.terms, name_of(curves[c].type), known_of_it);
    }
  }
  return text;
}

namespace {

/// In the order in which they come.
std::vector<DeviationType> types_of(const std::vector<AllanCurve>& curves) {
  std::vector<DeviationType> types;
  for (const AllanCurve& curve : curves)
    if (std::find(types.begin(), types.end(), curve.type) == types.end()) types.push_back(curve.type);
  return types;
}

}  // namespace

Json allan_json(const std::vector<Channel>& channels, const std::vector<AllanCurve>& curves,
                const std::vector<std::vector<Finding>>& findings) {
  const std::vector<DeviationType> types = types_of(curves);
  AllanDocument out;
  out.type = name_of(types.empty() ? DeviationType::oadev : types[0]);
  if (types.size() > 1)
    for (const DeviationType type : types) out.types.emplace_back(name_of(type));
  for (std::size_t i = 0; i < std::min(channels.size(), curves.size()); ++i) {
    out.channels.push_back(allan_of_channel(channels[i], curves[i]));
    if (types.size() > 1) out.channels.back().type = name_of(curves[i].type);
    if (i < findings.size()) out.channels.back().findings = findings[i];
  }
  return document_of(allan_fields(), out);
}

std::string spectra_csv(const LogSpectra& spectra) {
  std::string text = "frequency_hz";
  std::vector<double> axis;  // of channels with a rate of their own too
  std::string known;         // of each channel, in the first row
  bool any = false;
  for (const ChannelResult& c : spectra.channels) {
    text += "," + csv_cell(fmt::format("{}[{}]", c.channel.name, spectrum_unit(c.spectrum.scaling, c.channel.unit)));
    const std::vector<double> before = std::exchange(axis, {}), &own = c.spectrum.frequency_hz;
    std::set_union(before.begin(), before.end(), own.begin(), own.end(), std::back_inserter(axis));
    const std::string cell = known_of(findings_of(c), spectra.log.warnings);
    known += (&c == spectra.channels.data() ? "" : "|") + cell;
    any = any || !cell.empty();
  }
  text += any ? ",findings\n" : "\n";
  std::vector<std::size_t> next(spectra.channels.size());
  for (const double frequency : axis) {
    text += csv_cell(frequency);
    for (std::size_t c = 0; c < next.size(); ++c) {
      const Spectrum& own = spectra.channels[c].spectrum;
      const bool has = next[c] < own.value.size() && own.frequency_hz[next[c]] == frequency;
      text += has ? "," + csv_cell(own.value[next[c]++]) : ",";
    }
    if (any) text += "," + csv_cell(std::exchange(known, ""));
    text += "\n";
  }
  return text;
}

std::string lines_csv(const LogSpectra& spectra) {
  std::string text = "channel,unit,frequency_hz,amplitude,excess,width_hz\n";
  for (const ChannelResult& c : spectra.channels)
    for (const SpectralLine& line : c.lines)
      text += csv_line(c.channel.name, c.channel.unit, line.frequency_hz, line.amplitude, line.excess, line.width_hz);
  return text;
}

Json spectra_json(const LogSpectra& spectra, const CharacterizeOptions& options) {
  Json document = Json::object();
  document["sides"] = name_of(options.spectrum.sides);
  document["scaling"] = name_of(options.spectrum.scaling);
  document["window"] = name_of(options.spectrum.window);
  if (options.average == SegmentAverage::median) document["average"] = name_of(options.average);
  document["overlap"] = options.spectrum.overlap;
  document["detrend"] = name_of(options.spectrum.detrend);
  document["rate_hz"] = spectra.log.time.rate_hz;
  document["channels"] = Json::array();
  for (const ChannelResult& c : spectra.channels) {
    SpectrumOfChannel one = spectrum_of_channel(c.channel, c.spectrum, spectrum_intervals(c.spectrum, 0.95));
    one.with_lines = options.wanted.lines;
    one.lines = c.lines;
    one.findings = findings_of(c);
    document["channels"].push_back(document_of(spectrum_channel_fields(), one));
  }
  return document;
}

namespace {

Json channel_head(const Channel& channel) {
  return {{"name", json_text(channel.name)}, {"unit", json_text(channel.unit)}};
}

double middle_s(const DynamicWindow& window) { return (window.from_s + window.to_s) / 2; }

}  // namespace

std::string hat_csv(const LogHat& hat) {
  std::string text = "channel,unit,tau_s,deviation,variance,variance_sd,status,terms\n";
  for (std::size_t c = 0; c < hat.channels.size(); ++c)
    for (const HatPoint& p : hat.hat.devices[c])
      text += csv_line(hat.channels[c].name, hat.channels[c].unit, p.tau_s, p.deviation, p.variance, p.variance_sd,
                       name_of(p.status), p.terms);
  return text;
}

Json hat_json(const LogHat& hat) {
  Json out = json_frame("cornered-hat");
  out["type"] = name_of(hat.hat.type);
  out["channels"] = Json::array();
  for (std::size_t c = 0; c < hat.channels.size(); ++c) {
    Json channel = channel_head(hat.channels[c]);
    const std::vector<HatPoint>& points = hat.hat.devices[c];
    channel["tau_s"] = list_json(points, &HatPoint::tau_s);
    channel["deviation"] = list_json(points, &HatPoint::deviation);
    channel["variance"] = list_json(points, &HatPoint::variance);
    channel["variance_sd"] = list_json(points, &HatPoint::variance_sd);
    channel["status"] = list_json(points, [](const HatPoint& p) { return name_of(p.status); });
    channel["terms"] = list_json(points, &HatPoint::terms);
    channel["m"] = list_json(points, &HatPoint::m);
    out["channels"].push_back(std::move(channel));
  }
  out["notes"] = texts_json(hat.hat.notes);
  return out;
}

std::string dynamic_csv(const LogDynamic& dynamic) {
  std::string text = "channel,unit,time_s,from_s,to_s,tau_s,deviation,terms\n";
  for (std::size_t c = 0; c < dynamic.channels.size(); ++c)
    for (const DynamicWindow& window : dynamic.deviations[c].windows)
      for (const AllanPoint& p : window.curve.points)
        text += csv_line(dynamic.channels[c].name, dynamic.channels[c].unit, middle_s(window), window.from_s,
                         window.to_s, p.tau_s, p.deviation, p.terms);
  return text;
}

Json dynamic_json(const LogDynamic& dynamic) {
  Json out = json_frame("dynamic-allan");
  out["type"] = name_of(dynamic.deviations.empty() ? DeviationType::oadev : dynamic.deviations[0].type);
  out["channels"] = Json::array();
  for (std::size_t c = 0; c < dynamic.channels.size(); ++c) {
    Json channel = channel_head(dynamic.channels[c]);
    channel["windows"] = Json::array();
    for (const DynamicWindow& window : dynamic.deviations[c].windows) {
      Json one = {{"time_s", middle_s(window)}, {"from_s", window.from_s}, {"to_s", window.to_s}};
      one["tau_s"] = list_json(window.curve.points, &AllanPoint::tau_s);
      one["deviation"] = list_json(window.curve.points, &AllanPoint::deviation);
      one["terms"] = list_json(window.curve.points, &AllanPoint::terms);
      channel["windows"].push_back(std::move(one));
    }
    channel["notes"] = texts_json(dynamic.deviations[c].notes);
    out["channels"].push_back(std::move(channel));
  }
  return out;
}

namespace {

std::string product_unit(const LogCrossSpectrum& cross) {
  const std::string a = cross.first.unit.empty() ? "1" : cross.first.unit,
                    b = cross.second.unit.empty() ? "1" : cross.second.unit;
  return a == b ? spectrum_unit(Scaling::psd, cross.first.unit) : fmt::format("{}*{}/Hz", a, b);
}

}  // namespace

std::string cross_csv(const LogCrossSpectrum& cross) {
  const CrossSpectrum& c = cross.cross;
  const std::string unit = product_unit(cross);
  const auto head = [&](const std::string& name, const std::string& of) {
    return csv_cell(fmt::format("{}[{}]", name, of));
  };
  std::string text = fmt::format("frequency_hz,{},{},{},phase_rad,phase_sd_rad,{},{},coherence,coherence_unbiased\n",
                                 head("real", unit), head("imaginary", unit), head("magnitude", unit),
                                 head(cross.first.name, spectrum_unit(Scaling::psd, cross.first.unit)),
                                 head(cross.second.name, spectrum_unit(Scaling::psd, cross.second.unit)));
  for (std::size_t k = 0; k < c.density.size(); ++k)
    text += csv_line(c.frequency_hz[k], c.density[k].real(), c.density[k].imag(), std::abs(c.density[k]),
                     std::arg(c.density[k]), c.phase_sd_rad[k], c.first[k], c.second[k], c.coherence[k],
                     c.coherence_unbiased[k]);
  return text;
}

std::string coherence_csv(const LogCrossSpectrum& cross) {
  const CrossSpectrum& c = cross.cross;
  std::string text = "frequency_hz,coherence,coherence_unbiased,significant\n";
  for (std::size_t k = 0; k < c.coherence.size(); ++k)
    text += csv_line(c.frequency_hz[k], c.coherence[k], c.coherence_unbiased[k],
                     c.coherence[k] > c.significant_coherence ? 1 : 0);
  return text;
}

Json cross_json(const LogCrossSpectrum& cross) {
  const CrossSpectrum& c = cross.cross;
  Json out = Json::object();
  out["first"] = channel_head(cross.first);
  out["second"] = channel_head(cross.second);
  out["sides"] = name_of(c.sides);
  out["window"] = name_of(c.window);
  out["rate_hz"] = c.rate_hz;
  out["value_unit"] = json_text(product_unit(cross));
  out["segment"] = c.segment;
  out["segments"] = c.segments;
  out["dropped"] = c.dropped;
  out["effective_segments"] = json_number(c.effective_segments);
  out["significant_coherence"] = json_number(c.significant_coherence);
  using Density = std::complex<double>;
  out["frequency_hz"] = c.frequency_hz;
  out["real"] = list_json(c.density, [](const Density& d) { return d.real(); });
  out["imaginary"] = list_json(c.density, [](const Density& d) { return d.imag(); });
  out["phase_rad"] = list_json(c.density, [](const Density& d) { return std::arg(d); });
  out["phase_sd_rad"] = list_json(c.phase_sd_rad, std::identity());
  out["first_density"] = list_json(c.first, std::identity());
  out["second_density"] = list_json(c.second, std::identity());
  out["coherence"] = list_json(c.coherence, std::identity());
  out["coherence_unbiased"] = list_json(c.coherence_unbiased, std::identity());
  out["notes"] = texts_json(c.notes);
  return out;
}

std::string spectrograms_csv(const LogSpectrograms& spectrograms) {
  std::string text = "channel,unit,time_s,frequency_hz,value\n";
  for (std::size_t c = 0; c < spectrograms.channels.size(); ++c) {
    const Spectrogram& s = spectrograms.spectrograms[c];
    const std::string unit = spectrum_unit(s.scaling, spectrograms.channels[c].unit);
    for (std::size_t i = 0; i < s.time_s.size(); ++i)
      for (std::size_t k = 0; k < s.value[i].size(); ++k)
        text += csv_line(spectrograms.channels[c].name, unit, s.time_s[i], s.frequency_hz[k], s.value[i][k]);
  }
  return text;
}

Json spectrograms_json(const LogSpectrograms& spectrograms) {
  Json out = Json::object();
  out["channels"] = Json::array();
  for (std::size_t c = 0; c < spectrograms.channels.size(); ++c) {
    const Spectrogram& s = spectrograms.spectrograms[c];
    const Channel& channel = spectrograms.channels[c];
    Json one = channel_head(channel);
    one["value_unit"] = json_text(spectrum_unit(s.scaling, channel.unit));
    one["time_s"] = s.time_s;
    one["frequency_hz"] = s.frequency_hz;
    one["value"] = list_json(s.value, [&](const auto& powers) {
      return powers.empty() ? Json(nullptr) : list_json(powers, std::identity());
    });
    out["channels"].push_back(std::move(one));
  }
  if (spectrograms.spectrograms.empty()) return out;
  const Spectrogram& like = spectrograms.spectrograms[0];
  out["sides"] = name_of(like.sides);
  out["scaling"] = name_of(like.scaling);
  out["window"] = name_of(like.window);
  out["rate_hz"] = like.rate_hz;
  out["segment"] = like.segment;
  return out;
}

// curves.csv: one tidy table, a row for each point of each curve.

namespace {

Interval or_none(const std::optional<Interval>& interval) { return interval.value_or(Interval{kNone, kNone}); }

void add_allan(std::string& out, const ChannelView& view, const Findings& recording) {
  const ChannelResult& c = *view.result;
  const std::string known_of_it = known_of(detail::findings_of_curve(c), recording);
  for (std::size_t i = 0; i < c.allan.points.size(); ++i) {
    const AllanPoint& p = c.allan.points[i];
    const auto known = [&](double value) { return p.edf > 0 ? value : kNone; };
    const Interval model = view.allan_model ? or_none(view.allan_model->intervals[i]) : or_none({});
    out += csv_line(name_of(c.allan.type), c.channel.name, c.channel.unit, "s", p.tau_s, p.deviation, known(p.ci68.low),
                    known(p.ci68.high), known(p.ci95.low), known(p.ci95.high), known(p.edf), p.terms,
                    view.allan_model ? view.allan_model->values[i] : std::nullopt, model.low, model.high, known_of_it);
  }
}

void add_spectrum(std::string& out, const ChannelView& view, const Findings& recording) {
  const ChannelResult& c = *view.result;
  const Spectrum& s = c.spectrum;
  const std::string curve = detail::spectrum_kind_word({s.scaling, s.sides});
  const std::string unit = spectrum_unit(s.scaling, c.channel.unit);
  const std::string known_of_it = known_of(findings_of(c), recording);
  for (std::size_t i = 0; i < s.frequency_hz.size(); ++i) {
    const Interval ci68 = or_none(view.spectrum_ci68[i]), ci95 = or_none(view.spectrum_ci95[i]);
    out += csv_line(curve, c.channel.name, unit, "Hz", s.frequency_hz[i], s.value[i], ci68.low, ci68.high, ci95.low,
                    ci95.high, i < s.dof.size() && s.dof[i] > 0 ? s.dof[i] : kNone, "",
                    view.spectrum_model ? view.spectrum_model->values[i] : std::nullopt, "", "", known_of_it);
  }
}

}  // namespace

std::string csv_curves(const CharacterizationView& view) {
  std::string out =
      "curve,channel,unit,x_unit,x,value,low68,high68,low95,high95,dof,terms,model,model_low95,model_high95,findings\n";
  for (const ChannelView& channel : view.channels) {
    add_allan(out, channel, view.result->log.warnings);
    add_spectrum(out, channel, view.result->log.warnings);
  }
  return out;
}

std::string csv_curves(const Characterization& result) { return csv_curves(characterization_view(result)); }

}  // namespace libchar
