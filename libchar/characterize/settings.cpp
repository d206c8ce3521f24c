#include "libchar/characterize/settings.hpp"

#include "libchar/log/reading_fields.hpp"

namespace libchar {
namespace {

constexpr Word kKinds[] = {{"rate", static_cast<int>(SampleKind::rate)},
                           {"phase", static_cast<int>(SampleKind::phase)},
                           {"frequency", static_cast<int>(SampleKind::frequency)}};
constexpr Word kGrids[] = {{"octave", static_cast<int>(TauGrid::octave)},
                           {"decade", static_cast<int>(TauGrid::decade)},
                           {"dense", static_cast<int>(TauGrid::dense)},
                           {"list", static_cast<int>(TauGrid::list)}};
constexpr Word kSides[] = {{"one", static_cast<int>(Sides::one)},
                           {"two", static_cast<int>(Sides::two)}};
constexpr Word kScalings[] = {{"psd", static_cast<int>(Scaling::psd)},
                              {"ps", static_cast<int>(Scaling::ps)},
                              {"lsd", static_cast<int>(Scaling::lsd)},
                              {"ls", static_cast<int>(Scaling::ls)}};
constexpr Word kDetrends[] = {{"none", static_cast<int>(Detrend::none)},
                              {"constant", static_cast<int>(Detrend::constant)},
                              {"linear", static_cast<int>(Detrend::linear)}};

// The words of an enumeration by its own name_of.
template <class E>
std::vector<Word> named(E last) {
  std::vector<Word> words;
  for (int i = 0; i <= static_cast<int>(last); ++i)
    words.push_back({name_of(static_cast<E>(i)), i});
  return words;
}

const std::vector<Word>& deviations() {
  static const std::vector<Word> words = named(DeviationType::totdev);
  return words;
}

const std::vector<Word>& windows() {
  static const std::vector<Word> words = named(Window::hann_nonzero);
  return words;
}

using Options = CharacterizeOptions;

const Fields<Options>& allan_settings() {
  static const Fields<Options> rows = {
      field<&Options::allan, &AllanOptions::type>("type", {.words = deviations()}),
      field<&Options::allan, &AllanOptions::grid>("taus", {.words = kGrids}),
      field<&Options::allan, &AllanOptions::taus_s>("taus_s", {.unit = "s"}),
      field<&Options::allan, &AllanOptions::tau_min_s>("tau_min_s", {.unit = "s"}),
      field<&Options::allan, &AllanOptions::tau_max_s>("tau_max_s", {.unit = "s"}),
      field<&Options::full_overlap>("full_overlap"),
  };
  return rows;
}

const Fields<WelchOptions>& spectrum_settings() {
  static const Fields<WelchOptions> rows = {
      field<&WelchOptions::sides>("sides", {.words = kSides}),
      field<&WelchOptions::scaling>("scaling", {.words = kScalings}),
      field<&WelchOptions::segment>("segment", {.unit = "samples"}),
      field<&WelchOptions::overlap>("overlap"),
      field<&WelchOptions::window>("window", {.words = windows()}),
      field<&WelchOptions::detrend>("detrend", {.words = kDetrends}),
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
      field<&FitOptions::second_opinion>("second_opinion"),
      field<&FitOptions::profile_above>("profile_above"),
  };
  return rows;
}

const Fields<ReadOptions>& reading_settings() {
  static const Fields<ReadOptions> rows = [] {
    Fields<ReadOptions> all =
        selected(reading_fields(),
                 {"channels", "time_column", "time_unit", "delimiter", "decimal", "header"},
                 Written::always);
    for (const Field& row :
         selected(reading_fields(), {"rate_hz", "from_s", "to_s"}, Written::when_set).rows)
      all.rows.push_back(row);
    return all;
  }();
  return rows;
}

}  // namespace

const Fields<CharacterizeOptions>& characterize_fields() {
  static const Fields<Options> rows = [] {
    Fields<Options> all = {
        field<&Options::data>("data", {.words = kKinds}),
        field<&Options::nominal_frequency>("nominal_frequency_hz", {.unit = "Hz"}),
        field<&Options::memory_bytes>("memory_bytes", {.unit = "bytes"}),
        level<Options>("allan", always(allan_settings())),
        part<&Options::spectrum>("spectrum", always(spectrum_settings())),
        part<&Options::fit>("fit", always(fit_settings())),
        part<&Options::reading>("reading", reading_settings()),
    };
    all = always(all);
    all.rows.push_back(field<&Options::segment_s>("spectrum_segment_s", {.unit = "s"}).field);
    return all;
  }();
  return rows;
}

std::vector<Entry> settings_of(const CharacterizeOptions& options) {
  return entries_of(characterize_fields(), options);
}

}  // namespace libchar
