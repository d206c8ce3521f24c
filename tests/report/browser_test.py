"""Opens reports in headless Chromium, as a reader would: no console message, no request, plots drawn, nothing injected.

usage: browser_test.py MAKE_REPORT MAKE_REPLAY_REPORT MAKE_FLEET [REPORT.html…]
MAKE_REPORT writes reports of synthetic characterizations, MAKE_REPLAY_REPORT those of synthetic replays,
MAKE_FLEET those of synthetic fleets; reports given beside them are opened as well.
The browser is driven over plain HTTP (the WebDriver protocol), with Python's standard library only.
"""
import base64
import contextlib
import http.client
import json
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time

SKIPPED = 77


class Browser:
    def __init__(self, folder):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        self.driver = subprocess.Popen([shutil.which("chromedriver"), f"--port={self.port}"],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.session = ""
        self.wait_for_driver()
        arguments = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                     "--disable-background-networking",
                     "--disable-component-update", "--disable-sync", "--window-size=1280,900",
                     f"--user-data-dir={folder}"]
        options = {"args": arguments, "binary": shutil.which("chromium"),
                   "perfLoggingPrefs": {"enableNetwork": True, "enablePage": False}}
        capabilities = {"browserName": "chrome", "goog:chromeOptions": options,
                        "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"}}
        self.session = "/session/" + self.call("POST", "/session",
                                               {"capabilities": {"alwaysMatch": capabilities}})["sessionId"]

    def wait_for_driver(self):
        for _ in range(200):
            try:
                if self.call("GET", "/status")["ready"]:
                    return
            except OSError:
                time.sleep(0.1)
        raise RuntimeError("chromedriver does not answer")

    def call(self, method, path, body=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=120)
        connection.request(method, self.session + path, None if body is None else json.dumps(body),
                           {"Content-Type": "application/json"})
        value = json.loads(connection.getresponse().read())["value"]
        if isinstance(value, dict) and "error" in value:
            raise RuntimeError(value["message"])
        return value

    def open(self, address):
        self.call("POST", "/url", {"url": address})

    def run(self, script):
        return self.call("POST", "/execute/sync", {"script": script, "args": []})

    def until(self, script, seconds=20):
        end = time.time() + seconds
        while not self.run(script):
            if time.time() > end:
                return False
            time.sleep(0.05)
        return True

    def protocol(self, command, parameters=None):
        return self.call("POST", "/goog/cdp/execute", {"cmd": command, "params": parameters or {}})

    def console(self):
        return [entry["message"] for entry in self.call("POST", "/se/log", {"type": "browser"})]

    def requests(self):
        entries = [json.loads(entry["message"])["message"]
                   for entry in self.call("POST", "/se/log", {"type": "performance"})]
        return [e["params"]["request"]["url"] for e in entries if e["method"] == "Network.requestWillBeSent"]

    def close(self):
        with contextlib.suppress(Exception):
            self.call("DELETE", "")
        self.driver.terminate()
        self.driver.wait()


# A drawn plot has ink in the colours of the measurement, not just a white sheet.
BLUE = "pixels[i] < 90 && pixels[i + 2] > 110"
# Replays draw in eight colours; grids, axes and text are grey.
COLOURED = "Math.max(pixels[i], pixels[i + 1], pixels[i + 2]) - Math.min(pixels[i], pixels[i + 1], pixels[i + 2]) > 40"
INKED = """
return Array.from(document.querySelectorAll('figure.plot canvas')).map((canvas) => {
  const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
  let blue = 0;
  for (let i = 0; i < pixels.length; i += 4) if (INK && pixels[i + 3] > 200) ++blue;
  return blue;
});"""
INJECTED = ("return document.querySelectorAll('img, svg, iframe, object, embed, link, base, form, "
            "[onerror], [onload], [onmouseover], [onfocus]').length")
DRAWN = "return Object.keys(Chart.instances).length"
PLOTS = "return document.querySelectorAll('figure.plot').length"
DRAW_ALL = "window.dispatchEvent(new Event('beforeprint')); return Object.keys(Chart.instances).length"
UNFOLD = "document.querySelectorAll('details').forEach((d) => { d.open = true; })"

faults = []


def expect(condition, sentence):
    if not condition:
        faults.append(sentence)
        print("FAILED:", sentence)


