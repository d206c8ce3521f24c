// ASCII lines of inertial units: VectorNav ("$VNIMU,a,b,…*CC", VN-100 User Manual) and NovAtel
// ("#RAWIMUSXA,header;week,seconds,…*CRC", OEM7 Commands and Logs; '%' before a short header). NovAtel's raw axes are
// z, -y, x, in counts: the sign of y is turned. CORRIMUDATA holds increments, each of one message.

#include <fmt/format.h>

#include <array>
#include <vector>

#include "libchar/core/text/decimal.hpp"
#include "libchar/log/csv/head/dialect.hpp"
#include "libchar/log/csv/made_text.hpp"

namespace libchar::csv {
namespace {

struct Kind {
  std::string_view name;     ///< without the sign in front, '#' or '%', of NovAtel
  std::size_t skipped;       ///< fields in front of the week
  bool counts;               ///< a field of flags, then counts of z, -y, x
  std::string_view columns;  ///< "acc_ [m/s^2]": of three axes
};
constexpr std::string_view kCounts = "time [s],acc_z,acc_y,acc_x,gyro_z,gyro_y,gyro_x";
constexpr std::string_view kIncrements =
    "time [s],pitch [rad],roll [rad],yaw [rad],lateral [m/s],longitudinal [m/s],"
    "vertical [m/s]";
constexpr std::string_view kInertial =
    "time [s],latitude [deg],longitude [deg],height [m],north [m/s],east [m/s],"
    "up [m/s],roll [deg],pitch [deg],azimuth [deg],status";
constexpr std::array kKinds = {
    Kind{"$VNIMU", 0, false, "mag_ [Gauss],acc_ [m/s^2],gyro_ [rad/s],temp [degC],pressure [kPa]"},
    Kind{"$VNGYR", 0, false, "gyro_ [rad/s]"},
    Kind{"$VNACC", 0, false, "acc_ [m/s^2]"},
    Kind{"$VNMAG", 0, false, "mag_ [Gauss]"},
    Kind{"$VNMAR", 0, false, "mag_ [Gauss],acc_ [m/s^2],gyro_ [rad/s]"},
    Kind{"$VNYPR", 0, false, "yaw [deg],pitch [deg],roll [deg]"},
    Kind{"$VNYMR", 0, false, "yaw [deg],pitch [deg],roll [deg],mag_ [Gauss],acc_ [m/s^2],gyro_ [rad/s]"},
    Kind{"$VNYBA", 0, false, "yaw [deg],pitch [deg],roll [deg],acc_ [m/s^2],gyro_ [rad/s]"},
    Kind{"$VNQTN", 0, false, "q_x,q_y,q_z,q_w"},
    Kind{"$VNQMR", 0, false, "q_x,q_y,q_z,q_w,mag_ [Gauss],acc_ [m/s^2],gyro_ [rad/s]"},
    Kind{"RAWIMUSXA", 2, true, kCounts},
    Kind{"RAWIMUXA", 2, true, kCounts},
    Kind{"RAWIMUSA", 0, true, kCounts},
    Kind{"RAWIMUA", 0, true, kCounts},
    Kind{"CORRIMUDATAA", 0, false, kIncrements},
    Kind{"CORRIMUDATASA", 0, false, kIncrements},
    Kind{"INSPVAA", 0, false, kInertial},
    Kind{"INSPVASA", 0, false, kInertial}};

std::string header_of(std::string_view columns) {
  std::string out;
  while (!columns.empty()) {
    const std::string_view one = columns.substr(0, columns.find(','));
    columns.remove_prefix(std::min(one.size() + 1, columns.size()));
    const std::size_t axes = one.find("_ [");
    for (const std::string_view axis : {"x", "y", "z"}) {
      if (!out.empty()) out += ',';
      out += axes == std::string_view::npos ? std::string(one)
                                            : fmt::format("{}_{}{}", one.substr(0, axes), axis, one.substr(axes + 1));
      if (axes == std::string_view::npos) break;
    }
  }
  return out + "\n";
}

const Kind* kind_of(std::string_view line) {
  if (line.starts_with('#') || line.starts_with('%')) line.remove_prefix(1);
  for (const Kind& kind : kKinds)
    if (line.starts_with(kind.name) && line.substr(kind.name.size()).starts_with(',')) return &kind;
  return nullptr;
}

class SentenceRows final : public MadeText {
 public:
  explicit SentenceRows(std::function<std::size_t(char*, std::size_t)> stored) : from_{std::move(stored)} {}
  std::string_view what() const override { return "lines of an inertial unit"; }
  void finish(Findings& findings) const override {
    if (others_ > 0) findings.add("comment_line", "comment lines between the rows skipped", first_other_, others_);
  }

 protected:
  bool more(std::string& text) override {
    for (std::string line; from_.line(line, kMaxLine);) {
      const Kind* const kind = kind_of(line);
      if (kind == nullptr || (kind_ != nullptr && kind != kind_)) {
        if (others_++ == 0) first_other_ = line.substr(0, line.find(','));
        continue;
      }
      if (kind_ == nullptr) {
        kind_ = kind;
        text += header_of(kind->columns);
      }
      row(std::string_view(line).substr(line.find(',') + 1), text);
      return true;
    }
    return false;
  }

 private:
  void row(std::string_view body, std::string& text) const {
    body = body.substr(0, body.rfind('*'));
    if (kind_->name[0] != '$') {
      body.remove_prefix(std::min(body.find(';'), body.size() - 1) + 1);
      for (std::size_t k = 0; k < kind_->skipped; ++k) field(body);
      const auto week = parse_double(field(body)), second = parse_double(field(body));
      if (week && second) text += fmt::format("{:.6f}", *week * 604800 + *second);
      text += ',';
      if (kind_->counts) field(body);  // flags, hexadecimal
      const std::size_t axes = kind_->counts ? 6 : 0;
      for (std::size_t k = 0; k < axes; ++k) {
        std::string value(field(body));
        if (k % 3 == 1) value = value.starts_with('-') ? value.substr(1) : "-" + value;
        text += (k > 0 ? "," : "") + value;
      }
      if (!body.empty()) text += (axes > 0 ? "," : "") + std::string(body);
    } else {
      text += body;
    }
    text += '\n';
  }

  static std::string_view field(std::string_view& body) {
    const std::string_view first = body.substr(0, body.find(','));
    body.remove_prefix(std::min(first.size() + 1, body.size()));
    return first;
  }

  Feed from_;
  const Kind* kind_ = nullptr;
  std::uint64_t others_ = 0;
  std::string first_other_;
};

}  // namespace

bool is_sentences(std::string_view front) {
  constexpr std::size_t kLines = 20;  // others may stand before the first
  for (std::size_t k = 0; k < kLines && !front.empty(); ++k) {
    if (kind_of(front) != nullptr) return true;
    if (front[0] != '$' && front[0] != '#' && front[0] != '%') return false;
    front.remove_prefix(std::min(front.find('\n'), front.size() - 1) + 1);
  }
  return false;
}

std::unique_ptr<Unpacker> open_sentence_rows(std::function<std::size_t(char*, std::size_t)> stored,
                                             const std::string&) {
  return std::make_unique<SentenceRows>(std::move(stored));
}

}  // namespace libchar::csv
