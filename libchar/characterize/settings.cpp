#include "libchar/characterize/settings.hpp"

#include <algorithm>

#include "libchar/allan/deviation_types.hpp"
#include "libchar/log/reading_fields.hpp"

namespace libchar {
namespace {

const std::vector<Word>& deviations() {
  static const std::vector<Word> words = [] {
    std::vector<Word> all;
    for (const DeviationRow& row : deviation_rows()) all.push_back({row.word, static_cast<int>(row.type)});
    return all;
  }();
  return words;
}

using Options = CharacterizeOptions;

const Fields<Options>& allan_settings() {
  static const Fields<Options> rows = {
      field<&Options::allan, &AllanOptions::type>("type", {.words = deviations()}),
      field<&Options::allan, &AllanOptions::grid>("taus"),
      field<&Options::allan, &AllanOptions::taus_s>("taus_s", {.unit = "s"}),
      field<&Options::allan, &AllanOptions::tau_min_s>("tau_min_s", {.unit = "s"}),
      field<&Options::allan, &AllanOptions::tau_max_s>("tau_max_s", {.unit = "s"}),
      field<&Options::ten_a_decade>("ten_a_decade"),
      field<&Options::full_overlap>("full_overlap"),
  };
  return rows;
}

const Fields<WelchOptions>& spectrum_settings() {
  static const Fields<WelchOptions> rows = {
      field<&WelchOptions::sides>("sides"),
      field<&WelchOptions::scaling>("scaling"),
      field<&WelchOptions::segment>("segment", {.unit = "samples"}),
      field<&WelchOptions::overlap>("overlap"),
      field<&WelchOptions::window>("window"),
      field<&WelchOptions::detrend>("detrend"),
  };
  return rows;
}

void read_terms(const MapReader& at, std::string_view key, FitOptions& fit) {
  if (!at.has(key)) return;
  fit.terms = {};
  for (const std::string& text : at.texts(key))
    for (std::size_t t = 0; t < kTerms; ++t)
      if (text == kTermNames[t].key) fit.terms[t] = true;
}

void write_terms(const Field& row, const FitOptions& fit, std::vector<Entry>& out) {
  std::vector<std::string> terms;
  for (std::size_t t = 0; t < kTerms; ++t)
    if (fit.terms[t]) terms.emplace_back(kTermNames[t].key);
  out.push_back({std::string(row.key), std::move(terms)});
}

const Fields<FitOptions>& fit_settings() {
  static const Fields<FitOptions> rows = {
      custom<FitOptions, read_terms, write_terms>("terms", "list of texts"),
      field<&FitOptions::threshold>("threshold"),
      field<&FitOptions::remedies>("remedies"),
      field<&FitOptions::white_top>("white_top"),
      field<&FitOptions::second_opinion>("second_opinion"),
      field<&FitOptions::profile_above>("profile_above"),
  };
  return rows;
}

// Six whatever they are, all others of the table where they were set: two runs that differ have two configurations.
const Fields<ReadOptions>& reading_settings() {
  static const Fields<ReadOptions> rows = [] {
    Fields<ReadOptions> all = selected(
        reading_fields(), {"channels", "time_column", "time_unit", "delimiter", "decimal", "header"}, Written::always);
    const std::vector<std::string> always_written = keys_of(all);
    for (const Field& row : reading_fields().rows)
      if (std::find(always_written.begin(), always_written.end(), row.key) == always_written.end())
        all.rows.push_back(row);
    return all;
  }();
  return rows;
}

void read_still(const MapReader& at, std::string_view key, Options& options) {
  if (!at.has(key)) return;
  const auto ends = at.interval(key);
  options.still.stretch_s = Interval{ends.first, ends.second};
}

void write_still(const Field& row, const Options& options, std::vector<Entry>& out) {
  if (options.still.stretch_s)
    out.push_back(
        {std::string(row.key), std::vector<double>{options.still.stretch_s->low, options.still.stretch_s->high}});
}

}  // namespace

const Fields<CharacterizeOptions>& characterize_fields() {
  static const Fields<Options> rows = [] {
    Fields<Options> all = {
        field<&Options::data>("data"),
        field<&Options::nominal_frequency>("nominal_frequency_hz", {.unit = "Hz"}),
        field<&Options::unwrap>("unwrap", {.meaning = "the values start again after this much"}),
        field<&Options::frozen>("frozen", {.meaning = "runs of this many equal values are missing"}),
        field<&Options::interpolated>("interpolated", {.meaning = "lines of this many samples are missing"}),
        field<&Options::memory_bytes>("memory_bytes", {.unit = "bytes"}),
        level<Options>("allan", always(allan_settings())),
        part<&Options::spectrum>("spectrum", always(spectrum_settings())),
        part<&Options::fit>("fit", always(fit_settings())),
        part<&Options::reading>("reading", reading_settings()),
    };
    all = always(all);
    all.rows.push_back(field<&Options::segment_s>("spectrum_segment_s", {.unit = "s"}).field);
    all.rows.push_back(field<&Options::quarter_segments>("spectrum_quarter").field);
    all.rows.push_back(field<&Options::temperature>("temperature").field);
    all.rows.push_back(field<&Options::still, &StillOptions::search>("still_search").field);
    all.rows.push_back(custom<Options, read_still, write_still>("still_s", "[low, high]", {.unit = "s"}).field);
    return all;
  }();
  return rows;
}

std::vector<Entry> settings_of(const CharacterizeOptions& options) {
  return entries_of(characterize_fields(), options);
}

}  // namespace libchar