def check_page(browser, page, plots=None, replay=False):
    address = page.resolve().as_uri()
    browser.requests()
    browser.open(address)
    count = browser.run(PLOTS)
    expect(plots is None or count == plots, f"{page}: {count} plots instead of {plots}")
    first = browser.run(DRAWN)
    if count:
        browser.run("document.querySelector('figure.plot').scrollIntoView()")
        expect(browser.until(DRAWN), f"{page}: no plot drawn in view")
    if count > 30:
        expect(first < count / 3, f"{page}: {first} of {count} plots were drawn at once")
    shown = browser.run("return Array.from(document.querySelectorAll('figure.plot')).filter((f) => "
                        "!f.closest('details:not([open])')).length")
    drawn = browser.run(DRAW_ALL)
    expect(replay or drawn >= shown, f"{page}: printing draws {drawn} of the {shown} plots that are not folded")
    browser.run(UNFOLD)
    expect(browser.until(f"return Object.keys(Chart.instances).length == {count}"),
           f"{page}: unfolding does not draw every plot")
    browser.run("window.dispatchEvent(new Event('afterprint'))")
    ink = browser.run(INKED.replace("INK", COLOURED if replay else BLUE))
    expect(all(blue > 50 for blue in ink), f"{page}: empty plots, ink {ink}")
    expect(browser.run("return document.querySelectorAll('script').length") == 3, f"{page}: a script was added")
    expect(browser.run(INJECTED) == 0, f"{page}: an element or handler came from the input")
    expect(browser.run("return window.broken === undefined"), f"{page}: injected code ran")
    expect(browser.run("return performance.getEntriesByType('resource').length") == 0, f"{page}: resources were loaded")
    check_axes(browser, page)
    if replay:
        check_controls(browser, page)
    else:
        check_scales(browser, page)
    check_download(browser, page)
    # chrome:// and a one-pixel image that our page does not hold are the browser's own empty tab.
    source = page.read_text()
    ours = lambda r: r != address and not r.startswith("chrome://") and not (r.startswith("data:") and r not in source)
    console, requests = browser.console(), [r for r in browser.requests() if ours(r)]
    expect(not console, f"{page}: console says {console[:3]}")
    expect(all(r.startswith("blob:") for r in requests), f"{page}: requests {requests[:3]}")
    print(f"{page}: {count} plots, {first} at once, {page.stat().st_size / 1e6:.2f} MB")


def check_axes(browser, page):
    """Sidedness on the axis, and no value that a logarithmic axis cannot hold."""
    titles = browser.run("return Object.values(Chart.instances).map((c) => c.options.scales.y.title.text)")
    spectra = [t for t in titles if "Hz" in t]
    expect(all("ne-sided" in t or "wo-sided" in t for t in spectra), f"{page}: a spectrum without its sides: {spectra}")
    bad = browser.run("""return Object.values(Chart.instances).filter((c) => c.options.scales.y.type === 'logarithmic')
      .flatMap((c) => c.data.datasets.flatMap((d) => d.data.map((p) => [c.options.scales.x.type === 'logarithmic' ? p.x : 1, p.y])))
      .filter(([x, y]) => x <= 0 || y <= 0).length""")
    expect(bad == 0, f"{page}: {bad} points at or below zero on logarithmic axes")


def check_scales(browser, page):
    """Nothing that is drawn leaves the sheet without a mark: the fitted line on its axes, every residual in
    its plot."""
    outside = browser.run("""return Object.values(Chart.instances).filter((c) => c.options.scales.y.type === 'logarithmic').filter((c) => {
      const of = (name) => (c.data.datasets.find((d) => d.label === name) || { data: [] }).data.map((p) => p.y);
      const measured = of('measured'), top = c.options.scales.y.max, bottom = c.options.scales.y.min;
      const near = (y) => y < 30 * Math.max(...measured) && y > Math.min(...measured) / 30;
      return measured.length && of('fitted model').some((y) => near(y) && (y > top || y < bottom));
    }).length""")
    expect(outside == 0, f"{page}: {outside} plots whose fitted line leaves the sheet")
    lost = browser.run("""const report = JSON.parse(document.getElementById('report-data').textContent);
      return Array.from(document.querySelectorAll('figure[data-kind=residuals]')).filter((figure) => {
        const sets = Chart.getChart(figure.querySelector('canvas')).data.datasets, z = report.fit.channels[Number(figure.dataset.channel)].residuals.z;
        const top = Chart.getChart(figure.querySelector('canvas')).options.scales.y.max;
        const beyond = sets.find((d) => d.note !== undefined);
        return beyond.data.length !== z.filter((v) => v !== null && Math.abs(v) > top).length || (beyond.data.length > 0) !== (beyond.note !== '')
          || sets[0].data.some((p) => Math.abs(p.y) > top);
      }).length""")
    expect(lost == 0, f"{page}: {lost} residual plots that hide points")


