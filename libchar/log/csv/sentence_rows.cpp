// ASCII lines of inertial units: VectorNav ("$VNIMU,a,b,…*CC", VN-100 User Manual) and NovAtel
// ("#RAWIMUSXA,header;week,seconds,…*CRC", OEM7 Commands and Logs). NovAtel's axes are z, -y, x, in counts: the
// sign of y is turned.

#include <fmt/format.h>

#include <array>
#include <vector>

#include "libchar/core/text/decimal.hpp"
#include "libchar/log/csv/head/dialect.hpp"
#include "libchar/log/csv/made_text.hpp"

namespace libchar::csv {
namespace {

struct Kind {
  std::string_view name;
  std::size_t skipped;  ///< fields in front of the week
  std::string_view columns;
};
constexpr std::array kKinds = {Kind{"$VNIMU", 0,
                                    "mag_x [Gauss],mag_y [Gauss],mag_z [Gauss],acc_x [m/s^2],acc_y [m/s^2],acc_z "
                                    "[m/s^2],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],temp [degC],pressure [kPa]"},
                               Kind{"$VNGYR", 0, "gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s]"},
                               Kind{"$VNACC", 0, "acc_x [m/s^2],acc_y [m/s^2],acc_z [m/s^2]"},
                               Kind{"$VNMAG", 0, "mag_x [Gauss],mag_y [Gauss],mag_z [Gauss]"},
                               Kind{"#RAWIMUSXA", 2, "time [s],acc_z,acc_y,acc_x,gyro_z,gyro_y,gyro_x"},
                               Kind{"%RAWIMUSA", 0, "time [s],acc_z,acc_y,acc_x,gyro_z,gyro_y,gyro_x"},
                               Kind{"#RAWIMUA", 0, "time [s],acc_z,acc_y,acc_x,gyro_z,gyro_y,gyro_x"}};

const Kind* kind_of(std::string_view line) {
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
        text += std::string(kind->columns) + "\n";
      }
      row(std::string_view(line).substr(kind->name.size() + 1), text);
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
      field(body);  // flags, hexadecimal
      constexpr std::size_t kAxes = 6;
      for (std::size_t k = 0; k < kAxes; ++k) {
        std::string value(field(body));
        if (k % 3 == 1) value = value.starts_with('-') ? value.substr(1) : "-" + value;
        text += (k > 0 ? "," : "") + value;
      }
      if (!body.empty()) text += "," + std::string(body);  // a row of another length
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

bool is_sentences(std::string_view front) { return kind_of(front) != nullptr; }

std::unique_ptr<Unpacker> open_sentence_rows(std::function<std::size_t(char*, std::size_t)> stored,
                                             const std::string&) {
  return std::make_unique<SentenceRows>(std::move(stored));
}

}  // namespace libchar::csv
