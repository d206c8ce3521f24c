// ASCII lines of inertial units: VectorNav ("$VNIMU,a,b,…*CC", VN-100 User Manual) and NovAtel
// ("#RAWIMUSXA,header;week,seconds,…*CRC", OEM7 Commands and Logs; '%' before a short header), also behind a stamp of
// what wrote the log. NovAtel's raw axes are z, -y, x, in counts: the sign of y is turned. CORRIMUDATA, CORRIMUS and
// IMURATECORRIMUS hold increments, each of one message.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "libchar/core/text/decimal.hpp"
#include "libchar/log/csv/head/dialect.hpp"
#include "libchar/log/csv/made_text.hpp"
#include "libchar/log/time/calendar.hpp"

namespace libchar::csv {
namespace {

/// Where a line has its GPS week and seconds.
enum class Stamped { no, first, third, header };

struct Kind {
  std::string_view name;  ///< without the sign in front, '#' or '%', of NovAtel
  Stamped stamped = Stamped::no;
  std::size_t skipped = 0;   ///< fields in front of the values, behind the stamp
  bool counts = false;       ///< counts of z, -y, x
  std::string_view columns;  ///< "acc_ [m/s^2]": of three axes; what a line has behind them is left out
};
constexpr std::string_view kCounts = "acc_z,acc_y,acc_x,gyro_z,gyro_y,gyro_x";
constexpr std::string_view kIncrements =
    "pitch [rad],roll [rad],yaw [rad],lateral [m/s],longitudinal [m/s],vertical [m/s]";
constexpr std::string_view kInertial =
    "latitude [deg],longitude [deg],height [m],north [m/s],east [m/s],"
    "up [m/s],roll [deg],pitch [deg],azimuth [deg],status";
constexpr std::string_view kInertialX =
    "latitude [deg],longitude [deg],height [m],undulation [m],north [m/s],east [m/s],"
    "up [m/s],roll [deg],pitch [deg],azimuth [deg]";
/// Of a log with several kinds the first of these is read.
constexpr std::array kKinds = {
    Kind{"$VNIMU", Stamped::no, 0, false, "mag_ [Gauss],acc_ [m/s^2],gyro_ [rad/s],temp [degC],pressure [kPa]"},
    Kind{"$VNMAR", Stamped::no, 0, false, "mag_ [Gauss],acc_ [m/s^2],gyro_ [rad/s]"},
    Kind{"$VNYMR", Stamped::no, 0, false, "yaw [deg],pitch [deg],roll [deg],mag_ [Gauss],acc_ [m/s^2],gyro_ [rad/s]"},
    Kind{"$VNQMR", Stamped::no, 0, false, "q_x,q_y,q_z,q_w,mag_ [Gauss],acc_ [m/s^2],gyro_ [rad/s]"},
    Kind{"$VNYBA", Stamped::no, 0, false, "yaw [deg],pitch [deg],roll [deg],acc_ [m/s^2],gyro_ [rad/s]"},
    Kind{"$VNISL", Stamped::no, 0, false,
         "yaw [deg],pitch [deg],roll [deg],latitude [deg],longitude [deg],altitude [m],velocity_ [m/s],"
         "acc_ [m/s^2],gyro_ [rad/s]"},
    Kind{"$VNDTV", Stamped::no, 0, false, "interval [s],angle_ [deg],velocity_ [m/s]"},
    Kind{"$VNGYR", Stamped::no, 0, false, "gyro_ [rad/s]"},
    Kind{"$VNACC", Stamped::no, 0, false, "acc_ [m/s^2]"},
    Kind{"$VNMAG", Stamped::no, 0, false, "mag_ [Gauss]"},
    Kind{"$VNYPR", Stamped::no, 0, false, "yaw [deg],pitch [deg],roll [deg]"},
    Kind{"$VNQTN", Stamped::no, 0, false, "q_x,q_y,q_z,q_w"},
    Kind{"RAWIMUSXA", Stamped::third, 1, true, kCounts},
    Kind{"RAWIMUXA", Stamped::third, 1, true, kCounts},
    Kind{"RAWIMUSA", Stamped::first, 1, true, kCounts},
    Kind{"RAWIMUA", Stamped::first, 1, true, kCounts},
    Kind{"CORRIMUDATAA", Stamped::first, 0, false, kIncrements},
    Kind{"CORRIMUDATASA", Stamped::first, 0, false, kIncrements},
    Kind{"CORRIMUSA", Stamped::header, 1, false, kIncrements},
    Kind{"IMURATECORRIMUSA", Stamped::first, 0, false, kIncrements},
    Kind{"INSPVAA", Stamped::first, 0, false, kInertial},
    Kind{"INSPVASA", Stamped::first, 0, false, kInertial},
    Kind{"IMURATEPVAA", Stamped::first, 0, false, kInertial},
    Kind{"IMURATEPVASA", Stamped::first, 0, false, kInertial},
    Kind{"INSPVAXA", Stamped::header, 2, false, kInertialX}};

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

struct Sentence {
  const Kind* kind = nullptr;
  std::string_view front, fields;  ///< a stamp before it, and what stands behind its name
};

Sentence sentence_of(std::string_view line) {
  constexpr std::size_t kFront = 64;
  for (std::size_t at = 0; at < std::min(line.size(), kFront); ++at) {
    if (line[at] != '$' && line[at] != '#' && line[at] != '%') continue;
    const std::string_view rest = line.substr(at + (line[at] == '$' ? 0 : 1));
    for (const Kind& kind : kKinds)
      if (rest.starts_with(kind.name) && rest.substr(kind.name.size()).starts_with(','))
        return {&kind, line.substr(0, at), rest.substr(kind.name.size() + 1)};
  }
  return {};
}

/// In front of a sentence: a number, or a date; not what a receiver answers ("[COM1]").
std::string stamp_before(std::string_view front) {
  const std::size_t first = front.find_first_not_of(" \t[(,;"), last = front.find_last_not_of(" \t,;:>-])");
  if (first == std::string_view::npos || last == std::string_view::npos || first > last) return "";
  std::string stamp(front.substr(first, last + 1 - first));
  return parse_double(stamp) || read_calendar(stamp) ? stamp : "";
}

std::string_view field(std::string_view& body, char end = ',') {
  const std::string_view first = body.substr(0, body.find(end));
  body.remove_prefix(std::min(first.size() + 1, body.size()));
  return first;
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
    if (kind_ == nullptr && !choose(text)) return false;
    for (std::string line; from_.line(line, kMaxLine);) {
      const Sentence sentence = sentence_of(line);
      if (sentence.kind != kind_) {
        if (others_++ == 0) first_other_ = line.substr(0, line.find(','));
        continue;
      }
      row(sentence, text);
      return true;
    }
    return false;
  }

