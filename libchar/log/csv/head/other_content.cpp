// Formats by their first bytes, from the specifications of each and the magic numbers of file(1). What the
// program reads stands here for files that are called CSV all the same.
#include "libchar/log/csv/head/other_content.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "libchar/core/refusal.hpp"
#include "libchar/log/csv/line.hpp"

namespace libchar::csv {
namespace {

using namespace std::string_view_literals;

struct Magic {
  std::size_t at;  ///< byte where they stand
  std::string_view bytes;
  const char *what, *hint;
};

constexpr const char *kPandas = "pandas reads it: df = pandas.read_parquet(FILE); df.to_csv('log.csv', index=False)",
                     *kFeather = "pandas reads it: pandas.read_feather(FILE).to_csv('log.csv', index=False)",
                     *kPackets =
                         "tshark exports them: tshark -r FILE -T fields -E separator=, -e frame.time_epoch -e …",
                     *kPickle = "pandas.DataFrame(pickle.load(open(FILE, 'rb'))).to_csv('log.csv')",
                     *kSeismic = "ObsPy reads them: obspy.read(FILE)[0].write('log.slist', format='SLIST')",
                     *kRinex = "georinex.load(FILE).to_dataframe().to_csv('log.csv')",
                     *kNetCdf = "xarray reads it: xarray.open_dataset(FILE).to_dataframe().to_csv('log.csv')",
                     *kBiosignals =
                         "MNE reads them: mne.io.read_raw(FILE).to_data_frame().to_csv('log.csv', index=False)",
                     *kUbx =
                         "pyubx2 reads them: pandas.DataFrame([{k: v for k, v in vars(m).items() if k[0] != '_'} for "
                         "_, m in pyubx2.UBXReader(open(FILE, 'rb'), protfilter=2) if m.identity == "
                         "'NAV-PVT']).to_csv('log.csv', index=False)",
                     *kTelemetry = "pymavlink exports it: mavlogdump.py --format csv --types RAW_IMU FILE > log.csv",
                     *kSpreadsheet = "libreoffice --headless --convert-to xlsx FILE makes log.xlsx of it",
                     *kSentences = "gpsbabel -i nmea -f FILE -o unicsv -F log.csv";

constexpr std::array kMagics = {
    Magic{0, "\x93NUMPY"sv, "a NumPy array (NPY)", "read it with `format` npy"},
    Magic{0, "\x1F\x8B"sv, "compressed (gzip)", "unpack it first: gunzip"},
    Magic{30, "mimetypeapplication/vnd.oasis"sv, "a spreadsheet of OpenDocument", kSpreadsheet},
    Magic{0, "PK\x03\x04"sv, "a ZIP archive", "`format` xlsx, npz or tables, or unpack it"},
    Magic{0, "7z\xBC\xAF"sv, "an archive (7z)", "unpack it first: 7z x FILE"},
    Magic{0, "Rar!"sv, "an archive (RAR)", "unpack it first: unrar x FILE"},
    Magic{0, "\x28\xB5\x2F\xFD"sv, "compressed (zstd)", "unpack it first: unzstd"},
    Magic{0, "BZh"sv, "compressed (bzip2)", "unpack it first: bunzip2"},
    Magic{0, "\x89PNG"sv, "a picture", ""},
    Magic{0, "\xFF\xD8\xFF"sv, "a picture", ""},
    Magic{4, "ftyp"sv, "a video", "Gyroflow exports the motion that a camera stores in it as CSV"},
    Magic{0, "%PDF"sv, "PDF", "export the table as CSV"},
    Magic{0, "\x89HDF"sv, "HDF5", "export it as CSV or .npy"},
    Magic{0, "PAR1"sv, "a Parquet table", kPandas},
    Magic{0, "ARROW1"sv, "an Arrow or Feather table", kFeather},
    Magic{0, "FEA1"sv, "a Feather table", kFeather},
    Magic{0, "TDSm"sv, "a TDMS file of LabVIEW",
          "npTDMS reads it: nptdms.TdmsFile(FILE).as_dataframe(time_index=True).to_csv('log.csv'), without time_index "
          "where "
          "it has no rate"},
    Magic{0, "\xD0\xCF\x11\xE0"sv, "an old Excel workbook (XLS)", kSpreadsheet},
    Magic{0, "\xB5\x62"sv, "messages of u-blox (UBX)", kUbx},
    Magic{0, "H Product:Blackbox"sv, "a Blackbox log of Betaflight or INAV", "blackbox_decode FILE makes a CSV of it"},
    Magic{0, "\x80\x02"sv, "a Python pickle", kPickle},
    Magic{0, "\x80\x03"sv, "a Python pickle", kPickle},
    Magic{0, "\x80\x04"sv, "a Python pickle", kPickle},
    Magic{0, "\x80\x05"sv, "a Python pickle", kPickle},
    Magic{60, "RINEX VERSION"sv, "observations of a GNSS receiver (RINEX)", kRinex},
    Magic{20, "COMPACT RINEX FORMAT"sv, "observations of a GNSS receiver (RINEX)", kRinex},
    Magic{0, "\xC3\x40\xF1"sv, "seismic traces (SEG-Y)", kSeismic},
    Magic{0, "C 1 CLIENT"sv, "seismic traces (SEG-Y)", kSeismic},
    Magic{0, "MS\x03"sv, "seismic records (miniSEED)", kSeismic},
    Magic{0, "MDF     "sv, "a measurement of ASAM MDF", "asammdf reads it: asammdf.MDF(FILE).export('csv')"},
    Magic{0, "CDF\x01"sv, "a NetCDF table", kNetCdf},
    Magic{0, "CDF\x02"sv, "a NetCDF table", kNetCdf},
    Magic{0, "CDF\x05"sv, "a NetCDF table", kNetCdf},
    Magic{0,
          "\xFF"
          "BIOSEMI"sv,
          "biosignals (BDF)", kBiosignals},
    Magic{8, ".FIT"sv, "records of a sports watch (FIT)", "FitCSVTool of Garmin's SDK makes a CSV of it"},
    Magic{0, "RDX3"sv, "objects of R", "in R: write.csv(get(load(FILE)), 'log.csv', row.names = FALSE)"},
    Magic{0, "fLaC"sv, "packed sound (FLAC)", "unpack it to WAV: flac -d FILE"},
    Magic{0, "LOGG"sv, "frames of a CAN bus (BLF)", "asammdf or python-can export them: can.LogReader(FILE)"},
    Magic{0, "Obj\x01"sv, "records of Avro",
          "fastavro reads them: pandas.DataFrame(fastavro.reader(open(FILE, 'rb')))"},
    Magic{0, "\xD4\xC3\xB2\xA1"sv, "packets of a network (pcap)", kPackets},
    Magic{0, "\x0A\x0D\x0D\x0A"sv, "packets of a network (pcap)", kPackets},
    Magic{0, "\x02P"sv, "motion capture (C3D)", "ezc3d reads it: ezc3d.c3d(FILE)['data']['analogs']"},
};

/// What this program writes, or reads with a log: the word behind `format`, near the begin.
struct Document {
  std::string_view format;
  const char *what, *hint;
};

constexpr const char* kResult = "plot, report, compare and verify read it";

constexpr std::array kDocuments = {
    Document{"scene", "a scene", "replay reads it"},
    Document{"fusion", "what a replay has learnt", "fuse reads it with a log"},
    Document{"sensor-model", "a sensor model", "model, simulate and compare read it"},
    Document{"noise-limits", "limits of a channel's noise", "fit and characterize read it with a log"},
    Document{"characterization", "the report of a characterization", kResult},
    Document{"replay-report", "the report of a replay", kResult},
    Document{"allan", "an Allan curve", "plot draws it"},
    Document{"spectrum", "a spectrum", "plot draws it"},
};

/// MAVLink messages behind stamps of eight bytes: the first two of them are 0 until the year 2100.
bool is_telemetry_log(std::string_view head) {
  return head.size() > 9 && head[0] == 0 && head[1] != 0 && (head[8] == '\xFE' || head[8] == '\xFD') && head[2] != 0;
}

/// "000001D ": a number of six digits, the quality, a blank.
bool is_miniseed(std::string_view head) {
  return head.size() > 8 && std::all_of(head.begin(), head.begin() + 6, [](char c) { return c >= '0' && c <= '9'; }) &&
         std::string_view("DRQM").find(head[6]) != std::string_view::npos && head[7] == ' ' &&
         head.substr(0, 64).find('\n') == std::string_view::npos;
}

/// "weather,place=roof temperature=21.5,humidity=40i 1465839830100400200", after comments and "CREATE DATABASE x";
/// with places also without the stamp.
bool is_line_protocol(std::string_view head) {
  while (head.starts_with("# ") || head.starts_with("CREATE DATABASE"))
    head.remove_prefix(std::min(head.find('\n'), head.size() - 1) + 1);
  const std::string_view line = trimmed(head.substr(0, head.find('\n')));
  const std::size_t blank = line.find(' '), end = line.rfind(' ');
  if (blank == std::string_view::npos || line.substr(0, blank).find(';') != std::string_view::npos) return false;
  const bool stamped = end != blank;
  const std::string_view name = line.substr(0, line.find_first_of(", ")), places = line.substr(0, blank),
                         stamp = line.substr(end + 1),
                         fields = stamped ? line.substr(blank + 1, end - blank - 1) : line.substr(blank + 1);
  constexpr std::size_t kDigits = 10;
  if (stamped && (stamp.size() < kDigits || stamp.find_first_not_of("0123456789") != std::string_view::npos))
    return false;
  return fields.find('=') != std::string_view::npos && fields.find(": ") == std::string_view::npos &&
         places.find_first_of("0123456789") != 0 && name.find('=') == std::string_view::npos &&
         (stamped || places.find('=') != std::string_view::npos);
}

/// "$GPGGA,…" of any system, "$PUBX,…" and "!AIVDM,…", in the first line or in both behind it.
bool is_nmea(std::string_view head) {
  const auto sentence = [](std::string_view line) {
    if (line.starts_with("$PUBX,") || line.starts_with("!AIVDM,")) return true;
    constexpr std::string_view kSystems = "GP GL GA GB BD GN GQ QZ GI",
                               kKinds = "GGA RMC GSA GSV GLL VTG ZDA GNS GST TXT";
    return line.size() > 6 && line[0] == '$' && line[6] == ',' &&
           kSystems.find(line.substr(1, 2)) != std::string_view::npos &&
           kKinds.find(line.substr(3, 3)) != std::string_view::npos;
  };
  const auto next = [&] { return head.substr(std::min(head.find('\n'), head.size() - 1) + 1); };
  if (sentence(head)) return true;
  head = next();
  return sentence(head) && (head = next(), sentence(head));
}

/// The header of 256 bytes: version, two names of 80, day and time at 168, the number of signals at its end.
bool is_biosignals(std::string_view head) {
  constexpr std::size_t kDay = 168, kHeader = 256;
  return head.size() > kHeader && head.starts_with("0       ") && head[kDay + 2] == '.' && head[kDay + 5] == '.' &&
         head[kDay + 10] == '.' && head[kDay + 13] == '.';
}

/// A whole message of u-blox, wherever it begins: B5 62, class, number, length, bytes, and their checksum (Fletcher's).
bool holds_ubx(std::string_view head) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned>(static_cast<unsigned char>(head[i])); };
  constexpr std::size_t kFrame = 8;
  for (std::size_t at = head.find("\xB5\x62"); at != std::string_view::npos; at = head.find("\xB5\x62", at + 1)) {
    if (at + kFrame > head.size()) return false;
    const std::size_t end = at + kFrame - 2 + byte(at + 4) + 256 * byte(at + 5);
    if (end + 2 > head.size()) continue;
    unsigned a = 0, b = 0;
    for (std::size_t i = at + 2; i < end; ++i) {
      a = (a + byte(i)) & 255U;
      b = (b + a) & 255U;
    }
    if (a == byte(end) && b == byte(end + 1)) return true;
  }
  return false;
}

