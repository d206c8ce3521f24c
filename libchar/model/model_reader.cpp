#include "libchar/model/model_reader.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <numbers>
#include <tuple>

#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/model/detail/noise_units.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{16} << 20U;

const std::vector<std::string> kStatuses = {
    "detected", "not_detected", "undetermined", "given", "not_fitted"};

Status status_of(const std::string& word) {
  return find_enum<Status>(word).value_or(Status::given);
}

std::vector<std::string> model_keys() {
  std::vector<std::string> keys = {"format",
                                   "version",
                                   "tool",
                                   "channel",
                                   "unit",
                                   "kind",
                                   "axis",
                                   "rate_hz",
                                   "sampling",
                                   "density"};
  for (const TermName& name : kTermNames) keys.emplace_back(name.key);
  for (const char* key : {"noise_sampling",
                          "noise_start",
                          "flicker_method",
                          "white_hold_s",
                          "flicker_hold_s",
                          "scale_factor",
                          "nonlinearity",
                          "bias",
                          "reference_temperature_degc",
                          "bandwidth_hz",
                          "saturation",
                          "sensitivity",
                          "resolution",
                          "mean",
                          "obtained",
                          "method",
                          "recording",
                          "valid_tau_s",
                          "remarks"})
    keys.emplace_back(key);
  return keys;
}

// Sidedness of every value that is written per √Hz.
enum class Density { unsaid, one, two };

double side_factor(const MapReader& at, std::string_view key, Density density) {
  if (density == Density::one) return 1 / std::numbers::sqrt2;
  if (density == Density::two) return 1;
  at.refuse(key,
            "a density is one-sided or two-sided, and this file does not say which",
            "add density: one-sided (data sheets) or density: two-sided, or give the unit per √h "
            "or in ·√s");
}

// What a coefficient is multiplied by to get the two-sided density in the channel's unit.
struct Conversion {
  double factor = 1;
  std::string sentence;  ///< empty when nothing was converted
};

Conversion conversion(const MapReader& at,
                      std::string_view unit_key,
                      std::size_t t,
                      const std::optional<std::string>& unit,
                      const std::string& channel_unit,
                      Density density,
                      bool floor) {
  const Term term = static_cast<Term>(t);
  const std::string own = term_unit(kTermNames[t].key, channel_unit);
  NoiseUnit understood;
  if (unit) {
    const auto found = find_noise_unit(term, *unit, channel_unit);
    if (!found)
      at.refuse(
          unit_key,
          fmt::format("is no unit of {} for a channel in {}",
                      kTermNames[t].key,
                      channel_unit.empty() ? "an unnamed unit" : channel_unit),
          fmt::format("such as {}", fmt::join(noise_unit_examples(term, channel_unit), ", ")));
    understood = *found;
  } else {
    understood.density = term == Term::white || term == Term::walk;
  }
  Conversion out{understood.factor, ""};
  std::vector<std::string> said;
  if (std::abs(understood.factor - 1) > 1e-15) said.push_back(fmt::format("{} to {}", *unit, own));
  if (understood.density) {
    out.factor *= side_factor(at, unit ? unit_key : kTermNames[t].key, density);
    if (density == Density::one) said.push_back("one-sided to two-sided density (divided by √2)");
  }
  if (floor) {
    out.factor /= std::sqrt(2 * std::numbers::ln2 / std::numbers::pi);
    said.push_back("floor of the Allan curve to coefficient (divided by 0.6643)");
  }
  if (!said.empty())
    out.sentence = fmt::format("{}: converted from {}", kTermNames[t].key, fmt::join(said, ", "));
  return out;
}

class ModelReader {
 public:
  ModelReader(const Document& node, const std::string& file, const std::string& path)
      : top_(node, file, path, model_keys()) {}

  SensorModel read() {
    identity();
    const std::string density = top_.word_or("density", {"one-sided", "two-sided"}, "");
    density_ = density == "one-sided" ? Density::one
               : density.empty()      ? Density::unsaid
                                      : Density::two;
    for (std::size_t t = 0; t < kTerms; ++t) model_.noise[t] = term(t);
    noise_options();
    blocks();
    provenance();
    return std::move(model_);
  }