def check_controls(browser, page):
    """The boxes choose the lines, the sliders and the pointer the stretch, a click on a head the order of the table."""
    settled = "return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
    lines = """
        const methods = (d) => d.label && d.label !== 'optimum of this scene';
        return Array.from(document.querySelectorAll('figure[data-kind=window]'))
            .map((f) => Chart.getChart(f.querySelector('canvas')).data.datasets.filter(methods).length)"""
    if browser.run("return document.querySelectorAll('.shown input').length && "
                   "document.querySelectorAll('figure[data-kind=window]').length"):
        count = browser.run("return document.querySelectorAll('.shown input').length")
        few = browser.run(lines)
        expect(all(0 < n <= 6 for n in few), f"{page}: {few} lines at first")
        browser.run("Array.from(document.querySelectorAll('.shown button')).find((b) => b.textContent === "
                    "'all').click()")
        browser.run(settled)
        many = browser.run(lines)
        expect(all(n == count for n in many), f"{page}: {many} lines instead of {count} after 'all'")
    ranges = """return Object.values(Chart.instances).filter((c) => c.canvas.closest('.over-time'))
        .map((c) => [c.scales.x.min, c.scales.x.max])"""
    whole = browser.run(ranges)
    if whole:
        browser.run("const s = document.querySelectorAll('.controls input[type=range]'); s[0].value = 250; "
                    "s[0].dispatchEvent(new Event('input'))")
        browser.run(settled)
        part = browser.run(ranges)
        expect(all(abs(p[0] - (w[0] + 0.25 * (w[1] - w[0]))) < 1e-6 * w[1] for p, w in zip(part, whole)),
               f"{page}: the slider left {part}")
        browser.run("""const canvas = document.querySelector('.over-time canvas'), area = Chart.getChart(canvas).chartArea, box = canvas.getBoundingClientRect();
          canvas.setPointerCapture = () => {};
          const at = (type, share) => canvas.dispatchEvent(new PointerEvent(type, { button: 0, clientX: box.left + area.left + share * (area.right - area.left), clientY: box.top + area.top + 20, bubbles: true }));
          at('pointerdown', 0.4); at('pointermove', 0.5); at('pointerup', 0.6);""")
        browser.run(settled)
        closer = browser.run(ranges)
        expect(all(p[0] > q[0] and p[1] < q[1] and p[1] > p[0] for p, q in zip(closer, part)),
               f"{page}: dragging left {closer}")
        browser.run("Array.from(document.querySelectorAll('.controls button')).find((b) => b.textContent === 'whole "
                    "run').click()")
        browser.run(settled)
        expect(browser.run(ranges) == whole, f"{page}: 'whole run' did not bring it back")
        options = browser.run("return document.querySelectorAll('.controls option').length")
        for i in range(min(options, 4)):
            browser.run(f"const s = document.querySelector('.controls select'); s.value = {i}; s.dispatchEvent(new "
                        f"Event('change'))")
            browser.run(settled)
    # Every column once each way: figures rise, then fall, and what has none stays last.
    wrong = browser.run("""const table = document.querySelector('table.ranking'), head = table.tHead.rows[0].cells, wrong = [];
      const values = (column) => Array.from(table.tBodies[0].rows).map((r) => r.cells[column].dataset.value).filter((v) => v).map(Number);
      for (let c = 1; c < head.length; ++c) for (const way of [1, -1]) {
        head[c].click();
        if (values(c).some((v, i, all) => i && way * (v - all[i - 1]) < 0)) wrong.push(head[c].textContent);
      }
      return wrong;""")
    expect(not wrong, f"{page}: columns {wrong} are not sorted")


