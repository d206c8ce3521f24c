// The document of a lot: lot.json.

#include <algorithm>
#include <nlohmann/json.hpp>

#include "libchar/core/document/coefficient_fields.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/detail/report_rows.hpp"
#include "libchar/report/html/fleet_report.hpp"

namespace libchar {
namespace {

/// Lists that grow with the fleet end there: coefficients.csv has all.
constexpr std::size_t kMostFailed = 1000, kOutliersInJson = 100, kMostSlopes = 1000;

Json counts_json(const LotCounts& c) {
  return {{"members", c.members},   {"counted", c.counted}, {"not_detected", c.not_detected},
          {"doubtful", c.doubtful}, {"spoilt", c.spoilt},   {"no_result", c.no_result}};
}

void add_figures(Json& out, const std::optional<LotFigures>& f) {
  out["mean"] = f ? json_number(f->mean) : Json(nullptr);
  out["mean_ci95"] = f ? interval_json(f->mean_ci95) : Json(nullptr);
  out["spread"] = f ? json_number(f->spread) : Json(nullptr);
  out["spread_ci95"] = f ? interval_json(f->spread_ci95) : Json(nullptr);
}

Json device_json(const FleetReport& report, std::size_t recording) {
  const DeviceRecord& r = report.records[recording];
  return {{"device", json_text(r.device)},
          {"type", json_text(r.type)},
          {"batch", json_text(batch_of(*report.lot, recording))},
          {"report", r.report.empty() ? Json(nullptr) : Json(json_text(r.report + "/report.html"))}};
}

Json problems_json(const FleetReport& report, const std::vector<std::size_t>& recordings) {
  Json out = Json::array();
  for (std::size_t i = 0; i < std::min(kMostFailed, recordings.size()); ++i) {
    const DeviceRecord& r = report.records[recordings[i]];
    out.push_back({{"device", json_text(r.device)}, {"log", json_text(r.log)}, {"problem", json_text(r.problem)}});
  }
  return out;
}

Json batches_json(const QuantityLot& q) {
  Json out = Json::array();
  for (const BatchLot& b : q.batches) {
    Json one = {{"batch", json_text(b.batch)}};
    one.update(counts_json(b.counts));
    add_figures(one, b.figures);
    one["of_all"] = b.in_figures > b.counts.counted;
    one["median"] = json_number(b.median);
    out.push_back(std::move(one));
  }
  return out;
}

Json zones_json(const ZoneFindings& zones) {
  Json out = {{"alarm", zones.alarm}, {"any_by_chance", json_number(zones.any_by_chance)}, {"rules", Json::object()}};
  for (std::size_t r = 0; r < kZoneRules; ++r) {
    const ZoneFinding& found = zones.rule[r];
    out["rules"][std::string(name_of(static_cast<ZoneRule>(r)))] = {{"signals", found.signals},
                                                                    {"by_chance", json_number(found.by_chance)},
                                                                    {"p", json_number(found.p)},
                                                                    {"alarm", found.alarm}};
  }
  return out;
}

Json chart_json(const FleetReport& report, const QuantityLot& q) {
  if (!q.chart) return nullptr;
  const ControlChart& c = *q.chart;
  const ZoneFinding& runs = c.zones.of(ZoneRule::eight_in_a_row);
  Json out = {{"centre", json_number(c.centre)},
              {"sigma", json_number(c.sigma)},
              {"limits", interval_json(c.limits)},
              {"of", in_logarithm(q.quantity) ? "logarithm" : "value"},
              {"beyond", Json::array()},
              {"beyond_count", c.beyond.size()},
              {"beyond_by_chance", c.zones.of(ZoneRule::beyond_3_sigma).by_chance},
              {"runs", runs.signals},
              {"runs_by_chance", runs.by_chance},
              {"zones", zones_json(c.zones)}};
  for (std::size_t i = 0; i < std::min(kOutliersInJson, c.beyond.size()); ++i)
    out["beyond"].push_back(json_text(report.records[q.charted[c.beyond[i].index]].device));
  return out;
}

Json temperatures_json(const FleetReport& report, const std::optional<TemperatureRuns>& t) {
  if (!t) return nullptr;
  Json slopes = Json::array();
  for (std::size_t i = 0; i < std::min(kMostSlopes, t->slopes.size()); ++i) {
    const DeviceSlope& one = t->slopes[i];
    slopes.push_back({{"device", json_text(report.records[one.recording].device)},
                      {"recordings", one.recordings},
                      {"temperature_c", interval_json(one.temperature_c)},
                      {"value", json_number(one.value)},
                      {"ci95", interval_json(one.ci95)}});
  }
  return {{"devices", t->devices},
          {"recordings", t->recordings},
          {"range_c", interval_json(t->range_c)},
          {"reference_c", json_number(t->reference_c)},
          {"elsewhere", t->elsewhere},
          {"repeatability", json_number(t->repeatability)},
          {"repeatability_ci95", interval_json(t->repeatability_ci95)},
          {"degrees_of_freedom", t->dof},
          {"in_one_recording", t->in_one_recording},
          {"slopes", std::move(slopes)}};
}

Json capability_json(const std::optional<Capability>& c) {
  if (!c) return nullptr;
  return {{"most", c->most},
          {"text", json_text(c->text)},
          {"pass", c->pass},
          {"fail", c->fail},
          {"not_decided", c->not_decided},
          {"ppk", json_number(c->ppk)},
          {"ppk_ci95", c->ppk ? interval_json(c->ppk_ci95) : Json(nullptr)},
          {"cpk", json_number(c->cpk)},
          {"above", c->ppk ? json_number(c->above) : Json(nullptr)}};
}

Json outliers_json(const FleetReport& report, const QuantityLot& q) {
  Json out = Json::array();
  for (std::size_t i = 0; i < std::min(kOutliersInJson, q.outliers.size()); ++i) {
    const FleetOutlier& o = q.outliers[i];
    const DeviceRecord& r = report.records[o.recording];
    out.push_back({{"device", json_text(r.device)},
                   {"channel", o.all_channels ? Json(nullptr) : Json(json_text(r.channels[o.channel].name))},
                   {"value", json_number(o.value)},
                   {"ratio", in_logarithm(q.quantity) ? json_number(o.ratio) : Json(nullptr)},
                   {"deviation", json_number(o.deviation)},
                   {"p", json_number(o.p)},
                   {"sentence", json_text(o.sentence)}});
  }
  return out;
}

Json histogram_json(const QuantityLot& q) {
  const Histogram& h = q.histogram;
  return {{"of", in_logarithm(q.quantity) ? "logarithm" : "value"},
          {"low", json_number(h.low)},
          {"step", json_number(h.step)},
          {"count", h.count},
          {"below", h.below},
          {"above", h.above}};
}

Json quantity_json(const FleetReport& report, const QuantityLot& q) {
  Json out = {{"type", json_text(q.type)},
              {"group", json_text(q.group)},
              {"of_kind", q.of_kind},
              {"what", std::string(name_of(q.quantity))},
              {"unit", json_text(q.unit)}};
  out.update(counts_json(q.counts));
  add_figures(out, q.figures);
  const auto& left = q.left_out;
  out["left_out"] = left ? Json{{"share", json_number(left->share)},
                                {"mean_ci95", interval_json(left->mean_ci95)},
                                {"factor", json_number(left->factor)},
                                {"spread_high", json_number(left->spread_high)}}
                         : Json(nullptr);
  out["spread_is"] = in_logarithm(q.quantity) ? "relative" : "absolute";
  out["of_all"] = q.of_all;
  out["p"] = q.effects ? json_number(q.effects->p) : Json(nullptr);
  const auto& plain = q.arithmetic;
  out["arithmetic"] = plain ? Json{{"mean", json_number(plain->mean)},
                                   {"mean_ci95", interval_json(plain->mean_ci95)},
                                   {"sd", json_number(plain->sd)},
                                   {"sd_ci95", interval_json(plain->sd_ci95)}}
                            : Json(nullptr);
  out["quantiles"] = Json::array();
  for (std::size_t k = 0; k < kLotQuantiles.size(); ++k)
    out["quantiles"].push_back({kLotQuantiles[k], json_number(q.quantiles[k])});
  out["histogram"] = histogram_json(q);
  out["batches"] = batches_json(q);
  const auto& d = q.batch_difference;
  out["batch_difference"] = d ? Json{{"between", json_number(d->between)},
                                     {"between_ci95", interval_json(d->between_ci95)},
                                     {"within", json_number(d->within)},
                                     {"p", json_number(d->p)}}
                              : Json(nullptr);
  out["repeats"] = q.repeats ? Json{{"devices", q.repeats->devices},
                                    {"recordings", q.repeats->recordings},
                                    {"within", json_number(q.repeats->within)},
                                    {"within_ci95", interval_json(q.repeats->within_ci95)}}
                             : Json(nullptr);
  out["temperatures"] = temperatures_json(report, q.temperatures);
  out["chart"] = chart_json(report, q);
  out["capability"] = capability_json(q.capability);
  out["outlier_count"] = q.outliers.size();
  out["outliers"] = outliers_json(report, q);
  return out;
}

}  // namespace

Json fleet_json(const FleetReport& report) {
  const FleetLot& lot = *report.lot;
  Json out = many_head("lot", report.recordings, report.command);
  for (const Finding& one : lot.findings) {
    Json row = document_of(finding_fields(), one);
    row["file"] = json_text(report.name);
    out["findings"].push_back(std::move(row));
  }
  out["name"] = json_text(report.name);
  out["verdict"] = json_text(lot.verdict);
  out["notes"] = texts_json(lot.notes);
  out["devices"] = lot.devices;
  out["recordings"] = lot.order.size();
  out["types"] = texts_json(lot.types);
  out["batches"] = texts_json(lot.batches);
  out["outlying"] = lot.outlying;
  out["limits"] = {{"failing", lot.failing}, {"not_decided", lot.open}, {"keeping", lot.keeping}};
  out["failed_count"] = lot.failed.size();
  out["failed"] = problems_json(report, lot.failed);
  out["awaited_count"] = lot.awaited.size();
  out["awaited"] = problems_json(report, lot.awaited);
  out["worst"] = Json::array();
  for (const WorstDevice& w : lot.worst) {
    Json one = device_json(report, w.recording);
    one["p"] = json_number(w.p);
    one["deviation"] = json_number(w.deviation);
    one["reasons"] = texts_json(w.reasons);
    out["worst"].push_back(std::move(one));
  }
  out["quantities"] = list_json(lot.quantities, [&](const QuantityLot& q) { return quantity_json(report, q); });
  return out;
}

}  // namespace libchar
