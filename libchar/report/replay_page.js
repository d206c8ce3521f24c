// Draws the plots of a replay from the JSON in the page (page_common.js): the run, the ranking, faults and findings, everything over time
// with a stretch to choose, the Allan deviation of each error, error against cost. What is shown first is legible: the best method, the
// mean, the bounds. A method has one colour throughout the page, and so has a sensor, from two palettes.
(function () {
  "use strict";

  const { report, colours, numberText, positive, padded, logAxis, whitePaper, legend, options, timeMarks, start } = reportPage;

  // ---- who is who ----
  const score = (a) => (report.score === "rmse" ? a.rmse : a.without_reference && a.without_reference.predictive_rms);
  const scoreName = report.score === "rmse" ? "RMSE" : "leave-one-out RMS";
  const ran = report.algorithms.filter((a) => a.status === "ran");
  const labelled = new Map(ran.map((a) => [a.label, a]));
  const order = report.ranked.map((label) => labelled.get(label)).filter(Boolean);
  const unit = report.inputs.length ? report.inputs[0].unit : "";
  const withUnit = (text, u) => (u ? text + ", " + u : text);

  // Neighbours in the table differ in colour and in dash; the numbers of colours and of dashes have no common factor, so that thirty
  // methods and thirty-five sensors differ in one of both.
  const DASHES = [[], [9, 4], [2, 3], [11, 3, 2, 3], [5, 2, 1, 2, 1, 2]];
  const MARKS = ["circle", "rect", "triangle", "rectRot", "star", "crossRot"];
  const style = (palette, k) => ({ colour: palette[k % palette.length], dash: DASHES[k % DASHES.length] });
  // The best single sensor is drawn beside the best method: it has the colour that is least like that one's.
  const named = (name) => report.sensors.findIndex((s) => s.name === name), UNLIKE = 1, bestSensor = report.run ? named(report.run.sensor) : -1;
  const sensorStyle = (i) => style(colours().sensors, bestSensor < 0 ? i : i === bestSensor ? UNLIKE : i === UNLIKE ? bestSensor : i);
  const methodStyle = (k) => style(colours().methods, k);
  // Those that are drawn at first come first, so that their colours differ.
  const best = order.find((a) => a.label === report.best), free = order.find((a) => !a.bound && !a.description.learns_from_reference), plain = order.find((a) => a.name === "mean");
  const important = Array.from(new Set([best, free, plain].concat(order.filter((a) => a.bound)).filter(Boolean))), byColour = important.concat(order.filter((a) => !important.includes(a)));
  const rankOf = (a) => byColour.indexOf(a);
  const styleOf = (a) => methodStyle(rankOf(a));
  const rgba = (colour, alpha) => "rgba(" + [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16)).join(",") + "," + alpha + ")";
  const faint = (colour, alpha) => colour + Math.round(255 * alpha).toString(16).padStart(2, "0");

  const shown = new Set();
  function showDefaults() {
    shown.clear();
    important.forEach((a) => shown.add(a));
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
    const c = colours();
    return {
      type: "linear", min, max, title: { display: Boolean(title), text: title, color: c.ink, font: { size: 12.5 } },
      ticks: { color: c.ink, maxRotation: 0, callback: (v) => numberText(v, 5) }, grid: { color: c.fine, borderColor: c.border },
    };
  }
  function roundStep(least) {
    const power = Math.pow(10, Math.floor(Math.log10(least)));
    return [1, 2, 5, 10].map((f) => f * power).find((s) => s >= least);
  }
  // Within less than a decade the powers of ten are too few: even steps, as on a linear axis.
  function valueAxis(title, min, max) {
    const axis = logAxis(title, min, max);
    if (!(max / min < 6)) return axis;
    const step = roundStep((max - min) / 6);
    axis.afterBuildTicks = (a) => {
      a.ticks = [];
      for (let k = Math.ceil(min / step); k * step <= max; ++k) a.ticks.push({ value: k * step });
    };
    axis.ticks.callback = (v) => numberText(v, 4);
    axis.grid = { color: colours().fine, borderColor: colours().border };
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
      pen.strokeStyle = colours().halo;
      marks.forEach((p) => {
        pen.font = (p.a.label === report.best ? "700 " : p.dim ? "" : "600 ") + "12px system-ui, 'DejaVu Sans', sans-serif";
        const w = pen.measureText(p.name).width;
        const places = [[10, 0], [-10 - w, 0], [-w / 2, -15], [-w / 2, 15], [8, -13], [8, 13], [-8 - w, -13], [-8 - w, 13]];
        const free = places.map(([dx, dy]) => [p.x + dx, p.y + dy - 7, p.x + dx + w, p.y + dy + 7]).find((box) =>
          box[0] > area.left && box[2] < area.right && box[1] > area.top && box[3] < area.bottom &&
          taken.every((t) => box[0] > t[2] || box[2] < t[0] || box[1] > t[3] || box[3] < t[1]));
        if (!free) return;
        taken.push([free[0] - 4, free[1], free[2] + 4, free[3]]);
        pen.fillStyle = p.dim ? colours().border : colours().ink;
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
    return [{ label: "optimum of this scene", data: [{ x: from, y }, { x: to, y }], borderColor: colours().ink, backgroundColor: colours().ink, borderDash: [1, 4], borderWidth: 1.4, pointRadius: 0, pointHitRadius: 4, fill: false, order: 6, tip: () => ["optimum of this scene", numberText(y, 5) + " " + u] }];
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
      if (p.a.regret !== null) out.push(numberText(1 + p.a.regret, 5) + " × best possible");
      out.push(tipLine(p.x));
      if (p.a.bound) out.push("bound: not a method");
      else out.push(p.dim ? "another method is better in both" : "on the front");
      return out;
    };
    const sets = kinds.map((kind) => {
      const data = points.filter((p) => kind.of(p.a));
      const c = colours(), inks = data.map((p) => (p.a.bound ? c.dim : p.dim ? c.border : c.measured));
      return {
        label: kind.name, data, showLine: false, named: true, marks: true, pointStyle: kind.mark, borderColor: kind.mark === "triangle" ? c.dim : c.measured, borderWidth: 1.8,
        pointBorderColor: inks, pointBackgroundColor: data.map((p, i) => (p.a.bound ? c.paper : inks[i])), pointRadius: data.map((p) => (p.a.label === report.best ? 8 : 5.5)), pointHoverRadius: 8, tip, order: 1, fill: false,
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
      sets.push({ label: "Pareto front", data: line, stepped: "before", borderColor: colours().model, borderWidth: 1.5, borderDash: [6, 3], pointRadius: 0, pointHitRadius: 0, fill: false, order: 5 });
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
  tracked = [(a) => a.label === report.best && (a.weight_track || a.watches_faults), (a) => a.weight_track && a.watches_faults, (a) => a.weight_track || a.watches_faults, (a) => a.label === report.best, () => true]
    .map((wish) => trackable.find(wish)).find(Boolean) || null;

  // More lines than this cannot be told apart: those of the largest weights (smallest variances) are drawn, and the rest are counted.
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
      if (track) sets.push(...bandLine(s.name, track, i, sensorStyle(i), logarithmic, timeTip(u)));
      else if (values && values.length && values[i] !== null && (!logarithmic || values[i] > 0)) sets.push(flat(s.name, values[i], sensorStyle(i), timeTip(u)));
    });
    return sets;
  }
  const nothing = (text) => ({
    id: "nothing",
    afterDraw(chart) {
      const pen = chart.ctx, area = chart.chartArea;
      pen.save();
      pen.font = "13px system-ui, 'DejaVu Sans', sans-serif";
      pen.fillStyle = colours().dim;
      pen.textAlign = "center";
      pen.fillText(text, (area.left + area.right) / 2, (area.top + area.bottom) / 2);
      pen.restore();
    },
  });
  // A chart without a line is not drawn: a sentence says why.
  function drawnIf(sets, figure, why) {
    const note = figure.querySelector(".nothing") || figure.appendChild(Object.assign(document.createElement("p"), { className: "note nothing" }));
    note.textContent = (tracked ? tracked.label : "This method") + " " + why;
    note.hidden = sets.length > 0;
    figure.querySelectorAll(".canvas, figcaption, .save").forEach((part) => { part.hidden = sets.length === 0; });
  }
  function weightsChart(index, axis, u, figure) {
    const sets = tracked && flatWeights(tracked) ? sensorSets(tracked.weight_track, tracked.weights, false, "") : [];
    drawnIf(sets, figure, "does not weight the sensors by one number each.");
    return chart(sets, timeAxis(), linearAxis("weight", undefined, undefined), [dragging]);
  }
  function variancesChart(index, axis, u, figure) {
    const sets = tracked ? sensorSets(tracked.variance_track, tracked.variances, true, u) : [];
    drawnIf(sets, figure, "does not estimate variances.");
    if (sets.length) {
      drawnSensors(tracked.variances, true).forEach((i) => {
        const s = report.sensors[i];
        if (positive(s.rmse)) sets.push(Object.assign(flat("", s.rmse * s.rmse, { colour: faint(sensorStyle(i).colour, 0.55), dash: [1, 3] }), { order: 6, borderWidth: 1.3 }));
      });
    }
    return chart(sets, timeAxis(), logFor(axis + (u ? ", " + u : ""), sets, 1.3), [dragging]);
  }

  const MOST_ROWS = 24;
  // Above each known fault what it is and when it was found, beside each finding its name, where there is room.
  const faultNotes = {
    id: "faultNotes",
    afterDatasetsDraw(chart) {
      const pen = chart.ctx, area = chart.chartArea, rows = chart.scales.y.ticks.length, height = (area.bottom - area.top) / Math.max(1, rows);
      if (height < 26) return;
      pen.save();
      pen.font = "11px system-ui, 'DejaVu Sans', sans-serif";
      pen.textBaseline = "middle";
      pen.lineWidth = 3;
      pen.strokeStyle = colours().halo;
      pen.fillStyle = colours().ink;
      const taken = new Map();
      chart.data.datasets.forEach((set, index) => {
        chart.getDatasetMeta(index).data.forEach((bar, i) => {
          const text = set.data[i].note;
          if (!text) return;
          const level = Math.round(bar.y + set.above * height), width = pen.measureText(text).width;
          const x = Math.max(area.left + 2, Math.min(Math.min(bar.base, bar.x) + 3, area.right - width - 2));
          const there = taken.get(level) || [];
          if (there.some(([from, to]) => x < to + 8 && x + width > from - 8)) return;
          taken.set(level, there.concat([[x, x + width]]));
          pen.strokeText(text, x, level);
          pen.fillText(text, x, level);
        });
      });
      pen.restore();
    },
  };
  const seconds = (s) => (s < 1e-3 ? numberText(1e6 * s, 3) + " µs" : s < 1 ? numberText(1e3 * s, 3) + " ms" : s < 300 ? numberText(s, 3) + " s" : s < 18000 ? numberText(s / 60, 3) + " min" : numberText(s / 3600, 3) + " h");
  const valued = (f) => f.kind + (f.kind === "stuck" || f.kind === "dropout" ? "" : " " + numberText(f.value));
  function answerTo(index) {
    const answer = tracked && tracked.answers ? tracked.answers.find((a) => a.fault === index) : null;
    return !answer ? "" : answer.found_after_s === null ? "missed" : answer.found_after_s === 0 ? "found at once" : "found after " + seconds(answer.found_after_s);
  }
  // Only the sensors that have something to show, of a large array.
  function faultRows(bars) {
    const all = report.sensors.map((s, i) => String(i)), busy = new Set(bars.map((p) => p.y));
    return all.length <= MOST_ROWS ? all : all.filter((i) => busy.has(i)).slice(0, MOST_ROWS);
  }
  // libchar/fusion/fault_log.hpp: who leads, and why the lead changed.
  const LEADS = { network: "network", retrained: "network, retrained", past: "network of the past" };
  const ENDED = { right: "another leads", missing: "a sensor is missing", outside: "input is new to it", apart: "far from the baseline", inconsistent: "sensors disagree", no_gain: "no better than the baseline" };
  function faultsChart(index, axis, u, figure) {
    const end = whole[1], names = report.sensors.map((s) => s.name), c = colours();
    const bar = (f) => ({ x: [Math.max(f.from_s / TIME, whole[0]), Math.min(f.to_s === null ? end : f.to_s / TIME, end)], y: String(names.indexOf(f.sensor)), f });
    const span = (f) => numberText(f.from_s / TIME, 6) + " … " + (f.to_s === null ? "the end" : numberText(f.to_s / TIME, 6) + " " + timeUnit);
    const known = report.faults.map((f, i) => Object.assign(bar(f), { answer: answerTo(i) })).filter((p) => p.x[0] < p.x[1]);
    known.forEach((p) => { p.note = [valued(p.f), p.answer].filter(Boolean).join(", "); });
    const found = (tracked ? tracked.faults : []).map((f) => Object.assign(bar(f), { note: f.kind.replace("_", " ") }));
    const led = (tracked && tracked.leads ? tracked.leads : []).map((f) => Object.assign(bar(f), { y: String(names.length), note: (LEADS[f.lead] || f.lead) + (f.ended ? ", until " + (ENDED[f.ended] || f.ended) : "") }));
    const rows = faultRows(known.concat(found)).concat(led.length ? [String(names.length)] : []), drawn = (bars) => bars.filter((p) => rows.includes(p.y));
    figure.querySelector(".canvas").style.height = 90 + Math.max(120, rows.length * 44) + "px";
    const ink = (p) => sensorStyle(Number(p.y)).colour, plain = { grouped: false, minBarLength: 3, borderSkipped: false };
    const tip = (what) => (p) => [names[p.y] + ": " + what(p), span(p.f)];
    const bars = (label, data, more) => Object.assign({ label, data: drawn(data) }, plain, more);
    const out = found.filter((p) => p.f.kind !== "noise"), noisy = found.filter((p) => p.f.kind === "noise"), by = tracked ? tracked.label : "–";
    const sets = [
      bars("out, by " + by, out, { backgroundColor: drawn(out).map(ink), swatch: c.dim, barPercentage: 0.3, above: 0.3, order: 1, tip: tip((p) => "out, " + p.note) }),
      bars("re-weighted, by " + by, noisy, { backgroundColor: c.paper, borderColor: drawn(noisy).map(ink), borderWidth: 2, swatch: noisy.length ? c.border : "", barPercentage: 0.24, above: 0.3, order: 1, tip: tip(() => "noisier, less weight") }),
      bars("network leads", led, { backgroundColor: c.dim, swatch: led.length ? c.dim : "", barPercentage: 0.3, above: 0.3, order: 1, tip: (p) => ["leads: " + p.note, span(p.f)] }),
      bars("known to the scene", known, { backgroundColor: c.known, swatch: known.length ? c.known : "", barPercentage: 0.9, above: -0.3, order: 2, tip: tip((p) => p.note) }),
    ].filter((set) => set.swatch);
    const y = { type: "category", labels: rows, offset: true, ticks: { color: c.ink, autoSkip: false, callback: (v) => shortened(names[rows[v]] || "leads", chartWidth(figure)) }, grid: { color: c.fine, borderColor: c.border } };
    const all = options(timeAxis(), y), silent = known.length + found.length + led.length ? [] : [nothing("No fault is known, and none was found")];
    Object.assign(all, { parsing: true, normalized: false, indexAxis: "y" });
    all.plugins.legend = plainLegend();
    all.plugins.tooltip.callbacks.label = (item) => item.dataset.tip(item.raw);
    return { type: "bar", data: { labels: rows, datasets: sets }, plugins: [whitePaper, dragging, faultNotes].concat(silent), options: all };
  }

  // Of each known fault; where it was found in its first sample, half of one stands for no delay.
  function detectionChart(index, axis, u) {
    const names = report.sensors.map((s) => s.name), least = 0.5 / report.rate_hz;
    const sets = report.detection[0].answers.map((answer, k) => {
      const fault = report.faults[answer.fault], look = sensorStyle(names.indexOf(fault.sensor)), label = fault.sensor + ": " + valued(fault) + " from " + numberText(fault.from_s / TIME, 5) + " " + timeUnit;
      const data = report.detection.map((at) => ({ x: at.false_alarm_s, found: at.answers[k].found_after_s, alarms: at.alarms_without_fault })).filter((p) => p.found !== null).map((p) => Object.assign(p, { y: Math.max(p.found, least) }));
      return { label, data, borderColor: look.colour, backgroundColor: look.colour, borderDash: [[], [6, 4], [2, 3]][k % 3], pointStyle: MARKS[k % MARKS.length], pointRadius: 4, pointHoverRadius: 6, borderWidth: 1.7, fill: false, order: 2, tip: (p) => [label, p.found === 0 ? "found at once" : "found after " + seconds(p.found), "one false alarm in " + seconds(p.x), p.alarms + " raised where no fault is known"] };
    }).filter((set) => set.data.length);
    const points = sets.flatMap((set) => set.data), [yMin, yMax] = padded(points.map((p) => p.y), 2);
    const asked = report.detection.map((at) => at.false_alarm_s), [xMin, xMax] = padded(asked, 1.4);
    return chart(sets, logAxis("one false alarm of the array in, s", xMin, xMax), valueAxis(withUnit(axis, u), yMin, yMax));
  }

  // ---- Allan deviation of the errors ----
  function allanChart(input, axis, u) {
    const sets = [];
    order.filter((a) => shown.has(a)).forEach((a) => {
      const curve = a.inputs[input] && a.inputs[input].allan;
      if (!curve) return;
      const k = rankOf(a), look = methodStyle(k), data = [];
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
    const inks = (points) => points.map((p) => sensorStyle(p.x).colour), c = colours();
    const sets = [
      { label: "sensor", data: measured, showLine: false, marks: true, intervals: "upright", borderColor: c.dim, pointBorderColor: inks(measured), pointBackgroundColor: inks(measured), pointRadius: 5, pointHoverRadius: 7, fill: false, order: 1, tip },
      { label: "noise it was said to have", data: told, showLine: false, marks: true, borderColor: c.dim, pointBorderColor: inks(told), pointBackgroundColor: c.paper, backgroundColor: c.paper, pointStyle: "rectRot", pointRadius: 6, pointBorderWidth: 1.6, fill: false, order: 2, tip },
    ].filter((set) => set.data.length);
    const level = (name, y, look) => sets.push(Object.assign(flat(name, y, look, () => [name, "RMSE " + numberText(y, 5) + " " + u]), { data: [{ x: -0.5, y }, { x: last, y }], order: 5 }));
    if (report.inputs.length === 1 && report.inputs[0].unit === all[0].unit && report.score === "rmse") {
      if (best && positive(best.rmse)) level("fused by " + best.label, best.rmse, styleOf(best));
      if (plain && plain !== best && positive(plain.rmse)) level("fused by mean", plain.rmse, styleOf(plain));
    }
    const [yMin, yMax] = padded(sets.flatMap((set) => set.data.map((p) => p.y)).concat(low, high), 1.2);
    const x = linearAxis("sensor", -0.5, last);
    x.ticks = { color: colours().ink, autoSkip: true, maxRotation: 60, callback: (v) => (all[v] ? shortened(all[v].name) : "") };
    x.afterBuildTicks = (a) => { a.ticks = all.map((s, i) => ({ value: i })); };
    return chart(sets, x, valueAxis(withUnit(axis, u), yMin, yMax), [intervalBars]);
  }
  // Names beside an axis leave most of a small screen to the plot.
  const chartWidth = (figure) => figure.querySelector(".canvas").clientWidth || 690;
  const shortened = (name, width, most) => {
    const room = Math.min(most || 18, Math.max(8, Math.floor((width || 690) / 24)));
    return name.length > room ? name.slice(0, room - 1) + "…" : name;
  };
  // Lines from end to end of a point's 95 % interval, upright or level.
  const intervalBars = {
    id: "intervalBars",
    beforeDatasetsDraw(chart) {
      const pen = chart.ctx, { x, y } = chart.scales;
      chart.data.datasets.forEach((set, index) => {
        if (!set.intervals) return;
        const upright = set.intervals === "upright", inks = set.pointBorderColor;
        pen.save();
        pen.lineWidth = 1.8;
        chart.getDatasetMeta(index).data.forEach((mark, i) => {
          const pair = set.data[i].ci || (set.data[i].s && set.data[i].s.rmse_ci95);
          if (!pair || !positive(pair[0])) return;
          pen.strokeStyle = Array.isArray(inks) ? inks[i] : set.borderColor;
          const ends = pair.map((v) => (upright ? y.getPixelForValue(v) : Math.min(x.getPixelForValue(v), chart.chartArea.right)));
          const to = (along, across) => (upright ? [mark.x + across, along] : [along, mark.y + across]);
          pen.beginPath();
          ends.forEach((v) => { pen.moveTo(...to(v, -4)); pen.lineTo(...to(v, 4)); });
          pen.moveTo(...to(ends[0], 0));
          pen.lineTo(...to(ends[1], 0));
          pen.stroke();
        });
        pen.restore();
      });
    },
  };

  // ---- the run: reference, best method, best single sensor ----
  const run = report.run;
  const trackOf = (part, one) => (one ? { time_s: part.time_s, low: one.low || one.value, high: one.high || one.value } : null);
  // Where the stretch is within a close-up, every instant is known.
  const partInView = () => run.close_ups.find((c) => c.from_s / TIME <= stretch[0] + 1e-9 * whole[1] && c.to_s / TIME >= stretch[1] - 1e-9 * whole[1]) || run;
  // Faults in the colour of their sensor, what is not scored in grey.
  function runChart(sets, y, figure) {
    const beside = timeMarks(report.marks.map((m) => {
      const ink = m.sensor === null ? colours().dim : sensorStyle(named(m.sensor)).colour;
      return { from: m.from_s / TIME, to: m.to_s / TIME, label: m.label, ink, shade: m.sensor === null ? colours().outside : rgba(ink, m.kind === "fault" ? 0.16 : 0.08) };
    }), stretch[0], stretch[1]), all = chart(sets, timeAxis(), y, [beside.plugin, dragging]);
    figure.style.setProperty("--marks", 13 * beside.rows(figure.clientWidth || 690) + "px");
    all.options.layout = { padding: beside.padding };
    return all;
  }
  // From the smallest to the largest value within the stretch.
  function reach(track, series) {
    if (!track) return [Infinity, -Infinity];
    const [from, to] = window_of(track.time_s);
    let low = Infinity, high = -Infinity;
    for (let i = from; i < to; ++i) {
      if (track.low[series][i] !== null) low = Math.min(low, track.low[series][i]);
      if (track.high[series][i] !== null) high = Math.max(high, track.high[series][i]);
    }
    return [low, high];
  }
  // As tall as `tracks` need, and for `guests` up to `cap` times that: one that failed may not flatten what counts.
  function linearFor(title, tracks, guests, cap) {
    const join = ([a, b], [c, d]) => [Math.min(a, c), Math.max(b, d)], empty = [Infinity, -Infinity];
    let [low, high] = tracks.map((t) => reach(t, 0)).reduce(join, empty);
    if (!(low <= high)) [low, high] = [-1, 1];
    const height = high - low || Math.abs(high) || 1, [least, most] = guests.map((t) => reach(t, 0)).reduce(join, empty);
    low = Math.max(Math.min(low, least), low - cap * height);
    high = Math.min(Math.max(high, most), high + cap * height);
    const rough = 1.17 * (high - low || height), step = roundStep(rough / 5);
    const axis = linearAxis(title, step * Math.floor((low - 0.05 * rough) / step), step * Math.ceil((high + 0.12 * rough) / step));
    axis.ticks.stepSize = step;
    return axis;
  }
  // A stretch of many samples has no middle worth a line: its smallest and largest values are, the first of `parts` on top.
  function runSets(parts, u) {
    return parts.filter(([, track]) => track).flatMap(([name, track, look], order) => {
      const sets = bandLine(name, track, 0, look, false, timeTip(u)), single = sets[0].data.every((p) => p.low === p.high || isNaN(p.low));
      sets[1].backgroundColor = rgba(look.colour, 0.13);
      sets[0].showLine = single;
      if (!single) sets.slice(1).forEach((set) => Object.assign(set, { borderColor: look.colour, borderDash: look.dash, borderWidth: order ? 1.1 : 1.6 }));
      return sets.map((set) => Object.assign(set, { order: set.quiet ? 10 + order : order }));
    });
  }
  const sensorLook = () => Object.assign(sensorStyle(named(run.sensor)), { dash: [] });
  const methodLook = () => Object.assign(styleOf(labelled.get(run.method)), { dash: [] });
  function signalChart(input, axis, u, figure) {
    const part = partInView(), one = part.inputs[input], reference = trackOf(part, one.reference), estimate = trackOf(part, one.estimate), sensor = input === 0 ? trackOf(part, part.sensor_value) : null;
    const sets = runSets([
      ["fused by " + run.method, estimate, methodLook()],
      ["reference", reference, { colour: colours().ink, dash: [4, 3] }],
      [run.sensor + ", the best single sensor", sensor, sensor ? sensorLook() : null],
    ], u);
    return runChart(sets, linearFor(withUnit(axis, u), [reference, estimate], [sensor], 0.5), figure);
  }
  function errorChart(input, axis, u, figure) {
    const part = partInView(), error = trackOf(part, part.inputs[input].error), sensor = input === 0 ? trackOf(part, part.sensor_error) : null;
    const sets = runSets([
      ["error of " + run.method, error, methodLook()],
      ["error of " + run.sensor, sensor, sensor ? sensorLook() : null],
    ], u);
    return runChart(sets, linearFor(withUnit(axis, u), [error], [sensor], 2), figure);
  }
  function deviationsChart(index, axis, u, figure) {
    const part = partInView(), track = trackOf(part.deviations, part.deviations), sets = [];
    drawnSensors(null, false).forEach((i) => sets.push(...bandLine(report.sensors[i].name, track, i, sensorStyle(i), false, timeTip(u))));
    return runChart(sets, linearAxis(withUnit(axis, u), undefined, undefined), figure);
  }

  // ---- the ranking ----
  const ROW = 23, FARTHEST = 30;
  // A long name in two lines, where there is no room for one.
  function inTwo(name) {
    const middle = name.length / 2, cuts = Array.from(name.matchAll(/-/g), (m) => m.index).sort((a, b) => Math.abs(a - middle) - Math.abs(b - middle));
    return name.length < 16 || !cuts.length ? shortened(name, 690, 17) : [name.slice(0, cuts[0] + 1), name.slice(cuts[0] + 1)].map((half) => shortened(half, 690, 17));
  }
  // Rows of those that are as good as the best.
  const equals = {
    id: "equals",
    beforeDatasetsDraw(chart) {
      const pen = chart.ctx, area = chart.chartArea, y = chart.scales.y, half = Math.abs(y.getPixelForValue(1) - y.getPixelForValue(0)) / 2;
      pen.save();
      pen.fillStyle = colours().shade;
      chart.data.datasets[0].data.forEach((p) => { if (p.equal) pen.fillRect(area.left, y.getPixelForValue(p.y) - half, area.right - area.left, 2 * half); });
      pen.restore();
    },
    // What is beyond the sheet stands at its edge, with its number.
    afterDatasetsDraw(chart) {
      const pen = chart.ctx;
      pen.save();
      pen.font = "11px system-ui, 'DejaVu Sans', sans-serif";
      pen.textBaseline = "middle";
      pen.textAlign = "right";
      pen.fillStyle = colours().ink;
      chart.getDatasetMeta(0).data.forEach((mark, i) => {
        const p = chart.data.datasets[0].data[i];
        if (p.beyond) pen.fillText(numberText(score(p.a), 3), mark.x - 10, mark.y);
      });
      pen.restore();
    },
  };
  const intervalOf = (a) => (report.score === "rmse" ? a.rmse_ci95 : a.without_reference && a.without_reference.predictive_ci95);
  function rankingChart(index, axis, u, figure) {
    const c = colours(), scored = order.filter((a) => positive(score(a))), rows = scored.filter((a) => !a.bound).concat(scored.filter((a) => a.bound));
    const narrow = chartWidth(figure) < 560;
    figure.querySelector(".canvas").style.height = 96 + (narrow ? 1.3 : 1) * ROW * rows.length + "px";
    const least = minMax(rows.map(score))[0], sensor = report.sensors.find((s) => s.name === report.best_sensor), optimum = report.score === "rmse" && report.inputs.length === 1 ? optimumOf(0) : null;
    const data = rows.map((a, y) => {
      const beyond = score(a) > FARTHEST * least, ci = intervalOf(a);
      return { x: Math.min(score(a), FARTHEST * least), y, a, beyond, ci: beyond ? null : ci, equal: !a.bound && (a.as_good_as_best || a.label === report.best) };
    });
    const values = data.flatMap((p) => [p.x].concat(p.ci || [])).concat(optimum, sensor ? sensor.rmse : null), [low, high] = padded(values, 1);
    const room = Math.max(1.01, Math.pow(high / low, 0.05)), inks = data.map((p) => (p.a.label === report.best ? styleOf(p.a).colour : p.a.bound ? c.dim : c.ink));
    const tip = (p) => [p.a.label, scoreName + " " + numberText(score(p.a), 5) + " " + u].concat(p.ci ? ["95 %: " + numberText(p.ci[0], 5) + " … " + numberText(p.ci[1], 5)] : [], p.a.regret === null ? [] : [numberText(1 + p.a.regret, 5) + " × best possible"], p.a.ratio_to_best_ci95 ? ["× best method: " + numberText(p.a.ratio_to_best_ci95[0], 5) + " … " + numberText(p.a.ratio_to_best_ci95[1], 5)] : []);
    const upright = (label, x, colour, dash) => (positive(x) ? [{ label, data: [{ x, y: -0.5 }, { x, y: rows.length - 0.5 }], borderColor: colour, backgroundColor: colour, borderDash: dash, borderWidth: 1.6, pointRadius: 0, pointHitRadius: 4, fill: false, order: 5, tip: () => [label, numberText(x, 5) + " " + u] }] : []);
    const sets = [{
      label: "", data, showLine: false, intervals: "level", borderColor: c.ink, pointBorderColor: inks, pointBackgroundColor: data.map((p, i) => (p.a.bound ? c.paper : inks[i])),
      pointStyle: data.map((p) => (p.beyond ? "triangle" : "circle")), pointRotation: data.map((p) => (p.beyond ? 90 : 0)), pointRadius: data.map((p) => (p.a.label === report.best ? 6.5 : 4.5)), pointBorderWidth: 1.8, pointHoverRadius: 7, fill: false, order: 1, tip,
    }].concat(upright("best possible: optimum of this scene", optimum, c.ink, [1, 4]), sensor ? upright("best single sensor: " + sensor.name, sensor.rmse, sensorStyle(named(sensor.name)).colour, [6, 4]) : [],
      [{ label: "as good as the best", data: [], swatch: c.shade }]);
    const y = linearAxis("", -0.5, rows.length - 0.5);
    y.reverse = true;
    y.ticks = { color: c.ink, autoSkip: false, font: { size: narrow ? 11 : 12 }, callback: (v) => (rows[v] ? (narrow ? inTwo(rows[v].label) : shortened(rows[v].label, 690, 28)) : "") };
    y.afterBuildTicks = (a) => { a.ticks = rows.map((row, i) => ({ value: i })); };
    y.grid = { color: c.fine, borderColor: c.border };
    const config = chart(sets, valueAxis(withUnit(axis, u), low / room, high * room), y, [equals, intervalBars]);
    config.options.interaction = { mode: "nearest", axis: "xy", intersect: false };
    return config;
  }

  // ---- dragging out a stretch ----
  let drag = null;
  const dragging = {
    id: "dragging",
    afterDraw(chart) {
      if (!drag || drag.chart !== chart) return;
      const pen = chart.ctx, area = chart.chartArea;
      pen.save();
      pen.fillStyle = colours().grip;
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
    "cost-time": (i, axis, u) => costChart("ns_per_sample", "time", "run time, ns per sample (one core)", withUnit(axis, u), (x) => numberText(x, 3) + " ns per sample"),
    "cost-memory": (i, axis, u) => costChart("peak_bytes", "memory", "peak memory, bytes", withUnit(axis, u), onMemory),
    signal: signalChart, error: errorChart, deviations: deviationsChart, ranking: rankingChart,
    window: windowChart, weights: weightsChart, variances: variancesChart, faults: faultsChart, detection: detectionChart, "error-allan": allanChart, sensors: sensorsChart,
  };
  const HEIGHTS = { sensors: 220, "cost-time": 340, "cost-memory": 340, signal: 230, error: 200, deviations: 230 };
  const onPaperHeight = (kind, figure) => HEIGHTS[kind] || (kind === "ranking" || kind === "faults" ? parseInt(figure.querySelector(".canvas").style.height, 10) : 300);
  const { figures, charts } = start(MAKERS, onPaperHeight, "details:not([open])");

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
        const fresh = MAKERS[figure.dataset.kind](Number(figure.dataset.channel), figure.dataset.axis, figure.dataset.unit, figure);
        drawn.destroy();
        charts.set(figure, new Chart(figure.querySelector("canvas"), fresh));
      });
      stale.clear();
    });
  }

  const OVER_TIME = ["signal", "error", "deviations", "window", "weights", "variances", "faults"], OF_TRACKED = ["weights", "variances", "faults"], OF_SHOWN = ["window", "error-allan"];
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

  const moved = [];
  function look(to) {
    // Some thousand samples at least make a stretch worth looking at; an empty one is none.
    stretch = to[1] - to[0] > (whole[1] - whole[0]) * 1e-5 ? to : whole.slice();
    moved.forEach((follow) => follow());
    redraw(OVER_TIME);
  }
  const withLabel = (text, control) => { const l = element("label", text + " "); l.append(control); return l; };
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
    const follow = () => {
      from.value = Math.round((steps * (stretch[0] - whole[0])) / length);
      to.value = Math.round((steps * (stretch[1] - whole[0])) / length);
      said.textContent = numberText(stretch[0], 6) + " … " + numberText(stretch[1], 6) + " " + timeUnit;
    };
    follow();
    moved.push(follow);
    bar.append(withLabel("From", from), withLabel("to", to), said, button("whole run", () => look(whole.slice())));
    if (place.closest("#run")) run.close_ups.forEach((c) => bar.append(Object.assign(button(c.label, () => look([c.from_s / TIME, c.to_s / TIME])), { title: "every instant from " + numberText(c.from_s / TIME, 6) + " " + timeUnit + " on", className: "closer" })));
    place.append(bar);
  }
  // Whose weights, variances and findings; every such choice on the page is the same one.
  const choices = [];
  function methodChoice(place) {
    if (!trackable.length) return;
    const choice = element("select"), bar = element("div");
    bar.className = "choice";
    trackable.forEach((a, i) => { const o = element("option", a.label); o.value = i; o.selected = a === tracked; choice.append(o); });
    choice.addEventListener("change", () => {
      tracked = trackable[Number(choice.value)];
      choices.forEach((other) => { other.value = choice.value; });
      redraw(OF_TRACKED);
    });
    choices.push(choice);
    bar.append(withLabel("Findings, weights and variances of", choice));
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
  const shownPlace = document.getElementById("shown-place");
  if (shownPlace) algorithmBoxes(shownPlace);
  document.querySelectorAll(".stretch-place").forEach(stretchControls);
  document.querySelectorAll(".choice-place").forEach(methodChoice);
  // ---- numbers to take along ----
  const cellOf = (v) => (v === null || v === undefined ? "" : typeof v === "number" ? String(v) : /[",\n\r]/.test(v) ? '"' + v.replace(/"/g, '""') + '"' : v);
  const csv = (rows) => rows.map((row) => row.map(cellOf).join(",") + "\n").join("");
  // A string of JSON is one of YAML.
  const key = (name) => (/^[A-Za-z_][A-Za-z0-9_.-]*$/.test(name) && !/^(true|false|null|yes|no|on|off|y|n)$/i.test(name) ? name : JSON.stringify(name));
  const yamlNumber = (v) => (v === null || v === undefined ? "null" : String(v));
  // [algorithm, what, a number a sensor]
  function weightRows() {
    return order.flatMap((a) => {
      const out = [], inputs = report.inputs.map((input) => input.name);
      if (flatWeights(a)) out.push([a.label, "weights", a.weights]);
      else if (a.weights && a.weights.length) a.weights[0].forEach((first, j) => out.push([a.label, "weights of " + (inputs[j] || j + 1), a.weights.map((row) => row[j])]));
      if (a.variances) out.push([a.label, "variances", a.variances]);
      return out;
    });
  }
  const sensorNames = report.sensors.map((s) => s.name);
  const COPIES = {
    weights: {
      CSV: () => csv([["algorithm", "what"].concat(sensorNames)].concat(weightRows().map(([label, what, values]) => [label, what].concat(values)))),
      YAML: () => {
        let out = "", last = null;
        weightRows().forEach(([label, what, values]) => {
          if (label !== last) out += key(label) + ":\n";
          last = label;
          out += "  " + key(what) + ":\n" + values.map((v, i) => "    " + key(sensorNames[i]) + ": " + yamlNumber(v) + "\n").join("");
        });
        return out;
      },
    },
    alignment: {
      CSV: () => {
        const terms = ["delay_s", "bias", "gain"], crosses = Math.max(0, ...report.alignment.sensors.map((s) => s.cross.length)), all = terms.concat(Array.from({ length: crosses }, (none, k) => "cross_" + (k + 1)));
        const of = (s, term) => (term.startsWith("cross_") ? s.cross[Number(term.slice(6)) - 1] : s[term]) || { value: null, standard_error: null };
        return csv([["sensor"].concat(all.flatMap((t) => [t, t + "_standard_error"]))].concat(report.alignment.sensors.map((s) => [s.sensor].concat(all.flatMap((t) => [of(s, t).value, of(s, t).standard_error])))));
      },
      YAML: () => report.alignment.sensors.map((s) => key(s.sensor) + ": {delay_s: " + yamlNumber(s.delay_s.value) + ", bias: " + yamlNumber(s.bias.value) + ", gain: " + yamlNumber(s.gain.value) + ", cross: [" + s.cross.map((c) => yamlNumber(c.value)).join(", ") + "]}\n").join(""),
    },
  };
  // Pages that were opened from a file may have no clipboard of their own: then by a selected text, and if that is refused too, the
  // text stays there to be copied by hand.
  function copy(text, said) {
    const done = () => { said.textContent = "copied"; setTimeout(() => { said.textContent = ""; }, 2500); };
    const byHand = () => {
      const area = element("textarea");
      area.value = text;
      area.readOnly = true;
      area.rows = 8;
      said.after(area);
      area.select();
      let worked = false;
      try { worked = document.execCommand("copy"); } catch (refused) { worked = false; }
      if (worked) { area.remove(); done(); } else said.textContent = "press Ctrl+C";
    };
    if (navigator.clipboard && window.isSecureContext) navigator.clipboard.writeText(text).then(done, byHand);
    else byHand();
  }
  document.querySelectorAll(".copy-place").forEach((place) => {
    const kinds = COPIES[place.dataset.copy], said = element("output");
    Object.keys(kinds).forEach((kind) => place.append(button("Copy as " + kind, () => copy(kinds[kind](), said))));
    place.append(said);
  });

  // What seldom decides is folded away; without this script every column is there.
  document.querySelectorAll("table.ranking").forEach((table) => {
    if (!table.querySelector(".more")) return;
    const more = button("All columns", () => { more.textContent = table.classList.toggle("few") ? "All columns" : "Fewer columns"; });
    table.classList.add("few");
    more.className = "more-columns";
    table.parentElement.before(more);
  });
  figures.filter((f) => OVER_TIME.includes(f.dataset.kind)).forEach((f) => makeDraggable(f.querySelector("canvas")));
})();