 private:
  /// Of the kinds in the first lines.
  bool choose(std::string& text) {
    from_.more();
    std::string_view front = std::string_view(from_.raw).substr(0, kPackingBytes);
    for (; !front.empty(); field(front, '\n')) {
      const Sentence sentence = sentence_of(front.substr(0, front.find('\n')));
      if (sentence.kind == nullptr || (kind_ != nullptr && sentence.kind >= kind_)) continue;
      kind_ = sentence.kind;
      stamped_ = kind_->stamped == Stamped::no && !stamp_before(sentence.front).empty();
    }
    if (kind_ == nullptr) return false;
    const std::string names = header_of(kind_->columns);
    columns_ = static_cast<std::size_t>(std::count(names.begin(), names.end(), ',')) + 1;
    text += (stamped_ ? "time," : kind_->stamped == Stamped::no ? "" : "time [s],") + names;
    return true;
  }

  void row(const Sentence& sentence, std::string& text) const {
    std::string_view body = sentence.fields.substr(0, sentence.fields.rfind('*'));
    if (stamped_) add_quoted(text, stamp_before(sentence.front));
    if (kind_->stamped != Stamped::no) {
      std::string_view header = field(body, ';');
      constexpr std::size_t kBeforeWeek = 4;  // of a long header: port, number, idle time, status
      if (kind_->stamped == Stamped::header) {
        const bool is_long = std::count(header.begin(), header.end(), ',') > 1;
        for (std::size_t k = 0; is_long && k < kBeforeWeek; ++k) field(header);
      }
      for (std::size_t k = 0; kind_->stamped == Stamped::third && k < 2; ++k) field(body);
      std::string_view& from = kind_->stamped == Stamped::header ? header : body;
      const auto week = parse_double(field(from)), second = parse_double(field(from));
      if (week && second) text += fmt::format("{:.6f}", *week * 604800 + *second);
    }
    for (std::size_t k = 0; k < kind_->skipped; ++k) field(body);
    for (std::size_t k = 0; k < columns_; ++k) {
      if (k > 0 && body.empty()) break;  // too few, as the table says
      if (k > 0 || stamped_ || kind_->stamped != Stamped::no) text += ',';
      if (kind_->counts && k % 3 == 1) {
        const std::string_view value = field(body);
        text += value.starts_with('-') ? std::string(value.substr(1)) : "-" + std::string(value);
      } else {
        text += field(body);
      }
    }
    text += '\n';
  }

  Feed from_;
  const Kind* kind_ = nullptr;
  bool stamped_ = false;     // by what wrote the log
  std::size_t columns_ = 0;  // behind the stamp
  std::uint64_t others_ = 0;
  std::string first_other_;
};

}  // namespace

bool is_sentences(std::string_view front) {
  constexpr std::size_t kLines = 20;  // others may stand before the first
  for (std::size_t k = 0; k < kLines && !front.empty(); ++k) {
    const std::string_view line = field(front, '\n');
    if (sentence_of(line).kind != nullptr) return true;
    if (line.empty() || std::string_view("$#%<[").find(line[0]) == std::string_view::npos) return false;
  }
  return false;
}

std::unique_ptr<Unpacker> open_sentence_rows(std::function<std::size_t(char*, std::size_t)> stored,
                                             const std::string&) {
  return std::make_unique<SentenceRows>(std::move(stored));
}

}  // namespace libchar::csv