 private:
  void identity() {
    model_.channel = top_.text_or("channel", "");
    model_.unit = top_.text_or("unit", "");
    model_.kind = top_.text_or("kind", "");
    model_.axis = top_.word_or("axis", {"x", "y", "z", ""}, "");
    model_.rate_hz = top_.number_or("rate_hz", 0, kNotNegative);
    top_.word_or("sampling", {"point"}, "point");
    if (top_.has("tool")) top_.map("tool", {"name", "version"});
  }

  Coefficient term(std::size_t t) {
    const std::string key(kTermNames[t].key);
    const Document* node = top_.get(key);
    if (node == nullptr) return {};
    Coefficient c;
    c.status = Status::given;
    if (node->kind != Document::Kind::map) {
      c.value = top_.number(key, kNotNegative);
      const Conversion conversion = ::libchar::conversion(
          top_, key, t, std::nullopt, model_.unit, *c.value == 0 ? Density::two : density_, false);
      apply(key, c, conversion);
      return c;
    }
    const MapReader at =
        top_.map(key, {"value", "unit", "ci95", "ci95_by", "upper95", "status", "reading"});
    c.value = at.maybe_number("value", kNotNegative);
    c.upper95 = at.maybe_number("upper95", kNotNegative);
    if (at.has("ci95")) {
      const auto ends = at.interval("ci95");
      if (ends.first < 0) at.refuse("ci95", "expected numbers of at least 0");
      c.ci95 = {ends.first, ends.second};
    }
    c.profile = at.word_or("ci95_by", {"profile", "covariance"}, "covariance") == "profile";
    c.status = status_of(at.word_or("status", kStatuses, "given"));
    check_status(at, c);
    const bool floor = at.word_or("reading", {"coefficient", "floor"}, "coefficient") == "floor";
    if (floor && static_cast<Term>(t) != Term::flicker)
      at.refuse("reading", "only bias_instability can be read off the floor of a curve");
    if (!c.value && !c.upper95) return c;
    std::optional<std::string> unit;
    if (at.has("unit")) unit = at.text("unit");
    const bool none = c.value.value_or(0) == 0 && c.upper95.value_or(0) == 0;
    apply(key,
          c,
          conversion(at, "unit", t, unit, model_.unit, none ? Density::two : density_, floor));
    return c;
  }

  static void check_status(const MapReader& at, const Coefficient& c) {
    const bool needs = c.status == Status::detected || c.status == Status::given;
    if (needs && !c.value)
      at.refuse("value", fmt::format("a term that is {} has a value", name_of(c.status)));
    if (c.status == Status::not_detected && c.value)
      at.refuse("value", "a term that is not_detected has no value, only upper95");
    if (c.status == Status::not_fitted && c.value)
      at.refuse("value",
                "a term that is not_fitted has no value; status: given for one that is stated");
  }

  void apply(const std::string& key, Coefficient& c, const Conversion& conversion) {
    if (c.value) *c.value *= conversion.factor;
    if (c.upper95) *c.upper95 *= conversion.factor;
    c.ci95.low *= conversion.factor;
    c.ci95.high *= conversion.factor;
    if (!std::isfinite(c.value.value_or(0)) || !std::isfinite(c.upper95.value_or(0)) ||
        !std::isfinite(c.ci95.high))
      top_.refuse(key, "is out of range once it is converted to the channel's unit");
    if (!conversion.sentence.empty()) model_.remarks.push_back(conversion.sentence);
  }

  void noise_options() {
    if (top_.word_or("noise_sampling", {"per-sample", "band-limited"}, "per-sample") ==
        "band-limited")
      model_.noise_sampling = NoiseSampling::band_limited;
    if (top_.word_or("noise_start", {"stationary", "zero"}, "stationary") == "zero")
      model_.noise_start = NoiseStart::zero;
    model_.flicker_method =
        top_.word_or("flicker_method", {"recursive", "rv-truncated-iir"}, "recursive");
    model_.white_hold_s = top_.maybe_number("white_hold_s", kPositive);
    model_.flicker_hold_s = top_.maybe_number("flicker_hold_s", kPositive);
    model_.bandwidth_hz = top_.maybe_number("bandwidth_hz", kPositive);
    if (model_.noise_sampling == NoiseSampling::band_limited && !model_.bandwidth_hz)
      top_.refuse("noise_sampling", "band-limited noise needs bandwidth_hz");
  }