/// Frames of a CAN bus: "(1714564800.123456) can0 123#DEADBEEF", "can0  123   [8]  DE AD" of candump, ".trc" of PEAK,
/// ".asc" of Vector.
bool is_can_log(std::string_view head) {
  if (head.starts_with(";$FILEVERSION=")) return true;
  std::string_view line = trimmed(head.substr(0, head.find('\n')));
  if (line.starts_with("date ")) return head.substr(line.size(), 64).find("base hex") != std::string_view::npos;
  if (line.starts_with('(')) line = trimmed(line.substr(std::min(line.find(')'), line.size() - 1) + 1));
  const std::size_t name = line.find(' ');
  if (name == std::string_view::npos || line.substr(0, name).find("can") == std::string_view::npos) return false;
  line = trimmed(line.substr(name));
  constexpr std::size_t kShort = 3, kLong = 8;
  const std::size_t id = std::min(line.find_first_not_of("0123456789ABCDEFabcdef"), line.size());
  const std::string_view rest = trimmed(line.substr(id));
  return (id == kShort || id == kLong) && (rest.starts_with('#') || rest.starts_with('['));
}

bool is_utf16(std::string_view head) {
  return head.starts_with("\xFF\xFE") || head.starts_with("\xFE\xFF") ||
         (head.size() >= 4 && ((head[0] == 0) != (head[1] == 0)) && ((head[2] == 0) != (head[3] == 0)) &&
          head[0] == head[2 * (head[0] == 0)]);
}

