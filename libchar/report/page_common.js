// What the pages of all reports share: numbers and axes for numberText, pieces of a chart, drawing when a figure comes into view, the
// download. Stands in front of each page's own script, in the same element. Chart.js does the drawing; every number drawn stands in
// the JSON of the page, computed by libchar.
const reportPage = (function () {
  "use strict";

  const report = JSON.parse(document.getElementById("report-data").textContent);

  const INK = "#16191d", DIM = "#5a6470", MEASURED = "#1b4f8f";

  // ---- numbers ----
  const SUPERSCRIPT = "⁰¹²³⁴⁵⁶⁷⁸⁹";
  const superscript = (n) => (n < 0 ? "⁻" : "") + String(Math.abs(n)).split("").map((d) => SUPERSCRIPT[+d]).join("");
  function numberText(value, digits) {
    if (value === null || !isFinite(value)) return "–";
    if (value === 0) return "0";
    const [mantissa, exponent] = value.toExponential((digits || 4) - 1).split("e");
    const e = Number(exponent);
    return e < -3 || e > 5 ? mantissa + "×10" + superscript(e) : Number(value.toPrecision(digits || 4)).toString();
  }
  const isPowerOfTen = (v) => Math.abs(Math.log10(v) - Math.round(Math.log10(v))) < 1e-9;

  // ---- axes ----
  // Only values above zero can stand on a logarithmic axis: one that is not would move the axis and hide the others.
  const positive = (v) => typeof v === "number" && isFinite(v) && v > 0;

  function logTicks(axis) {
    const ticks = [];
    for (let e = Math.floor(Math.log10(axis.min)) - 1; e <= Math.ceil(Math.log10(axis.max)); ++e) {
      for (let d = 1; d < 10; ++d) {
        const value = d * Math.pow(10, e);
        if (value >= axis.min * (1 - 1e-9) && value <= axis.max * (1 + 1e-9)) ticks.push({ value });
      }
    }
    axis.ticks = ticks;
  }
  function logLabel(value, min, max) {
    const decades = Math.log10(max / min);
    if (isPowerOfTen(value)) return "10" + superscript(Math.round(Math.log10(value)));
    const lead = Math.round(value / Math.pow(10, Math.floor(Math.log10(value) + 1e-9)));
    return decades < 1.6 && (lead === 2 || lead === 5) ? numberText(value, 2) : "";
  }
  function logAxis(title, min, max) {
    return {
      type: "logarithmic", min, max,
      title: { display: true, text: title, color: INK, font: { size: 12.5 } },
      afterBuildTicks: logTicks,
      ticks: { autoSkip: false, maxRotation: 0, color: INK, callback: (value) => logLabel(value, min, max) },
      grid: {
        color: (context) => (context.tick && isPowerOfTen(context.tick.value) ? "#c3c9d0" : "#edf0f3"),
        tickColor: (context) => (context.tick && isPowerOfTen(context.tick.value) ? "#8a929b" : "transparent"),
        borderColor: "#8a929b",
      },
    };
  }
  function padded(values, factor) {
    const good = values.filter(positive);
    return good.length ? [Math.min(...good) / factor, Math.max(...good) * factor] : [0.1, 10];
  }

  // ---- pieces of a chart ----
  const whitePaper = {
    id: "whitePaper",
    beforeDraw(chart) {
      chart.ctx.save();
      chart.ctx.fillStyle = "#fff";
      chart.ctx.fillRect(0, 0, chart.width, chart.height);
      chart.ctx.restore();
    },
  };

  function legend() {
    return {
      position: "bottom",
      labels: {
        usePointStyle: true, boxWidth: 28, boxHeight: 8, padding: 12, color: INK, font: { size: 12 },
        generateLabels(chart) {
          return chart.data.datasets.map((set, index) => ({
            text: set.label, datasetIndex: index, hidden: !chart.isDatasetVisible(index), fontColor: INK,
            pointStyle: set.swatch ? "rect" : set.marks ? set.pointStyle || "circle" : "line",
            fillStyle: set.swatch || (set.marks ? set.borderColor : "transparent"), strokeStyle: set.swatch || set.borderColor,
            lineWidth: set.swatch ? 0 : set.borderWidth || 2, lineDash: set.borderDash || [],
          })).filter((item) => item.text);
        },
      },
      // The lower edge of a band follows the upper one.
      onClick(event, item, box) {
        const chart = box.chart, index = item.datasetIndex, show = !chart.isDatasetVisible(index);
        chart.setDatasetVisibility(index, show);
        if (chart.data.datasets[index].swatch) chart.setDatasetVisibility(index + 1, show);
        chart.update();
      },
    };
  }
  function options(x, y, tooltip) {
    return {
      animation: false, parsing: false, normalized: true, responsive: true, maintainAspectRatio: false,
      devicePixelRatio: Math.max(2, window.devicePixelRatio || 1),
      interaction: { mode: "nearest", axis: "xy", intersect: false },
      scales: { x, y },
      plugins: {
        legend: legend(),
        tooltip: {
          filter: (item) => Boolean(item.dataset.tip), displayColors: false, backgroundColor: "rgba(22,25,29,0.93)",
          callbacks: { title: () => "", label: (item) => item.dataset.tip(item.raw) },
        },
      },
    };
  }

  // `makers`: a function a kind of figure that gives its chart's configuration; `heightOnPaper`: in pixels at a width of 690;
  // `openOnPaper`: which details are printed unfolded.
  function start(makers, heightOnPaper, openOnPaper) {
    // ---- drawing when needed ----
    const figures = Array.from(document.querySelectorAll("figure.plot"));
    const charts = new Map();
    function draw(figure) {
      if (charts.has(figure)) return;
      const config = makers[figure.dataset.kind](Number(figure.dataset.channel), figure.dataset.axis, figure.dataset.unit);
      charts.set(figure, new Chart(figure.querySelector("canvas"), config));
    }
    const watch = new IntersectionObserver((entries) => {
      entries.filter((entry) => entry.isIntersecting).forEach((entry) => {
        watch.unobserve(entry.target);
        draw(entry.target);
      });
    }, { rootMargin: "900px 0px" });
    // What is in view at the start is drawn at once, so that a page shown for a moment (or photographed) has its plots.
    figures.forEach((figure) => (figure.getBoundingClientRect().top < window.innerHeight + 300 ? draw(figure) : watch.observe(figure)));

    // Paper has no viewport: draw all, at the width of the page.
    let opened = [];
    window.addEventListener("beforeprint", () => {
      figures.forEach(draw);
      charts.forEach((chart, figure) => chart.resize(690, heightOnPaper(figure.dataset.kind)));
      opened = Array.from(document.querySelectorAll(openOnPaper || "#provenance details:not([open])"));
      opened.forEach((details) => { details.open = true; });
    });
    window.addEventListener("afterprint", () => {
      charts.forEach((chart) => chart.resize());
      opened.forEach((details) => { details.open = false; });
    });

    // ---- the numbers, to take away ----
    const button = document.getElementById("download");
    button.hidden = false;
    button.addEventListener("click", () => {
      const address = URL.createObjectURL(new Blob([JSON.stringify(report, null, 2) + "\n"], { type: "application/json" }));
      const link = document.createElement("a");
      link.href = address;
      link.download = "report.json";
      link.click();
      setTimeout(() => URL.revokeObjectURL(address), 1000);
    });

    return { figures, charts };
  }

  return { report, INK, DIM, MEASURED, numberText, superscript, positive, padded, logAxis, whitePaper, legend, options, start };
})();