  void blocks() {
    if (top_.has("scale_factor")) {
      const MapReader at = top_.map("scale_factor", {"value", "spread", "tc1_per_k", "tc2_per_k2"});
      model_.scale_factor = {at.number_or("value", 1),
                             at.number_or("spread", 0, kNotNegative),
                             at.number_or("tc1_per_k", 0),
                             at.number_or("tc2_per_k2", 0)};
    }
    if (top_.has("nonlinearity")) {
      const MapReader at =
          top_.map("nonlinearity", {"quadratic", "quadratic_tc_per_k", "cubic", "cubic_tc_per_k"});
      model_.nonlinearity = {at.number_or("quadratic", 0),
                             at.number_or("quadratic_tc_per_k", 0),
                             at.number_or("cubic", 0),
                             at.number_or("cubic_tc_per_k", 0)};
    }
    if (top_.has("bias")) {
      const MapReader at = top_.map("bias", {"value", "spread", "tc1_per_k", "tc2_per_k2"});
      model_.bias = {at.number_or("value", 0),
                     at.number_or("spread", 0, kNotNegative),
                     at.number_or("tc1_per_k", 0),
                     at.number_or("tc2_per_k2", 0)};
    }
    model_.reference_temperature_degc = top_.number_or("reference_temperature_degc", 25);
    if (top_.has("saturation")) {
      const auto ends = top_.interval("saturation");
      if (!(ends.first < ends.second))
        top_.refuse("saturation", "expected [low, high] with low below high");
      model_.saturation_low = ends.first;
      model_.saturation_high = ends.second;
    }
    if (top_.has("sensitivity")) {
      const MapReader at = top_.map("sensitivity", {"gain", "unit"});
      model_.sensitivity = {at.number_or("gain", 1), at.text_or("unit", "")};
      if (model_.sensitivity.gain == 0) at.refuse("gain", "a gain of 0 leaves no output");
    }
    model_.resolution = top_.maybe_number("resolution", kPositive);
  }

  void provenance() {
    model_.mean = top_.number_or("mean", 0);
    model_.obtained = top_.text_or("obtained", "written by hand");
    model_.method = top_.text_or("method", "");
    if (top_.has("recording")) {
      const MapReader at = top_.map("recording", {"file", "sha256", "duration_s"});
      model_.recording_file = at.text_or("file", "");
      model_.recording_sha256 = at.text_or("sha256", "");
      model_.duration_s = at.number_or("duration_s", 0, kNotNegative);
    }
    if (top_.has("valid_tau_s"))
      std::tie(model_.tau_min_s, model_.tau_max_s) = top_.interval("valid_tau_s");
    if (top_.has("remarks")) {
      const std::vector<std::string> read = top_.texts("remarks");
      model_.remarks.insert(model_.remarks.begin(), read.begin(), read.end());
    }
  }

  MapReader top_;
  Density density_ = Density::unsaid;
  SensorModel model_;
};

[[noreturn]] void cannot_read(const std::string& path,
                              const std::string& why,
                              const std::string& hint = "") {
  throw Error({ErrorKind::input, "E0551", path, why, "", hint});
}

}  // namespace

SensorModel sensor_model_of(const Document& node,
                            const std::string& file,
                            const std::string& path) {
  return ModelReader(node, file, path).read();
}

SensorModel parse_sensor_model(std::string_view text, const std::string& file) {
  const Document document =
      file.ends_with(".json") ? parse_json_document(text, file) : parse_yaml_document(text, file);
  check_format(document, file, "sensor-model", 1);
  return sensor_model_of(document, file, "");
}

std::string read_document_text(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) {
    const int reason = errno;
    cannot_read(path, std::string("cannot be read: ") + std::strerror(reason));
  }
  struct Closer {
    int descriptor;
    ~Closer() { ::close(descriptor); }
  } closer{descriptor};
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || S_ISDIR(status.st_mode))
    cannot_read(path, "is a folder, a file was expected");
  if (!S_ISREG(status.st_mode)) cannot_read(path, "is no regular file");
  if (static_cast<std::size_t>(status.st_size) > kMaxBytes)
    cannot_read(path,
                fmt::format("{} bytes exceed the limit of {}", status.st_size, kMaxBytes),
                "is this a log? a model or scene file is a short text");
  std::string text(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t got = ::read(descriptor, text.data() + done, text.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    done += static_cast<std::size_t>(got);
  }
  text.resize(done);
  return text;
}

SensorModel read_model_file(const std::string& path) {
  return parse_sensor_model(read_document_text(path), path);
}

}  // namespace libchar