def check_download(browser, page):
    """The button hands out the document of report.json, the measured time apart."""
    beside = page.with_name("report.json")
    if not beside.exists():
        return
    browser.run("""window.taken = null; const make = URL.createObjectURL;
      URL.createObjectURL = (blob) => { blob.text().then((text) => { window.taken = text; }); return make.call(URL, blob); };
      HTMLAnchorElement.prototype.click = function () { window.name_taken = this.download; };
      document.getElementById('download').click();""")
    expect(browser.until("return window.taken !== null"), f"{page}: nothing to download")
    document, expected = json.loads(browser.run("return window.taken")), json.loads(beside.read_text())
    expected.pop("measured", None)
    expect(document == expected, f"{page}: the download differs from report.json")
    expect(browser.run("return window.name_taken") == "report.json", f"{page}: the download has another name")


def check_widths(browser, page, widths=(420,)):
    """No window scrolls sideways, folded or not."""
    for width in widths:
        browser.protocol("Emulation.setDeviceMetricsOverride",
                         {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": False})
        browser.open(page.resolve().as_uri())
        for state in ("folded", "unfolded"):
            wide = browser.run("return document.documentElement.scrollWidth")
            expect(wide <= width, f"{page}: {wide} pixels wide in a window of {width}, {state}")
            if len(widths) == 1:
                break
            browser.run(UNFOLD)
    browser.protocol("Emulation.clearDeviceMetricsOverride")


def check_folded(browser, page, most):
    """However many channels there are, the page that opens can be overlooked."""
    browser.protocol("Emulation.setDeviceMetricsOverride",
                     {"width": 1400, "height": 900, "deviceScaleFactor": 1, "mobile": False})
    browser.open(page.resolve().as_uri())
    height = browser.run("return document.documentElement.scrollHeight")
    expect(height <= most, f"{page}: {height} pixels tall, more than {most}")
    target = browser.run("const link = document.querySelector('ul.sensors a'); link.click(); return "
                         "document.getElementById(link.getAttribute('href').slice(1)).open")
    expect(target, f"{page}: a link to a channel does not unfold it")
    browser.protocol("Emulation.clearDeviceMetricsOverride")


def check_dark(browser, page):
    """On a dark screen plots and page are dark and readable; paper stays white."""
    media = lambda scheme: browser.protocol("Emulation.setEmulatedMedia",
                                            {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
    corner = """const canvas = document.querySelector('figure.plot canvas');
        const p = canvas.getContext('2d').getImageData(1, 1, 1, 1).data;
        return p[0] + p[1] + p[2];"""
    media("dark")
    browser.open(page.resolve().as_uri())
    browser.until(DRAWN)
    expect(browser.run(corner) < 150, f"{page}: plots stay white on a dark screen")
    lightness = browser.run("return [getComputedStyle(document.body).backgroundColor, "
                            "getComputedStyle(document.body).color].map((c) => c.match(/\\d+/g).slice(0, "
                            "3).reduce((a, b) => a + Number(b), 0))")
    expect(lightness[0] < 150 < 500 < lightness[1], f"{page}: dark colours are {lightness}")
    browser.run("window.dispatchEvent(new Event('beforeprint'))")
    expect(browser.run(corner) == 765, f"{page}: paper is dark")
    browser.run("window.dispatchEvent(new Event('afterprint'))")
    expect(browser.run(corner) < 150, f"{page}: the screen stays white after printing")
    media("light")
    expect(browser.until("return getComputedStyle(document.body).backgroundColor === 'rgb(255, 255, 255)'"),
           f"{page}: the light colours do not come back")
    browser.protocol("Emulation.setEmulatedMedia", {"features": []})
    browser.console()  # has advice about our reading of pixels


def check_saving(browser, page):
    """Every plot can be saved: SVG that parses and holds the drawing, PNG that is one."""
    browser.open(page.resolve().as_uri())
    browser.run(UNFOLD)
    browser.run("""window.saved = []; window.types = [];
      URL.createObjectURL = (blob) => { window.types.push(blob.type); blob.arrayBuffer().then((bytes) => window.saved.push(new Uint8Array(bytes))); return 'blob:none'; };
      HTMLAnchorElement.prototype.click = function () {};
      document.querySelectorAll('.save button').forEach((b) => b.click());""")
    wanted = 2 * browser.run(PLOTS)
    expect(browser.until(f"return window.saved.length === {wanted}"),
           f"{page}: {browser.run('return window.saved.length')} of {wanted} plots saved")
    texts = browser.run("return window.saved.map((bytes) => new TextDecoder('latin1').decode(bytes.slice(0, 8)) + "
                        "'').filter((t) => !t.startsWith('<svg') && !t.includes('PNG'))")
    expect(not texts, f"{page}: saved {texts[:3]}")
    wrong = browser.run("""return window.saved.filter((bytes) => bytes[0] === 60).map((bytes) => new DOMParser().parseFromString(new TextDecoder().decode(bytes), 'image/svg+xml'))
      .filter((svg) => svg.querySelector('parsererror') || svg.querySelectorAll('path').length < 8 || svg.querySelectorAll('text').length < 4 || svg.querySelector('script, image, a')).length""")
    expect(wrong == 0, f"{page}: {wrong} saved drawings are empty, broken or hold something else")
    console = browser.console()
    expect(not console, f"{page}: saving says {console[:3]}")


def check_labels(browser, page, widths=(390, 800, 1400)):
    """No text of a plot over another, by the text boxes of its SVG; a trace has two numbers at least on each axis."""
    for width in widths:
        browser.protocol("Emulation.setDeviceMetricsOverride",
                         {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": False})
        browser.open(page.resolve().as_uri())
        browser.run(UNFOLD)
        browser.run(DRAW_ALL)
        browser.run("window.dispatchEvent(new Event('afterprint'))")
        browser.run("""window.saved = [];
          URL.createObjectURL = (blob) => { blob.text().then((text) => window.saved.push(text)); return 'blob:none'; };
          HTMLAnchorElement.prototype.click = function () {};
          document.querySelectorAll('figure.plot .save button:first-child').forEach((b) => b.click());""")
        count = browser.run(PLOTS)
        expect(browser.until(f"return window.saved.length === {count}"), f"{page}: plots not saved at {width}")
        over = browser.run("""const over = [];
          window.saved.forEach((svg) => {
            const place = document.createElement('div');
            place.innerHTML = svg;
            document.body.append(place);
            const texts = Array.from(place.querySelectorAll('text')).filter((t) => t.getAttribute('fill') !== 'none');
            const boxes = texts.map((t) => [t.textContent, t.getBoundingClientRect()]).filter(([text, b]) => text.trim() && b.width);
            boxes.forEach(([a, p], i) => boxes.slice(i + 1).forEach(([b, q]) => {
              const wide = Math.min(p.right, q.right) - Math.max(p.left, q.left), tall = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
              if (wide > 1 && tall > 3) over.push(a + ' over ' + b);
            }));
            place.remove();
          });
          return over;""")
        expect(not over, f"{page}: at {width} pixels {len(over)} labels lie over each other: {over[:6]}")
        bare = browser.run("""return Array.from(document.querySelectorAll('figure[data-kind=trace]')).filter((f) => {
            const scales = Chart.getChart(f.querySelector('canvas')).scales;
            return scales.x.ticks.length < 2 || scales.y.ticks.length < 2;
          }).length""")
        expect(bare == 0, f"{page}: at {width} pixels {bare} traces have an axis without two numbers")
        long = browser.run("""return Array.from(document.querySelectorAll('figure[data-kind=trace]')).flatMap((f) => {
            const ticks = Chart.getChart(f.querySelector('canvas')).scales.y.ticks.map((t) => t.value);
            const step = ticks[1] - ticks[0], digit = Number(step.toExponential(6).split('e')[0]);
            return [1, 2, 5].includes(digit) && Math.abs(ticks[0] / step - Math.round(ticks[0] / step)) < 1e-6 ? [] : [ticks];
          })""")
        expect(not long, f"{page}: at {width} pixels a trace has uneven numbers at its axis: {long[:2]}")
    browser.protocol("Emulation.clearDeviceMetricsOverride")
    browser.console()


def check_drawings(browser, page, widths=(390, 800, 1400)):
    """Drawings of a lot, bench or comparison fit the window, have letters of ten pixels, and no text over another."""
    for width in widths:
        browser.protocol("Emulation.setDeviceMetricsOverride",
                         {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": False})
        browser.open(page.resolve().as_uri())
        browser.run(UNFOLD)
        least, wide, over, count = browser.run("""
          const svgs = Array.from(document.querySelectorAll('figure.curves svg')).filter((svg) => svg.getBoundingClientRect().width);
          const texts = (svg) => Array.from(svg.querySelectorAll('text')).filter((t) => t.textContent.trim());
          const over = [];
          svgs.forEach((svg) => {
            const boxes = texts(svg).map((t) => [t.textContent, t.getBoundingClientRect()]);
            boxes.forEach(([a, p], i) => boxes.slice(i + 1).forEach(([b, q]) => {
              const x = Math.min(p.right, q.right) - Math.max(p.left, q.left), y = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
              // A line's box has room above capitals and below the base line.
              if (a !== b && x > 1 && y > 0.36 * Math.min(p.height, q.height)) over.push(a + ' over ' + b);
            }));
          });
          const sizes = svgs.flatMap((svg) => texts(svg).map((t) => Number(t.getAttribute('font-size')))
            .filter((size) => size > 6).map((size) => size * svg.getBoundingClientRect().width / svg.viewBox.baseVal.width));
          return [Math.min(...sizes), svgs.filter((svg) => svg.getBoundingClientRect().right > innerWidth + 1).length, over, svgs.length];""")
        expect(count > 0, f"{page}: no drawing at {width} pixels")
        expect(least is None or least >= 9.9, f"{page}: letters of {least} pixels at {width}")
        expect(wide == 0, f"{page}: {wide} drawings are wider than {width} pixels")
        expect(not over, f"{page}: at {width} pixels {len(over)} labels lie over each other: {over[:6]}")
    browser.protocol("Emulation.clearDeviceMetricsOverride")


def check_colours(browser, page):
    """A sensor has one colour in every plot, and so has a method; the first of them are all different. The ranking
    has the best in its colour, and no other."""
    browser.open(page.resolve().as_uri())
    browser.run(UNFOLD)
    browser.run(DRAW_ALL)
    found = browser.run("""const report = JSON.parse(document.getElementById('report-data').textContent), sensors = report.sensors.map((s) => s.name), methods = report.algorithms.map((a) => a.label), out = {};
      const note = (name, ink) => { (out[name] = out[name] || []).push(ink); };
      Object.values(Chart.instances).forEach((c) => c.data.datasets.forEach((set) => {
        const name = sensors.concat(methods).find((n) => [n, 'error of ' + n, 'fused by ' + n, n + ', the best single sensor', 'best single sensor: ' + n].includes(set.label));
        if (name && typeof set.borderColor === 'string') note(name, set.borderColor);
        if (set.intervals) set.data.forEach((p, i) => { if (p.s || p.a.label === report.best) note(p.s ? p.s.name : report.best, set.pointBorderColor[i]); });
      }));
      return out;""")
    expect(len(found) > 12, f"{page}: only {len(found)} lines with a name")
    for name, inks in found.items():
        expect(len(set(inks)) == 1, f"{page}: {name} has the colours {sorted(set(inks))}")
    expect(sum(len(inks) > 2 for inks in found.values()) > 5, f"{page}: no line stands in several plots")


def check_without_weights(browser, page, method):
    """A chart of weights or variances that the chosen method does not have is a sentence, not an empty sheet."""
    browser.open(page.resolve().as_uri())
    browser.run(UNFOLD)
    browser.run(DRAW_ALL)
    browser.run("const c = document.querySelector('.choice select');"
                f"c.value = Array.from(c.options).findIndex((o) => o.textContent === '{method}');"
                "c.dispatchEvent(new Event('change'))")
    said = "Array.from(document.querySelectorAll('figure.weights .nothing')).map((n) => n.textContent)"
    expect(browser.until(f"return {said}.join().includes('{method}')"), f"{page}: no sentence about {method}'s weights")
    for kind in ("weights", "variances"):
        part = f"document.querySelector('figure.{kind} "
        drawn = browser.run(f"return {part}.canvas').offsetHeight > 50")
        note = browser.run(f"return {part}.nothing').offsetHeight > 5")
        expect(drawn != note, f"{page}: {kind} of {method}: chart {drawn}, sentence {note}")
    expect(not browser.console(), f"{page}: console says something about {method}")


def check_copying(browser, page):
    """The buttons copy every weight to its last digit, as CSV and as YAML; without a clipboard the text is
    there to be taken by hand."""
    browser.open(page.resolve().as_uri())
    browser.run("""window.copied = []; Object.defineProperty(navigator, 'clipboard', { value: { writeText: (t) => { window.copied.push(t); return Promise.resolve(); } } });
      document.querySelectorAll('.copy-place button').forEach((b) => b.click());""")
    expect(browser.until("return window.copied.length >= 2"), f"{page}: nothing copied")
    csv, yaml = browser.run("return window.copied")[:2]
    report = json.loads(page.with_name("report.json").read_text())
    rows = [line.split(",") for line in csv.splitlines()]
    expect(rows[0] == ["algorithm", "what"] + [s["name"] for s in report["sensors"]],
           f"{page}: the copied table begins with {rows[0]}")
    for a in report["algorithms"]:
        if a["status"] != "ran" or not a["weights"]:
            continue
        mine = [row[2:] for row in rows if row[:2] == [a["label"], "weights"]]
        expect(len(mine) == 1 and [float(v) for v in mine[0]] == a["weights"],
               f"{page}: the weights of {a['label']} are copied as {mine}")
        expect(f"{a['label']}:\n  weights:\n    {report['sensors'][0]['name']}: " in yaml,
               f"{page}: {a['label']} is not in the YAML")
    browser.run("Object.defineProperty(window, 'isSecureContext', { value: false }); document.execCommand = () => "
                "false; document.querySelector('.copy-place button').click()")
    expect(browser.run("return (document.querySelector('.copy-place textarea') || {}).value") == csv,
           f"{page}: no text to copy by hand")
    browser.console()


def check_paper(browser, page, most):
    browser.open(page.resolve().as_uri())
    pdf = base64.b64decode(browser.protocol("Page.printToPDF",
                                            {"preferCSSPageSize": True, "printBackground": True})["data"])
    pages = len(re.findall(rb"/Type\s*/Page\b", pdf))
    expect(0 < pages <= most, f"{page}: {pages} pages of paper, more than {most}")
    if not shutil.which("pdftotext"):
        return
    texts = subprocess.run(["pdftotext", "-layout", "-", "-"], input=pdf, stdout=subprocess.PIPE, check=True).stdout
    headings = set(browser.run("return Array.from(document.querySelectorAll('h2, h3')).map((h) => h.innerText.trim())"))
    last = [text.split("\n")[-1].strip() for text in map(str.strip, texts.decode().split("\f")) if text]
    expect(not headings & set(last), f"{page}: a page of paper ends with the heading {headings & set(last)}")


def check_without_script(browser, page):
    browser.protocol("Emulation.setScriptExecutionDisabled", {"value": True})
    browser.open(page.resolve().as_uri())
    browser.protocol("Emulation.setScriptExecutionDisabled", {"value": False})
    text = browser.run("return document.body.innerText")
    expect("Every number is in the tables" in text, f"{page}: no notice without scripts")


def check_fleet(browser, page, devices):
    """The list of devices is found by words, shown by the hundred and linked; the page opens at once whatever
    their number."""
    address = page.resolve().as_uri()
    browser.requests()
    began = time.time()
    browser.open(address)
    seconds = time.time() - began
    rows = """return Array.from(document.querySelectorAll('#devices tbody tr'))
        .map((r) => Array.from(r.cells).map((c) => c.textContent))"""
    shown = browser.run(rows)
    expect(len(shown) == min(100, devices), f"{page}: {len(shown)} rows of devices at first")
    expect(browser.run("return document.querySelectorAll('*').length") < 20000, f"{page}: too many elements")
    browser.run("document.getElementById('device-next').click()")
    expect(devices <= 100 or browser.run(rows)[0] != shown[0], f"{page}: the next page is the same")
    browser.run("const s = document.getElementById('device-search'); s.value = '2024-03 -9'; s.dispatchEvent(new "
                "Event('input'))")
    found = browser.run(rows)
    expect(found and all("2024-03" in r[2] and "-9" in r[0] + r[2] for r in found),
           f"{page}: searching finds {found[:3]}")
    browser.run("""document.getElementById('device-search').value = '';
        const c = document.getElementById('device-state');
        c.value = '1';
        c.dispatchEvent(new Event('change'))""")
    odd = browser.run(rows)
    expect(odd and all("outlier" in r[3] for r in odd), f"{page}: the outliers are {odd[:3]}")
    links = browser.run("return Array.from(document.querySelectorAll('main a[href]')).map((a) => a.href)")
    base = address.rsplit("/", 1)[0] + "/"
    expect(links and all(link.startswith(base) and link.endswith("/report.html") for link in links),
           f"{page}: links to {[l for l in links if not l.startswith(base)][:3]}")
    expect(browser.run("return document.querySelectorAll('script').length") == 3, f"{page}: a script was added")
    expect(browser.run("return document.querySelectorAll('img, iframe, object, embed, link, base, form, [onerror], "
                       "[onload]').length") == 0, f"{page}: an element or handler came from the input")
    expect(browser.run("return window.broken === undefined"), f"{page}: injected code ran")
    console, requests = browser.console(), [r for r in browser.requests() if r != address and not r.startswith(("chrome://", "data:"))]
    expect(not console, f"{page}: console says {console[:3]}")
    expect(not requests, f"{page}: requests {requests[:3]}")
    print(f"{page}: {devices} devices, opened in {seconds:.2f} s, {page.stat().st_size / 1e6:.2f} MB")


def check_ends(browser, page):
    """A page whose values are at the ends of the doubles opens: the loops over its ticks end."""
    browser.open(page.resolve().as_uri())
    browser.run(UNFOLD)
    try:
        drawn, count = browser.run(DRAW_ALL), browser.run(PLOTS)
        expect(drawn == count, f"{page}: {drawn} of {count} plots are drawn")
        console = browser.console()
        expect(not console, f"{page}: console says {console[:3]}")
    except RuntimeError as error:
        expect(False, f"{page}: {error}")
        raise


def main():
    if not shutil.which("chromium") or not shutil.which("chromedriver"):
        print("skipped: chromium and chromedriver (Debian: chromium, chromium-driver) are not both installed")
        return SKIPPED
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        browser = Browser(folder / "profile")
        try:
            for kind, plots in {"imu": 26, "hostile": 60, "many": 193, "empty": 3}.items():
                subprocess.run([sys.argv[1], kind, str(folder / kind)], check=True)
                check_page(browser, folder / kind / "report.html", plots)
            for kind in ("imu", "hostile"):
                check_widths(browser, folder / kind / "report.html", (390, 800, 1400))
                check_saving(browser, folder / kind / "report.html")
            check_labels(browser, folder / "imu/report.html")
            check_folded(browser, folder / "imu/report.html", 3500)
            check_folded(browser, folder / "many/report.html", 7000)
            check_dark(browser, folder / "imu/report.html")
            check_paper(browser, folder / "imu/report.html", 2)
            check_without_script(browser, folder / "imu/report.html")
            subprocess.run([sys.argv[1], "tiny", str(folder / "tiny")], check=True)
            check_ends(browser, folder / "tiny/report.html")
            for kind, plots in {"plain": 11, "large": 11, "inputs": 13, "blind": 8, "nothing": 1,
                                "hostile": 10}.items():
                subprocess.run([sys.argv[2], kind, str(folder / ("replay-" + kind))], check=True)
                check_page(browser, folder / ("replay-" + kind) / "report.html", plots, replay=True)
            for kind in ("plain", "blind", "hostile"):
                check_widths(browser, folder / ("replay-" + kind) / "report.html", (390, 800, 1400))
                check_saving(browser, folder / ("replay-" + kind) / "report.html")
            check_labels(browser, folder / "replay-plain/report.html")
            check_dark(browser, folder / "replay-plain/report.html")
            check_colours(browser, folder / "replay-large/report.html")
            check_copying(browser, folder / "replay-plain/report.html")
            check_without_weights(browser, folder / "replay-plain/report.html", "neural-simplex")
            check_paper(browser, folder / "replay-plain/report.html", 12)
            check_without_script(browser, folder / "replay-plain/report.html")
            for kind, devices in {"400": 400, "20000": 20000, "hostile": 40}.items():
                subprocess.run([sys.argv[3], kind, str(folder / ("fleet-" + kind))], check=True)
                check_fleet(browser, folder / ("fleet-" + kind) / "index.html", devices)
            check_widths(browser, folder / "fleet-400/index.html", (390, 800, 1400))
            check_drawings(browser, folder / "fleet-400/index.html")
            check_paper(browser, folder / "fleet-400/index.html", 12)
            for given in map(pathlib.Path, sys.argv[4:]):
                text = given.read_text()
                check_page(browser, given, replay="<title>Sensor fusion" in text[:4000])
                if '<figure class="curves">' in text:
                    check_drawings(browser, given)
        finally:
            browser.close()
    return 1 if faults else 0


sys.exit(main())
