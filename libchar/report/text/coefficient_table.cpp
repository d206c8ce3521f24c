#include <cmath>
#include <variant>
#include <vector>

#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/markup.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/report/detail/npz_writer.hpp"
#include "libchar/report/html/fleet_report.hpp"

namespace libchar {
namespace {

struct TableRow {
  const DeviceRecord* record = nullptr;
  const std::string* batch = nullptr;  ///< of its device
  const RecordedChannel* channel = nullptr;
};

using TextOf = const std::string& (*)(const TableRow&);
using CountOf = std::uint64_t (*)(const TableRow&);
/// Of a quantity or of the row.
using NumberOf = std::function<double(const TableRow&)>;
/// Status of a quantity.
struct StatusOf {
  DeviceQuantity quantity;
};

struct TableColumn {
  std::string name;
  std::variant<TextOf, CountOf, NumberOf, StatusOf> of;
};

TableColumn text(std::string name, TextOf of) { return {std::move(name), of}; }
TableColumn counted(std::string name, CountOf of) { return {std::move(name), of}; }
TableColumn number(std::string name, NumberOf of) { return {std::move(name), std::move(of)}; }

TableColumn number_of(DeviceQuantity quantity, const char* suffix, double (*of)(const RecordedValue&)) {
  return number(std::string(name_of(quantity)) + suffix, [quantity, of](const TableRow& r) {
    const RecordedValue* value = r.channel->find(quantity);
    return value == nullptr ? kNone : of(*value);
  });
}

/// In the unit of the value: the record has that of the logarithm where the quantity is compared as one.
double absolute_sd(const RecordedValue& v) { return in_logarithm(v.quantity) ? v.value * v.sd : v.sd; }

std::vector<TableRow> table_rows(std::span<const DeviceRecord> records, const FleetLot& lot) {
  std::vector<TableRow> out;
  for (const std::size_t r : lot.order)
    for (const RecordedChannel& c : records[r].channels) out.push_back({&records[r], &batch_of(lot, r), &c});
  return out;
}

bool any_has(const std::vector<TableRow>& rows, DeviceQuantity quantity) {
  for (const TableRow& row : rows)
    if (row.channel->find(quantity) != nullptr) return true;
  return false;
}

std::vector<TableColumn> table_columns(const std::vector<TableRow>& rows) {
  std::vector<TableColumn> out = {
      text("type", [](const TableRow& r) -> const std::string& { return r.record->type; }),
      text("batch", [](const TableRow& r) -> const std::string& { return *r.batch; }),
      text("device", [](const TableRow& r) -> const std::string& { return r.record->device; }),
      text("log", [](const TableRow& r) -> const std::string& { return r.record->log; }),
      text("channel", [](const TableRow& r) -> const std::string& { return r.channel->name; }),
      text("unit", [](const TableRow& r) -> const std::string& { return r.channel->unit; }),
      number("temperature_c", [](const TableRow& r) { return r.record->temperature_c.value_or(kNone); }),
      number("rate_hz", [](const TableRow& r) { return r.channel->fitted ? r.channel->rate_hz : kNone; }),
      number("duration_s", [](const TableRow& r) { return r.channel->fitted ? r.channel->duration_s : kNone; }),
      counted("samples", [](const TableRow& r) { return r.channel->samples; }),
      counted("missing", [](const TableRow& r) { return r.channel->missing; }),
      number("p", [](const TableRow& r) { return r.channel->p; }),
  };
  for (const auto& [quantity, word] : enum_table<DeviceQuantity>) {
    if (!any_has(rows, quantity)) continue;
    out.push_back({std::string(word) + "_status", StatusOf{quantity}});
    out.push_back(number_of(quantity, "", [](const RecordedValue& v) { return v.value; }));
    out.push_back(number_of(quantity, "_low95", [](const RecordedValue& v) { return v.ci95.low; }));
    out.push_back(number_of(quantity, "_high95", [](const RecordedValue& v) { return v.ci95.high; }));
    out.push_back(number_of(quantity, "_sd", absolute_sd));
    out.push_back(number_of(quantity, "_upper95", [](const RecordedValue& v) { return v.upper95; }));
  }
  return out;
}

Status status_in(const TableRow& row, DeviceQuantity quantity) {
  const RecordedValue* value = row.channel->find(quantity);
  return value == nullptr ? Status::not_fitted : value->status;
}

std::string valid_text(const std::string& one) {
  return first_invalid_utf8(one) == std::string_view::npos ? one : printable(one);
}

struct CsvCellOf {
  const TableRow& row;
  std::string operator()(TextOf of) const { return csv_cell(valid_text(of(row))); }
  std::string operator()(CountOf of) const { return std::to_string(of(row)); }
  std::string operator()(const NumberOf& of) const {
    const double value = of(row);
    return std::isnan(value) ? "" : shortest(value);
  }
  std::string operator()(const StatusOf& of) const { return std::string(name_of(status_in(row, of.quantity))); }
};

struct NpzArrayOf {
  NpzWriter& out;
  const std::string& name;
  const std::vector<TableRow>& rows;

  template <class T, class Function>
  std::vector<T> all(Function&& of) const {
    std::vector<T> values;
    values.reserve(rows.size());
    for (const TableRow& row : rows) values.push_back(of(row));
    return values;
  }
  void operator()(TextOf of) const {
    out.add(name, rows.size(), [&](std::size_t i) -> const std::string& { return of(rows[i]); });
  }
  void operator()(CountOf of) const { out.add(name, all<std::uint64_t>(of)); }
  void operator()(const NumberOf& of) const { out.add(name, all<double>(of)); }
  void operator()(const StatusOf& of) const {
    out.add(name, all<std::uint8_t>(
                      [&](const TableRow& row) { return static_cast<std::uint8_t>(status_in(row, of.quantity)); }));
  }
};

constexpr std::size_t kPiece = std::size_t{1} << 20U;

}  // namespace

void write_coefficients_csv(std::span<const DeviceRecord> records, const FleetLot& lot, const TakeBytes& take) {
  const std::vector<TableRow> rows = table_rows(records, lot);
  const std::vector<TableColumn> columns = table_columns(rows);
  std::string piece;
  for (const TableColumn& c : columns) piece += (piece.empty() ? "" : ",") + c.name;
  piece += "\n";
  for (const TableRow& row : rows) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (c > 0) piece += ',';
      piece += std::visit(CsvCellOf{row}, columns[c].of);
    }
    piece += '\n';
    if (piece.size() < kPiece) continue;
    take(piece);
    piece.clear();
  }
  take(piece);
}

void write_coefficients_npz(std::span<const DeviceRecord> records, const FleetLot& lot, const TakeBytes& take) {
  const std::vector<TableRow> rows = table_rows(records, lot);
  NpzWriter out(take);
  for (const TableColumn& column : table_columns(rows)) std::visit(NpzArrayOf{out, column.name, rows}, column.of);
  static_assert(static_cast<int>(Status::detected) == 0, "the words are in the order of the enum");
  const std::vector<std::string> words = words_of<Status>();
  out.add("status_words", words.size(), [&](std::size_t i) -> const std::string& { return words[i]; });
  out.finish();
}

}  // namespace libchar
