// Draws the plots of a characterization from the JSON in the page, when they come into view (page_common.js).
(function () {
  "use strict";

  const { report, INK, MEASURED, numberText, positive, padded, logAxis, whitePaper, options, start } = reportPage;
  const MODEL = "#c03a12", SIMULATED = "#0c8a5f";
  // Told apart by dash as well as by colour, for print.
  const TERMS = {
    white_noise: { name: "white noise Q", colour: "#1e7a3c", dash: [9, 4], mark: "rectRot" },
    bias_instability: { name: "bias instability B", colour: "#7a3fa0", dash: [2, 3], mark: "triangle" },
    random_walk: { name: "random walk K", colour: "#a86a00", dash: [11, 3, 2, 3], mark: "rect" },
    quantization: { name: "quantization Qz", colour: "#00757f", dash: [5, 2, 1, 2, 1, 2], mark: "star" },
    rate_ramp: { name: "rate ramp R", colour: "#8c4630", dash: [16, 5], mark: "crossRot" },
  };

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
    return Object.keys(all || {}).map((key) => ({
      label: TERMS[key].name, data: all[key].map(([x, y]) => ({ x, y })),
      borderColor: TERMS[key].colour, borderDash: TERMS[key].dash, borderWidth: 1.6, pointRadius: 0, pointHitRadius: 0, fill: false, order: 4,
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
          pen.strokeStyle = "rgba(255,255,255,0.9)";
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
    const style = curve === "allan" ? { showLine: false, pointStyle: "triangle", pointRadius: 4.5, marks: true, pointBorderColor: SIMULATED, pointBackgroundColor: "transparent", borderWidth: 1.8 } : { pointRadius: 0, borderWidth: 1.2 };
    return [Object.assign({ label: "simulated from the model", data: points(x, y), borderColor: SIMULATED, pointHitRadius: 0, fill: false, order: 3 }, style)];
  }

  // ---- the three plots ----
  function allanChart(index, axis, unit) {
    const a = report.allan.channels[index], f = report.fit.channels[index];
    const marks = f.derived ? f.derived.read_off_points : [];
    const measured = points(a.tau_s, a.deviation);
    const tip = (p) => {
      const out = ["τ = " + numberText(p.x) + " s", "measured " + numberText(p.y, 5) + " " + unit];
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
        label: "measured", data: measured, borderColor: MEASURED, showLine: false, borderWidth: 1.6, marks: true, tip, order: 2,
        pointRadius: measured.length > 60 ? 2 : 3.5, pointHoverRadius: 6, pointBorderColor: MEASURED, pointBackgroundColor: hollow.map((h) => (h ? "#fff" : MEASURED)), fill: false,
      });
    }
    if (a.model) sets.push({ label: "fitted model", data: points(a.tau_s, a.model), borderColor: MODEL, cubicInterpolationMode: "monotone", borderWidth: 2.2, pointRadius: 0, pointHitRadius: 0, fill: false, order: 3 });
    sets.push(...simulated(index, "allan"), ...asymptotes(a.asymptotes));
    marks.filter((m) => positive(m.tau_s) && positive(m.deviation)).forEach((m) => {
      const style = TERMS[m.term];
      sets.push({
        label: "", readOff: true, marks: true, data: [{ x: m.tau_s, y: m.deviation, label: m.label }], borderColor: style.colour, showLine: false,
        backgroundColor: "#fff", pointStyle: style.mark, pointRadius: 7, pointHoverRadius: 9, pointBorderWidth: 2.2, order: 1, fill: false,
        tip: () => [m.label, numberText(m.deviation, 5) + " " + unit],
      });
    });
    sets.push(...band("68 % interval", a.tau_s, a.ci68, "rgba(27,79,143,0.30)"), ...band("95 % interval", a.tau_s, a.ci95, "rgba(27,79,143,0.14)"));
    // A mark far below the curve (a K that a short record hardly shows) would press everything else together.
    const near = marks.filter((m) => m.deviation > Math.min(...measured.map((p) => p.y)) / 30);
    const [xMin, xMax] = padded(measured.map((p) => p.x).concat(marks.map((m) => m.tau_s)), 1.4);
    const intervals = framed(measured.map((p) => p.y), a.ci95.flatMap((pair) => pair || []), 3);
    const drawn = framed(intervals, measured.map((p) => (a.model ? a.model[p.i] : null)), 30);
    const [yMin, yMax] = padded(drawn.concat(near.map((m) => m.deviation)), 1.8);
    return {
      type: "line", data: { datasets: sets }, plugins: [readOffLabels, whitePaper],
      options: options(logAxis("averaging time τ, s", xMin, xMax), logAxis(axis + ", " + unit, yMin, yMax)),
    };
  }

  function spectrumChart(index, axis, unit) {
    const s = report.spectrum.channels[index];
    const measured = points(s.frequency_hz, s.value);
    const tip = (p) => {
      const out = ["f = " + numberText(p.x, 5) + " Hz", "measured " + numberText(p.y, 4) + " " + unit];
      if (s.ci95[p.i]) out.push("95 %: " + numberText(s.ci95[p.i][0], 3) + " … " + numberText(s.ci95[p.i][1], 3));
      if (s.model && s.model[p.i] !== null) out.push("model " + numberText(s.model[p.i], 4) + " " + unit);
      if (s.dof[p.i]) out.push(numberText(s.dof[p.i], 3) + " degrees of freedom");
      return out;
    };
    const sets = [{ label: "measured", data: measured, borderColor: MEASURED, borderWidth: 1.3, pointRadius: 0, pointHoverRadius: 5, pointHitRadius: 5, tip, fill: false, order: 2 }];
    if (s.model) sets.push({ label: "fitted model", data: points(s.frequency_hz, s.model), borderColor: MODEL, borderWidth: 2.2, pointRadius: 0, pointHitRadius: 0, fill: false, order: 1 });
    sets.push(...simulated(index, "spectrum"), ...asymptotes(s.asymptotes), ...band("95 % interval", s.frequency_hz, s.ci95, "rgba(27,79,143,0.18)"));
    const [xMin, xMax] = padded(measured.map((p) => p.x), 1.3);
    const [yMin, yMax] = padded(framed(measured.map((p) => p.y), measured.map((p) => (s.model ? s.model[p.i] : null)), 100), 2);
    return {
      type: "line", data: { datasets: sets }, plugins: [whitePaper],
      options: options(logAxis("frequency, Hz", xMin, xMax), logAxis(axis + ", " + unit, yMin, yMax)),
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
    const r = report.fit.channels[index].residuals;
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
      { label: "residual", data: dots, showLine: false, borderColor: MEASURED, backgroundColor: MEASURED, pointRadius: 2.4, pointHoverRadius: 5, marks: true, tip, order: 1, fill: false },
      {
        label: "", data: beyond, showLine: false, borderColor: MODEL, backgroundColor: MODEL, pointStyle: "triangle", pointRadius: 5, pointHoverRadius: 7, marks: true, tip, order: 0, fill: false,
        pointRotation: beyond.map((p) => (p.y > 0 ? 0 : 180)), note: beyond.length ? beyond.length + " beyond ±" + top + ", up to " + numberText(Math.max(...all_z), 2) : "",
      },
      { label: "", data: flat(0), borderColor: MODEL, borderWidth: 1.4, pointRadius: 0, pointHitRadius: 0, order: 2, fill: false },
      Object.assign({ label: "", data: flat(1.96), backgroundColor: "rgba(90,100,112,0.13)", fill: "+1" }, plain),
      Object.assign({ label: "", data: flat(-1.96), fill: false }, plain),
    ];
    const y = {
      type: "linear", min: -top, max: top, title: { display: true, text: "residual, sd", color: INK, font: { size: 12.5 } },
      ticks: { color: INK, stepSize: top > 16 ? 10 : top > 8 ? 5 : top > 4 ? 4 : 2 }, grid: { color: "#edf0f3", borderColor: "#8a929b" },
    };
    const all = options(logAxis("frequency, Hz", xMin, xMax), y);
    all.plugins.legend = { display: false };
    return { type: "line", data: { datasets: sets }, plugins: [whitePaper, beyondNote], options: all };
  }

  const MAKERS = { allan: allanChart, spectrum: spectrumChart, residuals: residualChart };

  start(MAKERS, (kind) => (kind === "residuals" ? 170 : 320));
})();
