#include "libchar/report/text/spectra_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libchar/characterize/curves/curve_document.hpp"
#include "libchar/core/text/csv_cell.hpp"
#include "libchar/spectrum/spectrum_interval.hpp"

namespace libchar {
std::string spectra_csv(const LogSpectra& spectra) {
  std::string text = "frequency_hz";
  for (const ChannelSpectrum& c : spectra.channels)
    text += "," + csv_cell(fmt::format(
                      "{}[{}]", c.channel.name, spectrum_unit(c.spectrum.scaling, c.channel.unit)));
  text += "\n";
  const std::vector<double>& frequency = spectra.channels.front().spectrum.frequency_hz;
  for (std::size_t k = 0; k < frequency.size(); ++k) {
    text += csv_cell(frequency[k]);
    for (const ChannelSpectrum& c : spectra.channels) text += "," + csv_cell(c.spectrum.value[k]);
    text += "\n";
  }
  return text;
}

std::string lines_csv(const LogSpectra& spectra) {
  std::string text = "channel,unit,frequency_hz,amplitude,excess,width_hz\n";
  for (const ChannelSpectrum& c : spectra.channels)
    for (const SpectralLine& line : c.lines)
      text += csv_line(c.channel.name,
                       c.channel.unit,
                       line.frequency_hz,
                       line.amplitude,
                       line.excess,
                       line.width_hz);
  return text;
}

Json spectra_json(const LogSpectra& spectra, const LogSpectraOptions& options) {
  Json document;
  document["sides"] = name_of(options.spectrum.sides);
  document["scaling"] = name_of(options.spectrum.scaling);
  document["window"] = name_of(options.spectrum.window);
  if (options.average == SegmentAverage::median) document["average"] = name_of(options.average);
  document["overlap"] = options.spectrum.overlap;
  document["detrend"] = name_of(options.spectrum.detrend);
  document["rate_hz"] = spectra.log.time.rate_hz;
  document["channels"] = Json::array();
  for (const ChannelSpectrum& c : spectra.channels) {
    SpectrumOfChannel one =
        spectrum_of_channel(c.channel, c.spectrum, spectrum_intervals(c.spectrum, 0.95));
    one.with_lines = options.lines;
    one.lines = c.lines;
    document["channels"].push_back(document_of(spectrum_channel_fields(), one));
  }
  return document;
}

}  // namespace libchar
