#include "libchar/report/text/pair_spectra_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/characterize/curves/model_curve.hpp"
#include "libchar/core/text/csv_cell.hpp"
#include "libchar/report/detail/json_pieces.hpp"

namespace libchar {
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
  std::string text = fmt::format(
      "frequency_hz,{},{},{},phase_rad,phase_sd_rad,{},{},coherence,coherence_unbiased\n",
      head("real", unit),
      head("imaginary", unit),
      head("magnitude", unit),
      head(cross.first.name, spectrum_unit(Scaling::psd, cross.first.unit)),
      head(cross.second.name, spectrum_unit(Scaling::psd, cross.second.unit)));
  for (std::size_t k = 0; k < c.density.size(); ++k)
    text += csv_line(c.frequency_hz[k],
                     c.density[k].real(),
                     c.density[k].imag(),
                     std::abs(c.density[k]),
                     std::arg(c.density[k]),
                     c.phase_sd_rad[k],
                     c.first[k],
                     c.second[k],
                     c.coherence[k],
                     c.coherence_unbiased[k]);
  return text;
}

std::string coherence_csv(const LogCrossSpectrum& cross) {
  const CrossSpectrum& c = cross.cross;
  std::string text = "frequency_hz,coherence,coherence_unbiased,significant\n";
  for (std::size_t k = 0; k < c.coherence.size(); ++k)
    text += csv_line(c.frequency_hz[k],
                     c.coherence[k],
                     c.coherence_unbiased[k],
                     c.coherence[k] > c.significant_coherence ? 1 : 0);
  return text;
}

Json cross_json(const LogCrossSpectrum& cross) {
  const CrossSpectrum& c = cross.cross;
  Json out;
  out["first"] = {{"name", json_text(cross.first.name)}, {"unit", json_text(cross.first.unit)}};
  out["second"] = {{"name", json_text(cross.second.name)}, {"unit", json_text(cross.second.unit)}};
  out["sides"] = name_of(c.sides);
  out["window"] = name_of(c.window);
  out["rate_hz"] = c.rate_hz;
  out["value_unit"] = json_text(product_unit(cross));
  out["segment"] = c.segment;
  out["segments"] = c.segments;
  out["dropped"] = c.dropped;
  out["effective_segments"] = json_number(c.effective_segments);
  out["significant_coherence"] = json_number(c.significant_coherence);
  for (const char* key : {"frequency_hz",
                          "real",
                          "imaginary",
                          "phase_rad",
                          "phase_sd_rad",
                          "first_density",
                          "second_density",
                          "coherence",
                          "coherence_unbiased"})
    out[key] = Json::array();
  for (std::size_t k = 0; k < c.density.size(); ++k) {
    out["frequency_hz"].push_back(c.frequency_hz[k]);
    out["real"].push_back(json_number(c.density[k].real()));
    out["imaginary"].push_back(json_number(c.density[k].imag()));
    out["phase_rad"].push_back(json_number(std::arg(c.density[k])));
    out["phase_sd_rad"].push_back(json_number(c.phase_sd_rad[k]));
    out["first_density"].push_back(json_number(c.first[k]));
    out["second_density"].push_back(json_number(c.second[k]));
    out["coherence"].push_back(json_number(c.coherence[k]));
    out["coherence_unbiased"].push_back(json_number(c.coherence_unbiased[k]));
  }
  out["notes"] = Json::array();
  for (const std::string& note : c.notes) out["notes"].push_back(json_text(note));
  return out;
}

std::string spectrograms_csv(const LogSpectrograms& spectrograms) {
  std::string text = "channel,unit,time_s,frequency_hz,value\n";
  for (std::size_t c = 0; c < spectrograms.channels.size(); ++c) {
    const Spectrogram& s = spectrograms.spectrograms[c];
    const std::string unit = spectrum_unit(s.scaling, spectrograms.channels[c].unit);
    for (std::size_t i = 0; i < s.time_s.size(); ++i)
      for (std::size_t k = 0; k < s.value[i].size(); ++k)
        text += csv_line(
            spectrograms.channels[c].name, unit, s.time_s[i], s.frequency_hz[k], s.value[i][k]);
  }
  return text;
}

Json spectrograms_json(const LogSpectrograms& spectrograms) {
  Json out;
  out["channels"] = Json::array();
  for (std::size_t c = 0; c < spectrograms.channels.size(); ++c) {
    const Spectrogram& s = spectrograms.spectrograms[c];
    const Channel& channel = spectrograms.channels[c];
    Json one = {{"name", json_text(channel.name)}, {"unit", json_text(channel.unit)}};
    one["value_unit"] = json_text(spectrum_unit(s.scaling, channel.unit));
    one["time_s"] = s.time_s;
    one["frequency_hz"] = s.frequency_hz;
    one["value"] = Json::array();
    for (const auto& powers : s.value) {
      Json row = powers.empty() ? Json(nullptr) : Json::array();
      for (const double power : powers) row.push_back(json_number(power));
      one["value"].push_back(std::move(row));
    }
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

}  // namespace libchar