Refusal refusal(const std::string& file, const std::string& what) {
  return input_error("E0301", at(file, 1, 1, 0)).says("content is " + what);
}

// Text has next to no control characters; NUL bytes are left to the row parser, which knows logs
// that a power failure cut.
void refuse_binary(std::string_view head, const std::string& file) {
  std::size_t controls = 0, others = 0, first = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(head.size(), 4096); ++i) {
    const auto byte = static_cast<unsigned char>(head[i]);
    if (byte == 0) continue;
    const bool control = byte < 0x20 && std::string_view("\t\n\v\f\r\x1A").find(head[i]) == std::string_view::npos;
    if (control && controls++ == 0) first = i;
    ++others;
  }
  if (controls < 2 || controls * 50 < others) return;
  std::size_t line = 1, column = 1;
  for (std::size_t i = 0; i < first; ++i, ++column)
    if (head[i] == '\n') ++line, column = 0;
  throw input_error("E0301", at(file, line, column, first))
      .says("content is binary, not text: {} control characters in the first {} bytes", controls,
            std::min<std::size_t>(head.size(), 4096))
      .hint("`format` raw with a sidecar reads raw binary (docs: raw binary)");
}

}  // namespace

void refuse_other_format(std::string_view head, const std::string& file) {
  for (const Magic& magic : kMagics)
    if (head.size() > magic.at && head.substr(magic.at).starts_with(magic.bytes))
      throw refusal(file, std::string(magic.what) + ", not CSV").hint(magic.hint);
  if (is_utf16(head)) throw refusal(file, "UTF-16, not UTF-8").hint("convert it: iconv -f utf-16 -t utf-8");
  if (is_telemetry_log(head)) throw refusal(file, "a telemetry log (tlog) of MAVLink, not CSV").hint(kTelemetry);
  if (is_miniseed(head)) throw refusal(file, "seismic records (miniSEED), not CSV").hint(kSeismic);
  if (is_biosignals(head)) throw refusal(file, "biosignals (EDF), not CSV").hint(kBiosignals);
  if (is_nmea(head)) throw refusal(file, "sentences of a GNSS receiver (NMEA), not CSV").hint(kSentences);
  if (holds_ubx(head)) throw refusal(file, "messages of u-blox (UBX), not CSV").hint(kUbx);
}

