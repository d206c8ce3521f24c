// What the pages of all reports share: numbers and axes for numberText, pieces of a chart, drawing when a figure comes into view, the
// download. Stands in front of each page's own script, in the same element. Chart.js does the drawing; every number drawn stands in
// the JSON of the page, computed by libchar.
const reportPage = (function () {
  "use strict";

  const report = JSON.parse(document.getElementById("report-data").textContent);

  // ---- colours ----
  // Okabe and Ito's, which readers who confuse red and green tell apart too. A second set is for dark
  // screens; paper is always white. `methods` and `sensors` were searched for the largest distance (Oklab) between any two of them and
  // from the ink under normal sight and with each kind of cone missing (tests/report/palette_test.py).
  const LIGHT = {
    ink: "#16191d", dim: "#5a6470", paper: "#ffffff", halo: "rgba(255,255,255,0.9)", fine: "#edf0f3", decade: "#c3c9d0", border: "#8a929b",
    measured: "#0072b2", model: "#c44e00", simulated: "#00805d", outside: "rgba(90,100,112,0.13)",
    band68: "rgba(0,114,178,0.28)", band95: "rgba(0,114,178,0.13)", moved: "rgba(230,159,0,0.25)", missing: "rgba(90,100,112,0.35)",
    series: ["#0072b2", "#d55e00", "#009e73", "#b0508a", "#b37700", "#3a9fd6", "#16191d"],
    methods: ["#4d0bf6", "#ab230a", "#899606", "#da41a3", "#6e84fb", "#730f78"],
    sensors: ["#375ca1", "#9d7403", "#97475a", "#43315f", "#7688d7", "#6b2107", "#ca6e88"],
    known: "#c9d3df", shade: "rgba(0,114,178,0.10)", grip: "rgba(27,79,143,0.16)",
  };
  const DARK = {
    ink: "#e6e9ec", dim: "#a4adb6", paper: "#15191d", halo: "rgba(21,25,29,0.9)", fine: "#252b31", decade: "#434b54", border: "#77818b",
    measured: "#56b4e9", model: "#ff8a4c", simulated: "#3fcf9f", outside: "rgba(164,173,182,0.16)",
    band68: "rgba(86,180,233,0.34)", band95: "rgba(86,180,233,0.17)", moved: "rgba(230,159,0,0.35)", missing: "rgba(164,173,182,0.4)",
    series: ["#56b4e9", "#ff8a4c", "#3fcf9f", "#e39ac4", "#f0c04a", "#9fd3f2", "#e6e9ec"],
    methods: ["#356efe", "#de857f", "#d6c517", "#975295", "#29bdf4", "#52731e"],
    sensors: ["#7691cf", "#dac572", "#df9492", "#a3874a", "#70cbeb", "#9f544c", "#496c91"],
    known: "#3a4654", shade: "rgba(86,180,233,0.14)", grip: "rgba(140,200,242,0.22)",
  };
  const darkScreen = window.matchMedia("(prefers-color-scheme: dark)");
  let onPaper = false;
  const colours = () => (darkScreen.matches && !onPaper ? DARK : LIGHT);

  // ---- numbers ----
  const SUPERSCRIPT = "⁰¹²³⁴⁵⁶⁷⁸⁹";
  const superscript = (n) => (n < 0 ? "⁻" : "") + String(Math.abs(n)).split("").map((d) => SUPERSCRIPT[+d]).join("");
  function numberText(value, digits) {
    if (value === null || !isFinite(value)) return "–";
    if (value === 0) return "0";
    const [mantissa, exponent] = value.toExponential((digits || 4) - 1).split("e");
    const e = Number(exponent);
    return (e < -3 || e > 5 ? mantissa + "×10" + superscript(e) : Number(value.toPrecision(digits || 4)).toString()).replace("-", "−");
  }
  const isPowerOfTen = (v) => Math.abs(Math.log10(v) - Math.round(Math.log10(v))) < 1e-9;

  // ---- axes ----
  // Between them ten times a step, a tenth of it and its decimals are numbers too: loops over ticks, ours and Chart.js's, end.
  const SMALLEST = 1e-290, LARGEST = 1e300;
  // Only values above zero can stand on a logarithmic axis: one that is not would move the axis and hide the others.
  const positive = (v) => typeof v === "number" && v >= SMALLEST && v <= LARGEST;
  // Ends of a linear axis whose ticks can be counted.
  function linearRange(min, max) {
    const low = Math.max(min, -LARGEST), high = Math.min(max, LARGEST), size = Math.max(Math.abs(low), Math.abs(high));
    if (high - low > Math.max(SMALLEST, 1e-13 * size)) return [low, high];
    const pad = 1e-3 * size > SMALLEST ? 1e-3 * size : 1;
    return [low - pad, high + pad];
  }

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
    const plain = decades < 1.6 && value > 9e-4 && value < 2e4;  // next to 0.5 and 2 stands 1, not 10⁰
    if (isPowerOfTen(value)) return plain ? numberText(value, 2) : "10" + superscript(Math.round(Math.log10(value)));
    const lead = Math.round(value / Math.pow(10, Math.floor(Math.log10(value) + 1e-9)));
    return decades < 1.6 && (lead === 2 || lead === 5) ? numberText(value, 2) : "";
  }
  function logAxis(title, min, max) {
    const c = colours();
    return {
      type: "logarithmic", min, max,
      title: { display: true, text: title, color: c.ink, font: { size: 12.5 } },
      afterBuildTicks: logTicks,
      ticks: { autoSkip: false, maxRotation: 0, color: c.ink, callback: (value) => logLabel(value, min, max) },
      grid: {
        color: (context) => (context.tick && isPowerOfTen(context.tick.value) ? c.decade : c.fine),
        tickColor: (context) => (context.tick && isPowerOfTen(context.tick.value) ? c.border : "transparent"),
        borderColor: c.border,
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
      chart.ctx.fillStyle = colours().paper;
      chart.ctx.fillRect(0, 0, chart.width, chart.height);
      chart.ctx.restore();
    },
  };

  function legend() {
    const ink = colours().ink;
    return {
      position: "bottom",
      labels: {
        usePointStyle: true, boxWidth: 28, boxHeight: 8, padding: 12, color: ink, font: { size: 12 },
        generateLabels(chart) {
          return chart.data.datasets.map((set, index) => ({
            text: set.label, datasetIndex: index, hidden: !chart.isDatasetVisible(index), fontColor: ink,
            pointStyle: set.swatch ? "rect" : set.marks ? set.pointStyle || "circle" : "line",
            fillStyle: set.swatch || (set.marks ? set.borderColor : "transparent"), strokeStyle: set.swatch || set.borderColor,
            lineWidth: set.swatch ? 0 : set.borderWidth || 2, lineDash: set.borderDash || [],
          })).filter((item) => item.text);
        },
      },
      // The lower edge of a band follows the upper one; what belongs together goes together.
      onClick(event, item, box) {
        const chart = box.chart, index = item.datasetIndex, show = !chart.isDatasetVisible(index), set = chart.data.datasets[index];
        chart.setDatasetVisibility(index, show);
        if (set.swatch) chart.setDatasetVisibility(index + 1, show);
        if (set.family !== undefined) chart.data.datasets.forEach((other, i) => { if (other.family === set.family) chart.setDatasetVisibility(i, show); });
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

  // ---- marks along a time axis ----
  // Shaded stretches, dashed lines at instants, and names in rows above the plot, where they hide nothing. A name is in a row above all that
  // it would touch, and right ones are placed first: no line down to its mark crosses a name. Equal names that would touch are counted.
  // `marks`: {from, to, label, ink, shade}, shade "" for an instant; between `min` and `max` of the axis.
  const MARK_ROW = 13, MARK_ROWS = 7, MARK_FONT = "600 11px system-ui, 'DejaVu Sans', sans-serif", ruler = document.createElement("canvas").getContext("2d");
  function timeMarks(marks, min, max) {
    const all = marks.filter((m) => m.to >= min && m.from <= max);
    const widthOf = (text) => { ruler.font = MARK_FONT; return ruler.measureText(text).width + 3; };
    function named(left, right) {
      const groups = [], placed = [], place = (t) => left + ((Math.max(min, t) - min) / (max - min)) * (right - left);
      all.filter((m) => m.label).sort((a, b) => a.from - b.from).forEach((m) => {
        const at = place(m.from), same = groups.find((g) => g.m.label === m.label && at - g.last < widthOf(m.label + " × 99") + 8);
        if (same) Object.assign(same, { last: at, count: same.count + 1 });
        else groups.push({ m, at, last: at, count: 1 });
      });
      groups.reverse().forEach(({ m, at, count }) => {
        const text = count > 1 ? count + " × " + m.label : m.label, width = widthOf(text), begin = Math.max(left, Math.min(at, right - width)), end = begin + width;
        const row = placed.reduce((most, p) => (p.begin < end + 8 && begin < p.end + 8 ? Math.max(most, p.row + 1) : most), 0);
        if (row < MARK_ROWS && width <= right - left) placed.push({ text, at, begin, end, row, ink: m.ink });
      });
      return placed;
    }
    const rows = (width) => named(60, width - 10).reduce((most, p) => Math.max(most, p.row + 1), 0);
    return {
      rows, padding: (context) => ({ top: 2 + MARK_ROW * rows(context.chart.width) }),
      plugin: {
        id: "timeMarks",
        beforeDatasetsDraw(chart) {
          const pen = chart.ctx, area = chart.chartArea, x = (t) => Math.max(area.left, Math.min(area.right, chart.scales.x.getPixelForValue(t)));
          pen.save();
          all.filter((m) => m.shade).forEach((m) => {
            pen.fillStyle = m.shade;
            pen.fillRect(x(m.from), area.top, Math.max(1.5, x(m.to) - x(m.from)), area.bottom - area.top);
          });
          pen.restore();
        },
        afterDatasetsDraw(chart) {
          const pen = chart.ctx, area = chart.chartArea, line = (at, from, to) => { pen.beginPath(); pen.moveTo(at, from); pen.lineTo(at, to); pen.stroke(); };
          const placed = named(area.left, area.right).filter((p) => area.top - MARK_ROW * (p.row + 1) >= 0);
          pen.save();
          pen.font = MARK_FONT;
          pen.textBaseline = "top";
          pen.lineWidth = 1.4;
          pen.setLineDash([4, 3]);
          all.filter((m) => !m.shade && m.from >= min).forEach((m) => {
            pen.strokeStyle = m.ink;
            line(chart.scales.x.getPixelForValue(m.from), area.top, area.bottom);
          });
          pen.setLineDash([]);
          pen.lineWidth = 1;
          placed.forEach((p) => {
            pen.strokeStyle = p.ink;
            line(p.at, area.top - MARK_ROW * (p.row + 1) + 2, area.top);
          });
          pen.lineWidth = 3;
          pen.strokeStyle = colours().halo;
          placed.forEach((p) => {
            pen.fillStyle = p.ink;
            pen.strokeText(p.text, p.begin + 3, area.top - MARK_ROW * (p.row + 1));
            pen.fillText(p.text, p.begin + 3, area.top - MARK_ROW * (p.row + 1));
          });
          pen.restore();
        },
      },
    };
  }

  // ---- a plot, to take away ----
  function handOut(blob, name) {
    const address = URL.createObjectURL(blob), link = document.createElement("a");
    link.href = address;
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  }

  // What a chart draws, as the path of an SVG element.
  class Trail {
    constructor() { this.d = []; }
    moveTo(x, y) { this.d.push("M", x, y); }
    lineTo(x, y) { this.d.push(this.d.length ? "L" : "M", x, y); }
    bezierCurveTo(a, b, c, d, x, y) { this.d.push("C", a, b, c, d, x, y); }
    quadraticCurveTo(a, b, x, y) { this.d.push("Q", a, b, x, y); }
    closePath() { if (this.d.length) this.d.push("Z"); }
    rect(x, y, w, h) { this.d.push("M", x, y, "h", w, "v", h, "h", -w, "Z"); }
    arc(x, y, r, from, to, back) { this.ellipse(x, y, r, r, 0, from, to, back); }
    ellipse(x, y, rx, ry, turn, from, to, back) {
      const at = (angle) => [x + rx * Math.cos(angle), y + ry * Math.sin(angle)], turnTo = (angle, large) => this.d.push("A", rx, ry, 0, large, back ? 0 : 1, ...at(angle));
      const sweep = back ? from - to : to - from;
      this.lineTo(...at(from));
      if (Math.abs(sweep) >= 2 * Math.PI - 1e-6) {
        turnTo(from + Math.PI, 1);
        turnTo(from, 1);
      } else {
        const left = ((sweep % (2 * Math.PI)) + 2 * Math.PI) % (2 * Math.PI);
        turnTo(to, left > Math.PI ? 1 : 0);
      }
    }
    text() { return this.d.map((v) => (typeof v === "number" ? Math.round(v * 100) / 100 : v)).join(" "); }
  }

  // XML has no place for control characters and halves of characters, not even escaped.
  const xml = (text) => String(text).replace(/[\u0000-\u0008\u000b\u000c\u000e-\u001f\ufffe\uffff]|[\ud800-\udbff](?![\udc00-\udfff])|(?<![\ud800-\udbff])[\udc00-\udfff]/g, "\ufffd").replace(/[&<>"']/g, (c) => "&#" + c.charCodeAt(0) + ";");

  // As much of a canvas's context as Chart.js and we use; it writes SVG.
  function svgContext(real, width, height) {
    const out = [], stack = [];
    let trail = new Trail(), clips = 0;
    let state = {
      fillStyle: "#000", strokeStyle: "#000", lineWidth: 1, lineCap: "butt", lineJoin: "miter", miterLimit: 10, lineDashOffset: 0, font: "12px sans-serif",
      textAlign: "start", textBaseline: "alphabetic", globalAlpha: 1, dash: [], matrix: [1, 0, 0, 1, 0, 0], clip: 0,
    };
    const paint = (name, style) => {
      const parts = /^rgba\(([^,]+),([^,]+),([^,]+),([^)]+)\)$/.exec(String(style).replace(/\s/g, ""));
      if (style === "transparent") return name + '="none"';
      if (!parts) return name + '="' + xml(style) + '"' + (state.globalAlpha < 1 ? " " + name + '-opacity="' + state.globalAlpha + '"' : "");
      return name + '="rgb(' + parts.slice(1, 4).join(",") + ')" ' + name + '-opacity="' + Number(parts[4]) * state.globalAlpha + '"';
    };
    const placed = () => (state.matrix.join() === "1,0,0,1,0,0" ? "" : ' transform="matrix(' + state.matrix.join(" ") + ')"') + (state.clip ? ' clip-path="url(#c' + state.clip + ')"' : "");
    const stroke = () => paint("stroke", state.strokeStyle) + ' stroke-width="' + state.lineWidth + '" stroke-linecap="' + state.lineCap + '" stroke-linejoin="' + state.lineJoin + '"' + (state.dash.length ? ' stroke-dasharray="' + state.dash.join(" ") + '"' : "");
    const shape = (path, how) => { if (path.d.length) out.push('<path d="' + path.text() + '" ' + how + placed() + "/>"); };
    const turned = (m) => {
      const [a, b, c, d, e, f] = state.matrix;
      state.matrix = [a * m[0] + c * m[1], b * m[0] + d * m[1], a * m[2] + c * m[3], b * m[2] + d * m[3], a * m[4] + c * m[5] + e, b * m[4] + d * m[5] + f];
    };
    const words = (text, x, y, how) => {
      const anchor = { center: "middle", right: "end", end: "end" }[state.textAlign] || "start", down = { middle: 0.35, top: 0.8, hanging: 0.8, bottom: -0.2 }[state.textBaseline] || 0;
      const font = /^(.*?)(\d+(?:\.\d+)?)px(?:\/\S+)?\s+(.*)$/.exec(state.font) || ["", "", "12", "sans-serif"], bold = /bold|[6-9]00/.test(font[1]);
      out.push('<text x="' + x + '" y="' + (y + down * Number(font[2])) + '" font-size="' + font[2] + '" font-family="' + xml(font[3]) + '"' + (bold ? ' font-weight="600"' : "") + ' text-anchor="' + anchor + '" ' + how + placed() + ">" + xml(text) + "</text>");
    };
    const box = (x, y, w, h) => { const path = new Trail(); path.rect(x, y, w, h); return path; };
    const context = {
      canvas: real.canvas,
      save() { stack.push(Object.assign({}, state)); }, restore() { if (stack.length) state = stack.pop(); },
      beginPath() { trail = new Trail(); },
      fill(path) { shape(path instanceof Trail ? path : trail, paint("fill", state.fillStyle)); },
      stroke(path) { shape(path instanceof Trail ? path : trail, 'fill="none" ' + stroke()); },
      clip(path) {
        out.push('<clipPath id="c' + ++clips + '"' + (state.clip ? ' clip-path="url(#c' + state.clip + ')"' : "") + '><path d="' + (path instanceof Trail ? path : trail).text() + '"/></clipPath>');
        state.clip = clips;
      },
      fillRect(x, y, w, h) { shape(box(x, y, w, h), paint("fill", state.fillStyle)); }, strokeRect(x, y, w, h) { shape(box(x, y, w, h), 'fill="none" ' + stroke()); }, clearRect() {},
      fillText(text, x, y) { words(text, x, y, paint("fill", state.fillStyle)); }, strokeText(text, x, y) { words(text, x, y, 'fill="none" ' + stroke()); },
      measureText(text) { real.save(); real.font = state.font; const size = real.measureText(text); real.restore(); return size; },
      setLineDash(dash) { state.dash = Array.from(dash || []); }, getLineDash() { return state.dash; },
      translate(x, y) { turned([1, 0, 0, 1, x, y]); }, scale(x, y) { turned([x, 0, 0, y, 0, 0]); },
      rotate(angle) { turned([Math.cos(angle), Math.sin(angle), -Math.sin(angle), Math.cos(angle), 0, 0]); },
      setTransform(...m) { state.matrix = m; }, resetTransform() { state.matrix = [1, 0, 0, 1, 0, 0]; },
      svg() { return '<svg xmlns="http://www.w3.org/2000/svg" width="' + width + '" height="' + height + '" viewBox="0 0 ' + width + " " + height + '">' + out.join("\n") + "</svg>\n"; },
    };
    ["moveTo", "lineTo", "bezierCurveTo", "quadraticCurveTo", "closePath", "rect", "arc", "ellipse"].forEach((name) => { context[name] = (...where) => trail[name](...where); });
    Object.keys(state).filter((key) => !["dash", "matrix", "clip"].includes(key)).forEach((key) => Object.defineProperty(context, key, { get: () => state[key], set: (value) => { state[key] = value; } }));
    return context;
  }

  // The chart draws itself once more, into text.
  function svgOf(chart) {
    const real = chart.ctx, context = svgContext(real, chart.width, chart.height), PathOfBrowser = window.Path2D;
    const holders = [chart, chart.legend, chart.tooltip].concat(Object.values(chart.scales)).filter(Boolean);
    const metas = chart.data.datasets.map((set, i) => chart.getDatasetMeta(i)), lines = metas.map((meta) => meta.dataset).filter(Boolean);
    const forget = () => lines.forEach((line) => { line._path = undefined; });
    try {
      window.Path2D = Trail;
      forget();
      holders.forEach((holder) => { holder.ctx = context; });
      metas.forEach((meta) => { meta.controller._ctx = context; });
      chart.draw();
    } finally {
      window.Path2D = PathOfBrowser;
      holders.forEach((holder) => { holder.ctx = real; });
      metas.forEach((meta) => { meta.controller._ctx = real; });
      forget();
      chart.draw();
    }
    return context.svg();
  }

  // `makers`: a function a kind of figure that gives its chart's configuration; `sizeOnPaper`: in pixels [width, height], or the height
  // at a width of 690; `openOnPaper`: which details are printed unfolded.
  function start(makers, sizeOnPaper, openOnPaper) {
    // ---- drawing when needed ----
    const figures = Array.from(document.querySelectorAll("figure.plot"));
    const charts = new Map();
    const folded = (figure) => Boolean(figure.closest("details:not([open])"));
    function draw(figure) {
      if (charts.has(figure) || folded(figure)) return;
      const config = makers[figure.dataset.kind](Number(figure.dataset.channel), figure.dataset.axis, figure.dataset.unit, figure);
      charts.set(figure, new Chart(figure.querySelector("canvas"), config));
    }
    function redraw() {
      const drawn = Array.from(charts.keys());
      charts.forEach((chart) => chart.destroy());
      charts.clear();
      drawn.forEach(draw);
    }
    const watch = new IntersectionObserver((entries) => {
      entries.filter((entry) => entry.isIntersecting && !folded(entry.target)).forEach((entry) => {
        watch.unobserve(entry.target);
        draw(entry.target);
      });
    }, { rootMargin: "900px 0px" });
    // What is in view at the start is drawn at once, so that a page shown for a moment (or photographed) has its plots.
    figures.forEach((figure) => (!folded(figure) && figure.getBoundingClientRect().top < window.innerHeight + 300 ? draw(figure) : watch.observe(figure)));
    document.addEventListener("toggle", (event) => { if (event.target.open) event.target.querySelectorAll("figure.plot").forEach(draw); }, true);
    darkScreen.addEventListener("change", redraw);

    // A link to what is folded unfolds it.
    function unfold(hash) {
      const target = hash.length > 1 ? document.getElementById(decodeURIComponent(hash.slice(1))) : null;
      if (target && target.tagName === "DETAILS") target.open = true;
    }
    document.addEventListener("click", (event) => {
      const link = event.target.closest ? event.target.closest("a[href^='#']") : null;
      if (link) unfold(link.getAttribute("href"));
    });
    unfold(location.hash);

    // ---- each plot, to take away ----
    figures.forEach((figure) => {
      const title = figure.querySelector("h3"), tools = document.createElement("span");
      const name = figure.querySelector("canvas").getAttribute("aria-label").replace(/[^A-Za-z0-9]+/g, "_").slice(0, 80);
      tools.className = "save";
      [["SVG", (chart) => handOut(new Blob([svgOf(chart)], { type: "image/svg+xml" }), name + ".svg")],
       ["PNG", (chart) => chart.canvas.toBlob((blob) => handOut(blob, name + ".png"))]].forEach(([kind, save]) => {
        const button = document.createElement("button");
        button.type = "button";
        button.textContent = kind;
        button.title = "save this plot as " + kind;
        button.addEventListener("click", () => { draw(figure); save(charts.get(figure)); });
        tools.append(button);
      });
      if (title) title.append(tools);
    });

    // Paper has no viewport and is white: draw all that is not folded, at the width of the page.
    let opened = [];
    window.addEventListener("beforeprint", () => {
      opened = Array.from(document.querySelectorAll(openOnPaper || "#provenance details:not([open])"));
      opened.forEach((details) => { details.open = true; });
      onPaper = true;
      if (darkScreen.matches) redraw();
      figures.forEach(draw);
      charts.forEach((chart, figure) => {
        const size = sizeOnPaper(figure.dataset.kind, figure);
        if (Array.isArray(size)) chart.resize(size[0], size[1]);
        else chart.resize(690, size);
      });
    });
    window.addEventListener("afterprint", () => {
      onPaper = false;
      opened.forEach((details) => { details.open = false; });
      if (darkScreen.matches) redraw();
      charts.forEach((chart) => chart.resize());
    });

    // ---- the numbers, to take away ----
    const button = document.getElementById("download");
    if (button) { // the page holds all numbers
      button.hidden = false;
      button.addEventListener("click", () => {
        handOut(new Blob([JSON.stringify(report, null, 2) + "\n"], { type: "application/json" }), "report.json");
      });
    }

    return { figures, charts };
  }

  return { report, colours, numberText, positive, padded, linearRange, logAxis, whitePaper, legend, options, timeMarks, start };
})();
