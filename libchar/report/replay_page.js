// Draws the plots of a replay from the JSON in the page (page_common.js): error against cost, everything over time with a stretch
// to choose, the Allan deviation of each error. What is shown first is legible: the best method, the mean, the bounds.
(function () {
  "use strict";

  const { report, INK, DIM, MEASURED, numberText, positive, padded, logAxis, whitePaper, legend, options, start } = reportPage;

  // ---- who is who ----
  const score = (a) => (report.score === "rmse" ? a.rmse : a.without_reference && a.without_reference.predictive_rms);
  const scoreName = report.score === "rmse" ? "RMSE" : "leave-one-out RMS";
  const ran = report.algorithms.filter((a) => a.status === "ran");
  const order = ran.slice().sort((a, b) => (score(a) === null) - (score(b) === null) || score(a) - score(b));
  const unit = report.inputs.length ? report.inputs[0].unit : "";
  const withUnit = (text, u) => (u ? text + ", " + u : text);

  // Neighbours in the table differ in colour and in dash; 8 and 5 have no common factor, so 40 lines differ in one of both.
  const COLOURS = ["#1b4f8f", "#c03a12", "#1e7a3c", "#7a3fa0", "#a86a00", "#00757f", "#b0226b", "#4a4f57"];
  const DASHES = [[], [9, 4], [2, 3], [11, 3, 2, 3], [5, 2, 1, 2, 1, 2]];
  const MARKS = ["circle", "rect", "triangle", "rectRot", "star", "crossRot"];
  const style = (k) => ({ colour: COLOURS[k % COLOURS.length], dash: DASHES[k % DASHES.length] });
  const styleOf = (a) => style(order.indexOf(a));
  const faint = (colour, alpha) => colour + Math.round(255 * alpha).toString(16).padStart(2, "0");

  const shown = new Set();
  function showDefaults() {
    shown.clear();
    const best = order.find((a) => a.label === report.best);
    const free = order.find((a) => !a.bound && !a.description.learns_from_reference);
    [best, free, order.find((a) => a.name === "mean")].concat(order.filter((a) => a.bound)).forEach((a) => { if (a) shown.add(a); });
    if (!shown.size) order.slice(0, 3).forEach((a) => shown.add(a));
  }
  showDefaults();

  // ---- a stretch of time ----
  // In the unit in which one would say how long it took.
  const lastSecond = report.start_s + report.instants / report.rate_hz;
  const [TIME, timeUnit] = lastSecond > 4e5 ? [86400, "d"] : lastSecond > 2e4 ? [3600, "h"] : [1, "s"];
  const whole = [report.start_s / TIME, lastSecond / TIME];
  let stretch = whole.slice();
  const inStretch = (t) => t >= stretch[0] && t <= stretch[1];

  function linearAxis(title, min, max) {
    return {
      type: "linear", min, max, title: { display: true, text: title, color: INK, font: { size: 12.5 } },
      ticks: { color: INK, maxRotation: 0, callback: (v) => numberText(v, 5) }, grid: { color: "#edf0f3", borderColor: "#8a929b" },
    };
  }
  // Within less than a decade the powers of ten are too few: even steps, as on a linear axis.
  function valueAxis(title, min, max) {
    const axis = logAxis(title, min, max);
    if (!(max / min < 6)) return axis;
    const rough = (max - min) / 6, power = Math.pow(10, Math.floor(Math.log10(rough)));
    const step = [1, 2, 5, 10].map((f) => f * power).find((s) => s >= rough);
    axis.afterBuildTicks = (a) => {
      a.ticks = [];
      for (let k = Math.ceil(min / step); k * step <= max; ++k) a.ticks.push({ value: k * step });
    };
    axis.ticks.callback = (v) => numberText(v, 4);
    axis.grid = { color: "#edf0f3", borderColor: "#8a929b" };
    return axis;
  }
  const timeAxis = () => linearAxis("time from the recording's first sample, " + timeUnit, stretch[0], stretch[1]);

  // One bin beyond each end, so that lines reach the frame.
  function window_of(time) {
    let from = time.findIndex((t) => t / TIME >= stretch[0]), to = time.length;
    if (from < 0) from = time.length;
    while (to > 0 && time[to - 1] / TIME > stretch[1]) --to;
    return [Math.max(0, from - 1), Math.min(time.length, to + 1)];
  }

  // A line and, where a bin spans more than a line's width, the band from its smallest to its largest value.
  function bandLine(name, track, series, look, logarithmic, tip) {
    const [from, to] = window_of(track.time_s);
    const value = (v) => (v === null || (logarithmic && !(v > 0)) ? NaN : v);
    const low = [], high = [], middle = [];
    for (let i = from; i < to; ++i) {
      const x = track.time_s[i] / TIME, a = value(track.low[series][i]), b = value(track.high[series][i]);
      low.push({ x, y: a });
      high.push({ x, y: b });
      middle.push({ x, y: logarithmic ? Math.sqrt(a * b) : (a + b) / 2, low: a, high: b });
    }
    const plain = { borderWidth: 0, pointRadius: 0, pointHitRadius: 0, order: 9, label: "" };
    return [
      { label: name, data: middle, borderColor: look.colour, backgroundColor: look.colour, borderDash: look.dash, borderWidth: 1.8, pointRadius: middle.length < 3 ? 3 : 0, pointHoverRadius: 4, pointHitRadius: 6, fill: false, order: 2, tip: (p) => tip(name, p) },
      Object.assign({ data: high, backgroundColor: faint(look.colour, 0.2), fill: "+1", quiet: true }, plain),
      Object.assign({ data: low, fill: false, backgroundColor: "transparent", quiet: true }, plain),
    ];
  }
  // A value that stands still.
  function flat(name, y, look, tip) {
    return { label: name, data: [{ x: whole[0], y, low: y, high: y }, { x: whole[1], y, low: y, high: y }], borderColor: look.colour, backgroundColor: look.colour, borderDash: look.dash, borderWidth: 1.8, pointRadius: 0, pointHitRadius: 6, fill: false, order: 2, tip: tip && ((p) => tip(name, p)) };
  }
  function extremes(sets) {
    const values = [];
    sets.forEach((set) => set.data.forEach((p) => { if (positive(p.y) && (inStretch(p.x) || set.data.length < 4)) values.push(p.y); }));
    return values;
  }
  const minMax = (values) => values.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
  function logFor(title, sets, factor) {
    const [low, high] = minMax(extremes(sets));
    return low <= high ? valueAxis(title, low / factor, high * factor) : logAxis(title, 0.1, 10);
  }
  const timeTip = (u) => (name, p) => {
    const out = [name, "t = " + numberText(p.x, 6) + " " + timeUnit];
    out.push(p.low === p.high ? numberText(p.low, 5) + " " + u : numberText(p.low, 4) + " … " + numberText(p.high, 4) + " " + u);
    return out;
  };

  // Only what is drawn has an entry; toggling is done by the boxes above the plots.
  function plainLegend(dashed) {
    const all = legend();
    all.onClick = () => {};
    const labels = all.labels.generateLabels;
    all.labels.generateLabels = (chart) => labels(chart).filter((item) => item.text && !item.hidden);
    all.maxHeight = 110;
    // Long enough to tell the dashes apart.
    if (dashed) all.labels.pointStyleWidth = 36;
    return all;
  }
  function chart(sets, x, y, plugins) {
    const all = options(x, y);
    all.plugins.legend = plainLegend(!sets.some((set) => set.marks));
    return { type: "line", data: { datasets: sets }, plugins: [whitePaper].concat(plugins || []), options: all };
  }

  // ---- error against cost ----
  // Names beside their marks, none over another: four places are tried, and a name that fits nowhere is left to the pointer.
  const pointNames = {
    id: "pointNames",
    afterDatasetsDraw(chart) {
      const pen = chart.ctx, area = chart.chartArea, taken = [], marks = [];
      chart.data.datasets.forEach((set, index) => {
        if (!set.named) return;
        chart.getDatasetMeta(index).data.forEach((mark, i) => {
          marks.push({ x: mark.x, y: mark.y, a: set.data[i].a, dim: set.data[i].dim, name: set.data[i].name });
          taken.push([mark.x - 6, mark.y - 6, mark.x + 6, mark.y + 6]);
        });
      });
      marks.sort((p, q) => p.dim - q.dim || score(p.a) - score(q.a));
      pen.save();
      pen.textBaseline = "middle";
      pen.lineWidth = 4;
      pen.strokeStyle = "rgba(255,255,255,0.9)";
      marks.forEach((p) => {
        pen.font = (p.a.label === report.best ? "700 " : p.dim ? "" : "600 ") + "12px system-ui, 'DejaVu Sans', sans-serif";
        const w = pen.measureText(p.name).width;
        const places = [[10, 0], [-10 - w, 0], [-w / 2, -15], [-w / 2, 15], [8, -13], [8, 13], [-8 - w, -13], [-8 - w, 13]];
        const free = places.map(([dx, dy]) => [p.x + dx, p.y + dy - 7, p.x + dx + w, p.y + dy + 7]).find((box) =>
          box[0] > area.left && box[2] < area.right && box[1] > area.top && box[3] < area.bottom &&
          taken.every((t) => box[0] > t[2] || box[2] < t[0] || box[1] > t[3] || box[3] < t[1]));
        if (!free) return;
        taken.push(free);
        pen.fillStyle = p.dim ? "#8a929b" : INK;
        pen.strokeText(p.name, free[0], (free[1] + free[3]) / 2);
        pen.fillText(p.name, free[0], (free[1] + free[3]) / 2);
      });
      pen.restore();
    },
  };

  // One method that diverged may not press all others together: beyond a thousand times the best, marks stand on the edge.
  const LARGEST = 1000;
  // What the best fixed weights (or filter) of this run would have reached.
  const optimumOf = (input) => (report.inputs[input] ? report.inputs[input].optimum_rmse : null);
  function optimumLine(input, from, to, u) {
    const y = optimumOf(input);
    if (!positive(y)) return [];
    return [{ label: "optimum of this scene", data: [{ x: from, y }, { x: to, y }], borderColor: INK, backgroundColor: INK, borderDash: [1, 4], borderWidth: 1.4, pointRadius: 0, pointHitRadius: 4, fill: false, order: 6, tip: () => ["optimum of this scene", numberText(y, 5) + " " + u] }];
  }
  function costChart(key, front, title, axis, tipLine) {
    const all = order.filter((a) => positive(score(a)) && positive(a[key]));
    const top = LARGEST * minMax(all.map(score))[0];
    const points = all.map((a) => ({ x: a[key], y: Math.min(score(a), top), a, dim: !a.on_front[front], name: a.label + (score(a) > top ? " ↑ " + numberText(score(a), 2) : "") }));
    const kinds = [
      { name: "needs no reference", of: (a) => !a.bound && !a.description.learns_from_reference, mark: "circle" },
      { name: "learns from a reference", of: (a) => !a.bound && a.description.learns_from_reference, mark: "rect" },
      { name: "bound: looks at the reference of the run", of: (a) => a.bound, mark: "triangle" },
    ];
    const tip = (p) => {
      const out = [p.a.label, scoreName + " " + numberText(score(p.a), 5) + " " + unit];
      if (p.a.regret !== null) out.push("regret " + numberText(100 * p.a.regret, 3) + " %");
      out.push(tipLine(p.x));
      if (p.a.bound) out.push("bound: not a method");
      else out.push(p.dim ? "another method is better in both" : "on the front");
      return out;
    };
    const sets = kinds.map((kind) => {
      const data = points.filter((p) => kind.of(p.a));
      const colours = data.map((p) => (p.a.bound ? DIM : p.dim ? "#aab2bb" : MEASURED));
      return {
        label: kind.name, data, showLine: false, named: true, marks: true, pointStyle: kind.mark, borderColor: kind.mark === "triangle" ? DIM : MEASURED, borderWidth: 1.8,
        pointBorderColor: colours, pointBackgroundColor: data.map((p, i) => (p.a.bound ? "#fff" : colours[i])), pointRadius: data.map((p) => (p.a.label === report.best ? 8 : 5.5)), pointHoverRadius: 8, tip, order: 1, fill: false,
      };
    }).filter((set) => set.data.length);
    const [xMin, xMax] = padded(points.map((p) => p.x), 2.2);
    const [low, high] = minMax(points.map((p) => p.y));
    const [yMin, yMax] = padded(points.map((p) => p.y), Math.max(1.2, Math.pow(high / low, 0.07)));
    // A staircase: what the methods on it do not reach lies below and left of it.
    const line = points.filter((p) => !p.dim).sort((p, q) => p.x - q.x).map(({ x, y }) => ({ x, y }));
    if (report.score === "rmse" && points.length) sets.push(...optimumLine(0, xMin, xMax, unit));
    if (line.length) {
      line.unshift({ x: line[0].x, y: yMax });
      line.push({ x: xMax, y: line[line.length - 1].y });
      sets.push({ label: "Pareto front", data: line, stepped: "before", borderColor: COLOURS[1], borderWidth: 1.5, borderDash: [6, 3], pointRadius: 0, pointHitRadius: 0, fill: false, order: 5 });
    }
    return chart(sets, logAxis(title, xMin, xMax), valueAxis(axis, yMin, yMax), [pointNames]);
  }

  // ---- over time ----
  function windowChart(input, axis, u) {
    const sets = [];
    order.filter((a) => shown.has(a)).forEach((a) => {
      const track = a.inputs[input] && a.inputs[input].window_rms;
      if (track) sets.push(...bandLine(a.label, track, 0, styleOf(a), true, timeTip(u)));
    });
    if (sets.length) sets.push(...optimumLine(input, whole[0], whole[1], u));
    return chart(sets, timeAxis(), logFor(withUnit(axis, u), sets, 1.2), [dragging]);
  }

  let tracked = null;
  const flatWeights = (a) => a.weights !== null && a.weights.length > 0 && !Array.isArray(a.weights[0]);
  const trackable = order.filter((a) => flatWeights(a) || a.variances || a.watches_faults);
  tracked = [(a) => a.label === report.best && a.weight_track, (a) => a.weight_track && a.watches_faults, (a) => a.weight_track || a.watches_faults, (a) => a.label === report.best, () => true]
    .map((wish) => trackable.find(wish)).find(Boolean) || null;

  // More lines than this nobody tells apart: those of the largest weights (smallest variances) are drawn, and the rest are counted.
  const MOST_LINES = 24;
  function drawnSensors(values, logarithmic) {
    const all = report.sensors.map((s, i) => i);
    if (all.length <= MOST_LINES) return all;
    const rank = (i) => (!values || values[i] === null || Array.isArray(values[i]) ? -Infinity : logarithmic ? -values[i] : Math.abs(values[i]));
    return all.sort((a, b) => rank(b) - rank(a) || a - b).slice(0, MOST_LINES).sort((a, b) => a - b);
  }
  function sensorSets(track, values, logarithmic, u) {
    const sets = [];
    drawnSensors(values, logarithmic).forEach((i) => {
      const s = report.sensors[i];
      if (track) sets.push(...bandLine(s.name, track, i, style(i), logarithmic, timeTip(u)));
      else if (values && values.length && values[i] !== null && (!logarithmic || values[i] > 0)) sets.push(flat(s.name, values[i], style(i), timeTip(u)));
    });
    return sets;
  }
  const nothing = (text) => ({
    id: "nothing",
    afterDraw(chart) {
      const pen = chart.ctx, area = chart.chartArea;
      pen.save();
      pen.font = "13px system-ui, 'DejaVu Sans', sans-serif";
      pen.fillStyle = DIM;
      pen.textAlign = "center";
      pen.fillText(text, (area.left + area.right) / 2, (area.top + area.bottom) / 2);
      pen.restore();
    },
  });
  function weightsChart() {
    const sets = tracked && flatWeights(tracked) ? sensorSets(tracked.weight_track, tracked.weights, false, "") : [];
    return chart(sets, timeAxis(), linearAxis("weight", undefined, undefined), [dragging].concat(sets.length ? [] : [nothing((tracked ? tracked.label : "This method") + " has no single weights")]));
  }
  function variancesChart(index, axis, u) {
    const sets = tracked ? sensorSets(tracked.variance_track, tracked.variances, true, u) : [];
    const estimated = sets.length > 0;
    if (estimated) {
      drawnSensors(tracked.variances, true).forEach((i) => {
        const s = report.sensors[i];
        if (positive(s.rmse)) sets.push(Object.assign(flat("", s.rmse * s.rmse, { colour: faint(style(i).colour, 0.55), dash: [1, 3] }), { order: 6, borderWidth: 1.3 }));
      });
    }
    return chart(sets, timeAxis(), logFor(axis + (u ? ", " + u : ""), sets, 1.3), [dragging].concat(estimated ? [] : [nothing((tracked ? tracked.label : "This method") + " estimates no variances")]));
  }

  const MOST_ROWS = 24;
  function faultsChart() {
    const end = whole[1], names = report.sensors.map((s) => s.name);
    const bar = (f) => ({ x: [Math.max(f.from_s / TIME, whole[0]), Math.min(f.to_s === null ? end : f.to_s / TIME, end)], y: String(names.indexOf(f.sensor)), f });
    const span = (f) => numberText(f.from_s / TIME, 6) + " … " + (f.to_s === null ? "the end" : numberText(f.to_s / TIME, 6) + " " + timeUnit);
    const known = report.faults.filter((f) => f.from_s / TIME < end && (f.to_s === null || f.to_s / TIME > whole[0])).map(bar);
    const found = tracked ? tracked.faults.map(bar) : [];
    // Of a large array only the sensors that have something to show.
    const busy = new Set(known.concat(found).map((p) => p.y)), all_rows = names.map((n, i) => String(i));
    const rows = names.length <= MOST_ROWS ? all_rows : all_rows.filter((i) => busy.has(i)).slice(0, MOST_ROWS);
    const silent = known.length + found.length ? [] : [nothing("No fault is known, and none was found")];
    const plain = { grouped: false, minBarLength: 3, borderSkipped: false };
    const sets = [
      Object.assign({ label: "found by " + (tracked ? tracked.label : "–"), data: found.filter((p) => rows.includes(p.y)), backgroundColor: COLOURS[1], swatch: COLOURS[1], barPercentage: 0.36, order: 1, tip: (p) => [names[p.y] + ": out", span(p.f)] }, plain),
      Object.assign({ label: "known to the scene", data: known.filter((p) => rows.includes(p.y)), backgroundColor: "#9fb9da", swatch: "#9fb9da", barPercentage: 0.85, order: 2, tip: (p) => [names[p.y] + ": " + p.f.kind + (p.f.value === null ? "" : " " + numberText(p.f.value)), span(p.f)] }, plain),
    ];
    const y = { type: "category", labels: rows, offset: true, ticks: { color: INK, autoSkip: false, callback: (v) => shortened(names[rows[v]] || "") }, grid: { color: "#edf0f3", borderColor: "#8a929b" } };
    const all = options(timeAxis(), y);
    all.parsing = true;
    all.normalized = false;
    all.indexAxis = "y";
    all.plugins.legend = plainLegend();
    all.plugins.tooltip.callbacks.label = (item) => item.dataset.tip(item.raw);
    return { type: "bar", data: { labels: rows, datasets: sets }, plugins: [whitePaper, dragging].concat(silent), options: all };
  }

  // ---- Allan deviation of the errors ----
  function allanChart(input, axis, u) {
    const sets = [];
    order.filter((a) => shown.has(a)).forEach((a) => {
      const curve = a.inputs[input] && a.inputs[input].allan;
      if (!curve) return;
      const k = order.indexOf(a), look = style(k), data = [];
      curve.tau_s.forEach((x, i) => { if (positive(x) && positive(curve.deviation[i])) data.push({ x, y: curve.deviation[i] }); });
      sets.push({ label: a.label, data, borderColor: look.colour, backgroundColor: look.colour, borderDash: look.dash, pointStyle: MARKS[k % MARKS.length], pointRadius: 3.5, pointHoverRadius: 6, borderWidth: 1.7, fill: false, order: 2, tip: (p) => [a.label, "τ = " + numberText(p.x) + " s", numberText(p.y, 5) + " " + u] });
    });
    const points = sets.flatMap((set) => set.data), [xMin, xMax] = padded(points.map((p) => p.x), 1.4), [yMin, yMax] = padded(points.map((p) => p.y), 1.5);
    return chart(sets, logAxis("averaging time τ, s", xMin, xMax), valueAxis(withUnit(axis, u), yMin, yMax));
  }

  // ---- the sensors, beside the best that was made of them ----
  function sensorsChart(index, axis, u) {
    const all = report.sensors, last = all.length - 0.5, told = [], measured = [], low = [], high = [];
    all.forEach((s, i) => {
      if (positive(s.noise_variance)) told.push({ x: i, y: Math.sqrt(s.noise_variance), s });
      if (!positive(s.rmse)) return;
      measured.push({ x: i, y: s.rmse, s });
      if (s.rmse_ci95 && positive(s.rmse_ci95[0])) { low.push(s.rmse_ci95[0]); high.push(s.rmse_ci95[1]); }
    });
    const tip = (p) => [p.s.name, "RMSE " + numberText(p.s.rmse, 5) + " " + u].concat(p.s.rmse_ci95 ? ["95 %: " + numberText(p.s.rmse_ci95[0]) + " … " + numberText(p.s.rmse_ci95[1])] : [], positive(p.s.noise_variance) ? ["noise of a sample " + numberText(Math.sqrt(p.s.noise_variance), 4)] : []);
    const sets = [
      { label: "sensor", data: measured, showLine: false, marks: true, intervals: true, borderColor: MEASURED, backgroundColor: MEASURED, pointRadius: 5, pointHoverRadius: 7, fill: false, order: 1, tip },
      { label: "noise it was said to have", data: told, showLine: false, marks: true, borderColor: MEASURED, backgroundColor: "#fff", pointStyle: "rectRot", pointRadius: 6, pointBorderWidth: 1.6, fill: false, order: 2, tip },
    ].filter((set) => set.data.length);
    const best = order.find((a) => a.label === report.best), mean = order.find((a) => a.name === "mean");
    const level = (name, y, look) => sets.push(Object.assign(flat(name, y, look, () => [name, "RMSE " + numberText(y, 5) + " " + u]), { data: [{ x: -0.5, y }, { x: last, y }], order: 5 }));
    if (report.inputs.length === 1 && report.inputs[0].unit === all[0].unit && report.score === "rmse") {
      if (best && positive(best.rmse)) level("fused by " + best.label, best.rmse, styleOf(best));
      if (mean && mean !== best && positive(mean.rmse)) level("fused by mean", mean.rmse, styleOf(mean));
    }
    const [yMin, yMax] = padded(sets.flatMap((set) => set.data.map((p) => p.y)).concat(low, high), 1.2);
    const x = linearAxis("sensor", -0.5, last);
    x.ticks = { color: INK, autoSkip: true, maxRotation: 60, callback: (v) => (all[v] ? shortened(all[v].name) : "") };
    x.afterBuildTicks = (a) => { a.ticks = all.map((s, i) => ({ value: i })); };
    return chart(sets, x, valueAxis(withUnit(axis, u), yMin, yMax), [intervalBars]);
  }
  const shortened = (name) => (name.length > 18 ? name.slice(0, 17) + "…" : name);
  // Upright lines from end to end of a point's 95 % interval.
  const intervalBars = {
    id: "intervalBars",
    beforeDatasetsDraw(chart) {
      const pen = chart.ctx, y = chart.scales.y;
      chart.data.datasets.forEach((set, index) => {
        if (!set.intervals) return;
        pen.save();
        pen.strokeStyle = set.borderColor;
        pen.lineWidth = 1.6;
        chart.getDatasetMeta(index).data.forEach((mark, i) => {
          const pair = set.data[i].s.rmse_ci95;
          if (!pair || !positive(pair[0])) return;
          pen.beginPath();
          pair.forEach((v) => { pen.moveTo(mark.x - 4, y.getPixelForValue(v)); pen.lineTo(mark.x + 4, y.getPixelForValue(v)); });
          pen.moveTo(mark.x, y.getPixelForValue(pair[0]));
          pen.lineTo(mark.x, y.getPixelForValue(pair[1]));
          pen.stroke();
        });
        pen.restore();
      });
    },
  };

  // ---- dragging out a stretch ----
  let drag = null;
  const dragging = {
    id: "dragging",
    afterDraw(chart) {
      if (!drag || drag.chart !== chart) return;
      const pen = chart.ctx, area = chart.chartArea;
      pen.save();
      pen.fillStyle = "rgba(27,79,143,0.16)";
      pen.fillRect(Math.min(drag.from, drag.to), area.top, Math.abs(drag.to - drag.from), area.bottom - area.top);
      pen.restore();
    },
  };
  const time = (chart, x) => Math.min(whole[1], Math.max(whole[0], chart.scales.x.getValueForPixel(x)));
  function makeDraggable(canvas) {
    canvas.addEventListener("pointerdown", (event) => {
      const c = Chart.getChart(canvas);
      if (!c || event.button !== 0) return;
      drag = { chart: c, from: event.offsetX, to: event.offsetX };
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!drag || drag.chart.canvas !== canvas) return;
      drag.to = event.offsetX;
      drag.chart.draw();
    });
    canvas.addEventListener("pointerup", () => {
      if (!drag || drag.chart.canvas !== canvas) return;
      const { chart: c, from, to } = drag;
      drag = null;
      if (Math.abs(to - from) > 8) look([time(c, Math.min(from, to)), time(c, Math.max(from, to))]);
      else c.draw();
    });
    canvas.addEventListener("pointercancel", () => { drag = null; });
    canvas.addEventListener("dblclick", () => look(whole.slice()));
  }

  const onMemory = (b) => (b < 1000 ? b + " B" : b < 1e6 ? numberText(b / 1e3, 3) + " kB" : numberText(b / 1e6, 3) + " MB");
  const MAKERS = {
    "cost-time": (i, axis, u) => costChart("ns_per_sample", "time", "run time, ns a sample (one core)", withUnit(axis, u), (x) => numberText(x, 3) + " ns a sample"),
    "cost-memory": (i, axis, u) => costChart("peak_bytes", "memory", "peak memory, bytes", withUnit(axis, u), onMemory),
    window: windowChart, weights: weightsChart, variances: variancesChart, faults: faultsChart, "error-allan": allanChart, sensors: sensorsChart,
  };
  const HEIGHTS = { faults: 220, sensors: 220, "cost-time": 340, "cost-memory": 340 };
  const { figures, charts } = start(MAKERS, (kind) => HEIGHTS[kind] || 300, "details:not([open])");

  // ---- what is shown ----
  let waiting = false;
  const stale = new Set();
  function redraw(kinds) {
    kinds.forEach((kind) => stale.add(kind));
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      charts.forEach((drawn, figure) => {
        if (!stale.has(figure.dataset.kind)) return;
        const fresh = MAKERS[figure.dataset.kind](Number(figure.dataset.channel), figure.dataset.axis, figure.dataset.unit);
        drawn.destroy();
        charts.set(figure, new Chart(figure.querySelector("canvas"), fresh));
      });
      stale.clear();
    });
  }

  const OVER_TIME = ["window", "weights", "variances", "faults"], OF_TRACKED = ["weights", "variances", "faults"], OF_SHOWN = ["window", "error-allan"];
  const element = (name, text) => { const e = document.createElement(name); if (text !== undefined) e.textContent = text; return e; };
  const button = (text, action) => { const b = element("button", text); b.type = "button"; b.addEventListener("click", action); return b; };

  const boxes = [];
  function algorithmBoxes(place) {
    const set = element("fieldset");
    set.className = "shown";
    set.append(element("legend", "Shown in the window RMS and Allan plots"));
    order.forEach((a) => {
      const label = element("label"), box = element("input"), swatch = element("span"), look = styleOf(a);
      box.type = "checkbox";
      swatch.className = "swatch";
      swatch.style.borderTopColor = look.colour;
      swatch.style.borderTopStyle = look.dash.length ? (look.dash[0] < 4 ? "dotted" : "dashed") : "solid";
      box.addEventListener("change", () => { if (box.checked) shown.add(a); else shown.delete(a); redraw(OF_SHOWN); });
      boxes.push([box, a]);
      label.append(box, " ", swatch, a.label);
      set.append(label);
    });
    const tick = () => { boxes.forEach(([box, a]) => { box.checked = shown.has(a); }); redraw(OF_SHOWN); };
    set.append(button("first choice", () => { showDefaults(); tick(); }), button("all", () => { order.forEach((a) => shown.add(a)); tick(); }), button("none", () => { shown.clear(); tick(); }));
    boxes.forEach(([box, a]) => { box.checked = shown.has(a); });
    place.append(set);
  }

  let moved = () => {};
  function look(to) {
    // Some thousand samples at least make a stretch worth looking at; an empty one is none.
    stretch = to[1] - to[0] > (whole[1] - whole[0]) * 1e-5 ? to : whole.slice();
    moved();
    redraw(OVER_TIME);
  }
  function stretchControls(place) {
    const bar = element("div");
    bar.className = "controls";
    const steps = 1000, length = whole[1] - whole[0];
    const slider = (name) => { const s = element("input"); s.type = "range"; s.min = 0; s.max = steps; s.step = 1; s.setAttribute("aria-label", name); return s; };
    const from = slider("from"), to = slider("to"), said = element("output");
    const at = (s) => whole[0] + (length * Number(s.value)) / steps;
    const slid = () => { if (Number(from.value) < Number(to.value)) look([at(from), at(to)]); };
    from.addEventListener("input", slid);
    to.addEventListener("input", slid);
    moved = () => {
      from.value = Math.round((steps * (stretch[0] - whole[0])) / length);
      to.value = Math.round((steps * (stretch[1] - whole[0])) / length);
      said.textContent = numberText(stretch[0], 6) + " … " + numberText(stretch[1], 6) + " " + timeUnit;
    };
    moved();
    const labelled = (text, control) => { const l = element("label", text + " "); l.append(control); return l; };
    bar.append(labelled("From", from), labelled("to", to), said, button("whole run", () => look(whole.slice())));
    if (trackable.length) {
      const choice = element("select");
      trackable.forEach((a, i) => { const o = element("option", a.label); o.value = i; o.selected = a === tracked; choice.append(o); });
      choice.addEventListener("change", () => { tracked = trackable[Number(choice.value)]; redraw(OF_TRACKED); });
      bar.append(labelled("Weights, variances and faults of", choice));
    }
    place.append(bar);
  }

  // ---- sorting the table ----
  function sortable(table) {
    const head = Array.from(table.tHead.rows[0].cells), body = table.tBodies[0];
    head.forEach((cell, column) => {
      cell.dataset.sorts = "";
      cell.tabIndex = 0;
      cell.addEventListener("keydown", (event) => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); cell.click(); } });
      cell.addEventListener("click", () => {
        const up = cell.getAttribute("aria-sort") !== "ascending";
        head.forEach((other) => other.removeAttribute("aria-sort"));
        cell.setAttribute("aria-sort", up ? "ascending" : "descending");
        const key = (row) => { const c = row.cells[column]; return c.dataset.value === undefined ? c.textContent : c.dataset.value === "" ? null : Number(c.dataset.value); };
        // What has no value stays last in both orders.
        Array.from(body.rows).map((row) => [key(row), row]).sort(([a], [b]) => {
          if (a === null || b === null) return (a === null) - (b === null);
          const way = typeof a === "number" ? a - b : a < b ? -1 : a > b ? 1 : 0;
          return up ? way : -way;
        }).forEach(([, row]) => body.append(row));
      });
    });
  }

  document.querySelectorAll("table.ranking").forEach(sortable);
  const shownPlace = document.getElementById("shown-place"), stretchPlace = document.getElementById("stretch-place");
  if (shownPlace) algorithmBoxes(shownPlace);
  if (stretchPlace) stretchControls(stretchPlace);
  figures.filter((f) => OVER_TIME.includes(f.dataset.kind)).forEach((f) => makeDraggable(f.querySelector("canvas")));
})();