void refuse_document(std::string_view front, const std::string& file) {
  for (const std::string_view key : {"\nformat: ", "\n  \"format\": \""}) {
    const bool first = front.starts_with(key.substr(1));
    const std::size_t at = first ? 0 : front.find(key);
    if (at == std::string_view::npos) continue;
    const std::string_view rest = front.substr(at + key.size() - (first ? 1 : 0));
    const std::string_view word = rest.substr(0, rest.find_first_of("\"\r\n"));
    for (const Document& one : kDocuments)
      if (word == one.format) throw refusal(file, std::string(one.what) + ", not a log").hint(one.hint);
  }
}

void refuse_other_content(std::string_view head, const std::string& file) {
  if (head.empty()) throw input_error("E0322", at(file, 1, 1, 0)).says("the file is empty");
  refuse_other_format(head, file);
  refuse_binary(head, file);
  const std::size_t front = head.find_first_not_of(" \t\r\n");
  if (front == std::string_view::npos) return;
  if (is_can_log(head))
    throw refusal(file, "frames of a CAN bus, not CSV")
        .hint(
            "its DBC says what their bytes are: db = cantools.database.load_file(DBC); pandas.DataFrame([{'time': "
            "m.timestamp, **db.decode_message(m.arbitration_id, m.data)} for m in "
            "can.LogReader(FILE)]).to_csv('log.csv', index=False)");
  if (head.substr(front).starts_with("header {\n"))
    throw refusal(file, "messages of Gazebo, not CSV")
        .hint("its option json-output makes gz topic print JSON lines, which are read as log.jsonl");
  if (is_line_protocol(head))
    throw refusal(file, "the line protocol of InfluxDB, not CSV")
        .hint("influx -execute 'SELECT * FROM NAME' -database DATABASE -format csv exports it");
  if (head[front] == '<' && !is_digit(head.substr(front + 1, 1).empty() ? ' ' : head[front + 1]))  // "<14>1 " of syslog
    throw refusal(file, "HTML or XML, not CSV")
        .hint(
            "was a web page saved in place of the file? of a table in it pandas.read_html(FILE)[0].to_csv('log.csv', "
            "index=False) makes one, and of a spreadsheet libreoffice --headless --convert-to csv FILE");
  if (head.substr(front).starts_with("{'"))
    throw refusal(file, "dictionaries of Python, not CSV")
        .hint("quotes make them JSON: tr \\' '\"' < FILE > log.jsonl");
  const bool one_line = head.substr(front).starts_with("[[") && head.find('\n', front) >= head.size() - 1;
  if (head[front] == '{' || (one_line && head.find("],", front) != std::string_view::npos))
    throw refusal(file, "JSON, not CSV")
        .hint(
            "lines with an object each are read; of columns pandas.DataFrame(json.load(open(FILE))).to_csv('log.csv', "
            "index=False) makes a table");
}

}  // namespace libchar::csv
