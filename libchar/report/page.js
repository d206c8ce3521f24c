// Draws the plots of a characterization from the JSON in the page, when they come into view (page_common.js).
(function () {
  "use strict";

  const { report, colours, numberText, positive, padded, linearRange, logAxis, whitePaper, options, timeMarks, start } = reportPage;
  // Told apart by dash as well as by colour, for print.
  const TERMS = {
    white_noise: { name: "white noise N", series: 2, dash: [9, 4], mark: "rectRot" },
    bias_instability: { name: "bias instability B", series: 3, dash: [2, 3], mark: "triangle" },
    random_walk: { name: "random walk K", series: 4, dash: [11, 3, 2, 3], mark: "rect" },
    quantization: { name: "quantization Q", series: 5, dash: [5, 2, 1, 2, 1, 2], mark: "star" },
    rate_ramp: { name: "rate ramp R", series: 6, dash: [16, 5], mark: "crossRot" },
  };
  const termColour = (key) => colours().series[TERMS[key].series];
  const ROUND = ["circle", "rect", "triangle", "rectRot", "star", "crossRot"];
  const withUnit = (text, unit) => (unit ? text + ", " + unit : text);

  // ---- axes ----
  // Extremes of the measured values and, up to a factor beyond them, of what is drawn with them: a fitted line or an interval may
  // not leave the sheet, nor press the measurement into a corner.
  function framed(measured, others, factor) {
    const good = measured.filter(positive);
    if (!good.length) return others;
    const low = Math.min(...good), high = Math.max(...good);
    return good.concat(others.filter(positive).map((v) => Math.max(low / factor, Math.min(high * factor, v))));
  }

  // ---- data sets ----
  function band(name, x, intervals, colour) {
    const low = [], high = [];
    x.forEach((value, i) => {
      const pair = intervals[i];
      if (!positive(value) || !pair || !positive(pair[0]) || !positive(pair[1])) return;
      low.push({ x: value, y: pair[0] });
      high.push({ x: value, y: pair[1] });
    });
    const plain = { borderWidth: 0, pointRadius: 0, pointHitRadius: 0, order: 9 };
    return [
      Object.assign({ label: name, data: high, backgroundColor: colour, fill: "+1", swatch: colour }, plain),
      Object.assign({ label: "", data: low, fill: false, backgroundColor: "transparent" }, plain),
    ];
  }
  function points(x, y) {
    const out = [];
    x.forEach((value, i) => { if (positive(value) && positive(y[i])) out.push({ x: value, y: y[i], i }); });
    return out;
  }
  function asymptotes(all) {
    return Object.keys(all || {}).filter((key) => TERMS[key]).map((key) => ({
      label: TERMS[key].name, data: all[key].map(([x, y]) => ({ x, y })),
      borderColor: termColour(key), borderDash: TERMS[key].dash, borderWidth: 1.6, pointRadius: 0, pointHitRadius: 0, fill: false, order: 4,
    }));
  }

  // Names the read-off points beside their marks, on a white halo so that curves behind do not hide them.
  const readOffLabels = {
    id: "readOffLabels",
    afterDatasetsDraw(chart) {
      const pen = chart.ctx, area = chart.chartArea;
      chart.data.datasets.forEach((set, index) => {
        if (!set.readOff || !chart.isDatasetVisible(index)) return;
        chart.getDatasetMeta(index).data.forEach((mark, i) => {
          if (mark.x < area.left || mark.x > area.right || mark.y < area.top || mark.y > area.bottom) return;
          const text = set.data[i].label, right = mark.x + 90 < area.right;
          pen.save();
          pen.font = "600 12px system-ui, 'DejaVu Sans', sans-serif";
          pen.textAlign = right ? "left" : "right";
          pen.lineWidth = 4;
          pen.strokeStyle = colours().halo;
          pen.fillStyle = set.borderColor;
          const x = mark.x + (right ? 9 : -9), y = mark.y - 9;
          pen.strokeText(text, x, y);
          pen.fillText(text, x, y);
          pen.restore();
        });
      });
    },
  };
  // The record that was simulated from the model, drawn over the recording.
  function simulated(index, curve) {
    const all = report.verification && report.verification.channels[index];
    if (!all) return [];
    const x = curve === "allan" ? all.allan.tau_s : all.spectrum.frequency_hz, y = curve === "allan" ? all.allan.deviation : all.spectrum.value;
    const style = curve === "allan" ? { showLine: false, pointStyle: "triangle", pointRadius: 4.5, marks: true, pointBorderColor: colours().simulated, pointBackgroundColor: "transparent", borderWidth: 1.8 } : { pointRadius: 0, borderWidth: 1.2 };
    return [Object.assign({ label: "simulated from the model", data: points(x, y), borderColor: colours().simulated, pointHitRadius: 0, fill: false, order: 3 }, style)];
  }

  // What lies outside the band of the fit: no coefficient comes from there.
  const outside = (stretches, words, strength) => ({
    id: "outside",
    beforeDatasetsDraw(chart) {
      const pen = chart.ctx, area = chart.chartArea, x = chart.scales.x;
      stretches.forEach(([from, to], order) => {
        const left = Math.max(area.left, from > 0 ? x.getPixelForValue(from) : area.left), right = Math.min(area.right, to < Infinity ? x.getPixelForValue(to) : area.right);
        if (!(right - left > 1)) return;
        pen.save();
        pen.globalAlpha = Math.min(1, 2 * (strength || 1));
        pen.fillStyle = colours().outside;
        pen.fillRect(left, area.top, right - left, area.bottom - area.top);
        pen.globalAlpha = 1;
        if (words && order === 0 && right - left > 90) {
          pen.fillStyle = colours().dim;
          pen.font = "11px system-ui, 'DejaVu Sans', sans-serif";
          pen.textAlign = "left";
          pen.textBaseline = "bottom";
          pen.fillText(words, left + 6, area.bottom - 4);
        }
        pen.restore();
      });
    },
  });
  const plainFrom = (index) => { const f = report.fit.channels[index]; return f.derived ? f.derived.plain_from_s || 0 : 0; };
  function bandOf(index) {
    const band = report.fit.channels[index].band;
    if (!band) return [];
    return (band.left_out_hz || []).map((pair) => [pair[0], pair[1]]).concat(band.whole || !(band.top_hz > 0) ? [] : [[band.top_hz, Infinity]]);
  }

  // What a sensor at the limits of its data sheet would show.
  const dataSheet = (a, label) => (a.data_sheet ? [{ label, data: points(a.tau_s, a.data_sheet), borderColor: colours().ink, borderDash: [12, 4], borderWidth: 1.6, pointRadius: 0, pointHitRadius: 0, fill: false, order: 4 }] : []);

  // ---- the plots ----
  function allanChart(index, axis, unit) {
    const a = report.allan.channels[index], f = report.fit.channels[index], c = colours();
    const marks = f.derived ? f.derived.read_off_points : [];
    const measured = points(a.tau_s, a.deviation);
    const tip = (p) => {
      const out = ["τ = " + numberText(p.x) + " s", "measured " + numberText(p.y, 5) + (unit ? " " + unit : "")];
      if (a.ci95[p.i]) out.push("95 %: " + numberText(a.ci95[p.i][0]) + " … " + numberText(a.ci95[p.i][1]), "68 %: " + numberText(a.ci68[p.i][0]) + " … " + numberText(a.ci68[p.i][1]));
      if (a.edf[p.i] !== null) out.push(numberText(a.edf[p.i]) + " degrees of freedom, " + a.terms[p.i] + " terms");
      if (a.model && a.model[p.i] !== null) out.push("model " + numberText(a.model[p.i], 5) + " " + unit);
      if (!a.reliable[p.i]) out.push("unreliable: fewer than 5 degrees of freedom");
      return out;
    };
    const sets = [];
    if (measured.length) {
      const hollow = measured.map((p) => !a.reliable[p.i]);
      sets.push({
        label: "measured", data: measured, borderColor: c.measured, showLine: false, borderWidth: 1.6, marks: true, tip, order: 2,
        pointRadius: measured.length > 60 ? 2 : 3.5, pointHoverRadius: 6, pointBorderColor: c.measured, pointBackgroundColor: hollow.map((h) => (h ? c.paper : c.measured)), fill: false,
      });
    }
    if (a.model) sets.push({ label: "fitted model", data: points(a.tau_s, a.model), borderColor: c.model, cubicInterpolationMode: "monotone", borderWidth: 2.2, pointRadius: 0, pointHitRadius: 0, fill: false, order: 3 });
    sets.push(...dataSheet(a, "data sheet"), ...simulated(index, "allan"), ...asymptotes(a.asymptotes));
    marks.filter((m) => positive(m.tau_s) && positive(m.deviation)).forEach((m) => {
      const style = TERMS[m.term];
      sets.push({
        label: "", readOff: true, marks: true, data: [{ x: m.tau_s, y: m.deviation, label: m.label }], borderColor: termColour(m.term), showLine: false,
        backgroundColor: c.paper, pointStyle: style.mark, pointRadius: 7, pointHoverRadius: 9, pointBorderWidth: 2.2, order: 1, fill: false,
        tip: () => [m.label, numberText(m.deviation, 5) + " " + unit],
      });
    });
    sets.push(...band("68 % interval", a.tau_s, a.ci68, c.band68), ...band("95 % interval", a.tau_s, a.ci95, c.band95));
    // A mark far below the curve (a K that a short record hardly shows) would press everything else together.
    const near = marks.filter((m) => m.deviation > Math.min(...measured.map((p) => p.y)) / 30);
    const [xMin, xMax] = padded(measured.map((p) => p.x).concat(marks.map((m) => m.tau_s)), 1.4);
    const intervals = framed(measured.map((p) => p.y), a.ci95.flatMap((pair) => pair || []), 3);
    const drawn = framed(intervals, measured.map((p) => (a.model ? a.model[p.i] : null)), 30);
    const [yMin, yMax] = padded(drawn.concat(near.map((m) => m.deviation)), 1.8);
    return {
      type: "line", data: { datasets: sets }, plugins: [readOffLabels, outside([[0, plainFrom(index)]], "shape"), whitePaper],
      options: options(logAxis("averaging time τ, s", xMin, xMax), logAxis(withUnit(axis, unit), yMin, yMax)),
    };
  }

  function spectrumChart(index, axis, unit) {
    const s = report.spectrum.channels[index], c = colours();
    const measured = points(s.frequency_hz, s.value);
    const tip = (p) => {
      const out = ["f = " + numberText(p.x, 5) + " Hz", "measured " + numberText(p.y, 4) + " " + unit];
      if (s.ci95[p.i]) out.push("95 %: " + numberText(s.ci95[p.i][0], 3) + " … " + numberText(s.ci95[p.i][1], 3));
      if (s.model && s.model[p.i] !== null) out.push("model " + numberText(s.model[p.i], 4) + " " + unit);
      if (s.dof[p.i]) out.push(numberText(s.dof[p.i], 3) + " degrees of freedom");
      return out;
    };
    const sets = [{ label: "measured", data: measured, borderColor: c.measured, borderWidth: 1.3, pointRadius: 0, pointHoverRadius: 5, pointHitRadius: 5, tip, fill: false, order: 2 }];
    if (s.model) sets.push({ label: "fitted model", data: points(s.frequency_hz, s.model), borderColor: c.model, borderWidth: 2.2, pointRadius: 0, pointHitRadius: 0, fill: false, order: 1 });
    sets.push(...simulated(index, "spectrum"), ...asymptotes(s.asymptotes), ...band("95 % interval", s.frequency_hz, s.ci95, c.band95));
    const [xMin, xMax] = padded(measured.map((p) => p.x), 1.3);
    const [yMin, yMax] = padded(framed(measured.map((p) => p.y), measured.map((p) => (s.model ? s.model[p.i] : null)), 100), 2);
    return {
      type: "line", data: { datasets: sets }, plugins: [outside(bandOf(index), "left out"), whitePaper],
      options: options(logAxis("frequency, Hz", xMin, xMax), logAxis(withUnit(axis, unit), yMin, yMax)),
    };
  }

  // Says in a corner how many points stand on the edge because they lie beyond it.
  const beyondNote = {
    id: "beyondNote",
    afterDatasetsDraw(chart) {
      const set = chart.data.datasets.find((d) => d.note);
      if (!set) return;
      const pen = chart.ctx;
      pen.save();
      pen.font = "600 12px system-ui, 'DejaVu Sans', sans-serif";
      pen.fillStyle = set.borderColor;
      pen.fillText(set.note, chart.chartArea.left + 8, chart.chartArea.top + 14);
      pen.restore();
    },
  };

  function residualChart(index) {
    const r = report.fit.channels[index].residuals, c = colours();
    // Scaled to the data; one wild bin may not flatten the rest: it is drawn on the edge, as a triangle.
    const LARGEST = 20;
    const fitted = (i) => r.z[i] !== null && !(r.inside && r.inside[i] === false);
    const all_z = r.z.filter((z, i) => fitted(i)).map(Math.abs);
    const top = Math.min(LARGEST, Math.max(4, Math.ceil(1.05 * Math.max(0, ...all_z))));
    const dots = [], beyond = [];
    r.frequency_hz.forEach((x, i) => {
      if (!positive(x) || !fitted(i)) return;
      const inside = Math.abs(r.z[i]) <= top;
      (inside ? dots : beyond).push({ x, y: inside ? r.z[i] : Math.sign(r.z[i]) * 0.96 * top, i });
    });
    const [xMin, xMax] = padded(dots.concat(beyond).map((p) => p.x), 1.3);
    const tip = (p) => [numberText(p.x, 4) + (report.fit.channels[index].of_curve ? " s" : " Hz"), "residual " + numberText(r.z[p.i], 3) + " sd", numberText(r.dof[p.i], 3) + " degrees of freedom"];
    const flat = (y) => [{ x: xMin, y }, { x: xMax, y }];
    const plain = { borderWidth: 0, pointRadius: 0, pointHitRadius: 0, order: 9 };
    const sets = [
      { label: "residual", data: dots, showLine: false, borderColor: c.measured, backgroundColor: c.measured, pointRadius: 2.4, pointHoverRadius: 5, marks: true, tip, order: 1, fill: false },
      {
        label: "", data: beyond, showLine: false, borderColor: c.model, backgroundColor: c.model, pointStyle: "triangle", pointRadius: 5, pointHoverRadius: 7, marks: true, tip, order: 0, fill: false,
        pointRotation: beyond.map((p) => (p.y > 0 ? 0 : 180)), note: beyond.length ? beyond.length + " beyond ±" + top + ", up to " + numberText(Math.max(...all_z), 2) : "",
      },
      { label: "", data: flat(0), borderColor: c.model, borderWidth: 1.4, pointRadius: 0, pointHitRadius: 0, order: 2, fill: false },
      Object.assign({ label: "", data: flat(1.96), backgroundColor: c.outside, fill: "+1" }, plain),
      Object.assign({ label: "", data: flat(-1.96), fill: false }, plain),
    ];
    const y = {
      type: "linear", min: -top, max: top, title: { display: true, text: "residual, sd", color: c.ink, font: { size: 12.5 } },
      ticks: { color: c.ink, stepSize: top > 16 ? 10 : top > 8 ? 5 : top > 4 ? 4 : 2 }, grid: { color: c.fine, borderColor: c.border },
    };
    const all = options(logAxis("frequency, Hz", xMin, xMax), y);
    all.plugins.legend = { display: false };
    return { type: "line", data: { datasets: sets }, plugins: [whitePaper, beyondNote], options: all };
  }

  // ---- all channels of a kind ----
  const SHADED = 3, NAMED = 16;
  function groupChart(index, axis, unit, figure) {
    const indices = figure.dataset.channels.split(",").map(Number), c = colours(), sets = [], all = [], around = [], shaped = indices.map(plainFrom).filter((tau) => tau > 0);
    indices.forEach((channel, order) => {
      const a = report.allan.channels[channel], data = points(a.tau_s, a.deviation), colour = c.series[order % c.series.length];
      const dash = [[], [7, 3], [2, 2], [10, 3, 2, 3]][Math.floor(order / c.series.length) % 4], few = indices.length <= SHADED;
      const tip = (p) => {
        const out = [a.name, "τ = " + numberText(p.x) + " s", "measured " + numberText(p.y, 4) + (unit ? " " + unit : "")];
        if (a.ci95[p.i]) out.push("95 %: " + numberText(a.ci95[p.i][0], 3) + " … " + numberText(a.ci95[p.i][1], 3));
        if (a.model && a.model[p.i] !== null) out.push("model " + numberText(a.model[p.i], 4) + (unit ? " " + unit : ""));
        return out;
      };
      const hollow = data.map((p) => !a.reliable[p.i]);
      sets.push({
        label: indices.length <= NAMED ? a.name : "", family: channel, data, borderColor: colour, borderDash: dash, borderWidth: few ? 1.6 : 1.3, showLine: !few, tip, fill: false, order: 2, marks: few,
        pointStyle: ROUND[order % ROUND.length], pointRadius: few ? 3 : 0, pointHoverRadius: 6, pointHitRadius: 6, pointBorderColor: colour, pointBackgroundColor: hollow.map((h) => (h ? c.paper : colour)),
      });
      if (few && a.model) sets.push({ label: "", family: channel, data: points(a.tau_s, a.model), borderColor: colour, cubicInterpolationMode: "monotone", borderWidth: 1.8, pointRadius: 0, pointHitRadius: 0, fill: false, order: 3 });
      if (few) band("", a.tau_s, a.ci95, colour + "26").forEach((set) => sets.push(Object.assign(set, { swatch: undefined, family: channel })));
      all.push(...data);
      if (few) around.push(...a.ci95.flatMap((pair) => pair || []));
    });
    const lines = new Map(indices.map((channel) => [JSON.stringify(report.allan.channels[channel].data_sheet || null), channel]));
    Array.from(lines.values()).forEach((channel, i) => sets.push(...dataSheet(report.allan.channels[channel], i === 0 ? "data sheet" : "")));
    const [xMin, xMax] = padded(all.map((p) => p.x), 1.4), [yMin, yMax] = padded(framed(all.map((p) => p.y), around, 3), 1.5);
    return {
      type: "line", data: { datasets: sets }, plugins: [outside(shaped.map((tau) => [0, tau]), "shape", 1 / indices.length), whitePaper],
      options: options(logAxis("averaging time τ, s", xMin, xMax), logAxis(withUnit(axis, unit), yMin, yMax)),
    };
  }

  // ---- the record in time ----
  function missingMarks(t, seconds) {
    const out = [];
    t.missing.forEach(([block]) => {
      const last = out[out.length - 1];
      if (last && Math.abs(last.to_s - block * seconds) < 1e-9 * seconds) last.to_s += seconds;
      else out.push({ kind: "missing", from_s: block * seconds, to_s: (block + 1) * seconds, label: "" });
    });
    return out;
  }
  // Of the middles between least and largest, over a thirtieth of the record.
  function runningMean(low, high) {
    const half = Math.max(1, Math.round(low.length / 60));
    return low.map((at, i) => {
      let sum = 0, count = 0;
      for (let k = Math.max(0, i - half); k <= Math.min(low.length - 1, i + half); ++k) if (low[k].y !== null) { sum += (low[k].y + high[k].y) / 2; ++count; }
      return { x: at.x, y: at.y === null ? NaN : sum / count };
    });
  }
  // A round step that has two lines at least between the ends.
  function tickStep(low, high) {
    const power = Math.pow(10, Math.floor(Math.log10(high / 2 - low / 2)));
    const lines = (step) => Math.floor(high / step + 1e-9) - Math.ceil(low / step - 1e-9) + 1;
    return [5, 2, 1, 0.5, 0.2].map((f) => f * power).find((step) => lines(step) >= 2);
  }
  function traceChart(index, axis, unit, figure) {
    const t = report.trace.channels[index], c = colours(), rate = t.own_rate_hz || report.trace.rate_hz || 1, seconds = t.samples_per_block / rate, length = t.low.length * seconds;
    const [scale, word] = report.trace.rate_hz === null || !(report.trace.rate_hz > 0) ? [1, "sample"] : length > 172800 ? [86400, "time, d"] : length > 7200 ? [3600, "time, h"] : length > 600 ? [60, "time, min"] : [1, "time, s"];
    const one = t.samples_per_block === 1, middle = (i) => ((i + (one ? 0 : 0.5)) * seconds) / scale;
    const low = [], high = [];
    t.low.forEach((value, i) => {
      low.push({ x: middle(i), y: value, i });
      high.push({ x: middle(i), y: t.high[i], i });
    });
    const values = t.low.concat(t.high).filter((v) => v !== null), least = values.reduce((a, b) => Math.min(a, b), Infinity), most = values.reduce((a, b) => Math.max(a, b), -Infinity), pad = 0.08 * (most - least) || Math.abs(most) * 1e-3 || 1, [bottom, top] = linearRange(least - pad, most + pad);
    const tip = (p) => [numberText(p.x, 5) + " " + (word.split(", ")[1] || ""), one ? numberText(p.y, 6) + " " + unit : numberText(t.low[p.i], 6) + " … " + numberText(t.high[p.i], 6) + " " + unit];
    const plain = { borderColor: c.measured, borderWidth: 1, pointRadius: 0, pointHoverRadius: 3, spanGaps: false, label: "" };
    const sets = [Object.assign({ data: high, fill: one ? false : "+1", backgroundColor: one ? "transparent" : c.measured, tip, pointHitRadius: 8, order: 3 }, plain)];
    if (!one) sets.push(Object.assign({ data: low, fill: false, pointHitRadius: 0, order: 3 }, plain));
    sets.push({ label: "", data: runningMean(low, high), borderColor: c.paper, borderWidth: 4, pointRadius: 0, pointHitRadius: 0, fill: false, spanGaps: false, order: 2 });
    sets.push(Object.assign({}, sets[sets.length - 1], { borderColor: c.model, borderWidth: 1.8, order: 1 }));
    // Given ends that lie a whole number of steps apart, more or less, Chart.js divides the range instead: 146.7, 43.75, -59.2.
    const multiples = (axis, step) => { axis.ticks = Array.from({ length: Math.floor(axis.max / step + 1e-9) - Math.ceil(axis.min / step - 1e-9) + 1 }, (_, k) => ({ value: (Math.ceil(axis.min / step - 1e-9) + k) * step })); };
    const straight = (title, min, max, most, step) => ({ type: "linear", min, max, afterBuildTicks: (axis) => step && multiples(axis, step), title: { display: Boolean(title), text: title, color: c.ink, font: { size: 12 } }, ticks: { color: c.ink, maxRotation: 0, maxTicksLimit: most, stepSize: step, includeBounds: false, callback: (v) => numberText(v, 5) }, grid: { color: c.fine, borderColor: c.border } });
    const marks = t.marks.concat(missingMarks(t, seconds)).map((m) => ({
      from: m.from_s / scale, to: m.to_s / scale, label: m.label, ink: c.model, shade: m.to_s === m.from_s || m.kind === "ramp" ? "" : m.kind === "missing" ? c.missing : c.moved,
    })), end = length / scale, beside = timeMarks(marks, 0, end);
    figure.style.setProperty("--marks", 13 * beside.rows(figure.clientWidth || 600) + "px");
    figure.style.setProperty("--paper-marks", 13 * beside.rows(340) + "px");
    const all = options(straight(word, 0, end, 8), straight(unit, bottom, top, 5, tickStep(bottom, top)));
    all.plugins.legend = { display: false };
    all.layout = { padding: beside.padding };
    all.interaction = { mode: "nearest", axis: "x", intersect: false };
    return { type: "line", data: { datasets: sets }, plugins: [beside.plugin, whitePaper], options: all };
  }

  const MAKERS = { allan: allanChart, group: groupChart, spectrum: spectrumChart, residuals: residualChart, trace: traceChart };
  const ON_PAPER = { residuals: [340, 150], group: [340, 222] };

  // What the reader has not unfolded is not printed.
  start(MAKERS, (kind, figure) => (kind === "trace" ? [340, 82 + parseInt(figure.style.getPropertyValue("--paper-marks"), 10)] : ON_PAPER[kind] || [340, 260]), "details.on-paper:not([open])");
})();
