// The list of all devices of a fleet: found by words, a page of a hundred at a time. What it shows comes from the data of the page: columns
// of names, what tells a device's recordings apart (null: one each), types, batches, states and folders of reports.
reportPage.start({}, () => 320);
(function () {
  "use strict";
  const data = reportPage.report, rows = document.querySelector("#devices tbody"), PAGE = 100;
  if (rows === null) return;
  const search = document.getElementById("device-search"), chosen = document.getElementById("device-state"), place = document.getElementById("device-place");
  const STATES = [[4, "not characterized"], [8, "without a result yet"], [2, "fails a limit"], [1, "outlier"]];
  const recording = (i) => (data.recording === null ? "" : data.recording[i]);
  const words = data.device.map((name, i) => (name + " " + recording(i) + " " + data.types[data.type[i]] + " " + data.batches[data.batch[i]]).toLowerCase());
  let found = [], page = 0;

  // A relative address: no part of a folder's name is a scheme, a host, a query or a fragment.
  const address = (folder) => "./" + folder.split("/").map(encodeURIComponent).join("/") + "/report.html";
  const folderOf = (i) => (Array.isArray(data.report) ? data.report[i] : data.report === null ? "" : data.report + data.device[i]);

  function cell(row, text) {
    const td = document.createElement("td");
    td.textContent = text;
    row.append(td);
    return td;
  }
  function show() {
    const pages = Math.max(1, Math.ceil(found.length / PAGE));
    page = Math.min(Math.max(0, page), pages - 1);
    rows.textContent = "";
    found.slice(page * PAGE, (page + 1) * PAGE).forEach((i) => {
      const row = document.createElement("tr"), first = cell(row, ""), folder = folderOf(i);
      if (folder) {
        const link = document.createElement("a");
        link.href = address(folder);
        link.textContent = data.device[i];
        first.append(link);
      } else first.textContent = data.device[i];
      if (data.recording !== null) cell(row, recording(i));
      if (data.types.some(Boolean)) cell(row, data.types[data.type[i]]);
      if (data.batches.some(Boolean)) cell(row, data.batches[data.batch[i]]);
      const state = STATES.filter(([bit]) => data.state[i] & bit).map(([, word]) => word).join(", ");
      if (data.state.some(Boolean)) cell(row, state).className = state ? "out" : "";
      rows.append(row);
    });
    place.textContent = found.length ? "page " + (page + 1) + " of " + pages + ", " + found.length + " of " + data.device.length + " recordings" : "none of " + data.device.length + " recordings";
  }
  function look() {
    const wanted = search.value.toLowerCase().split(/\s+/).filter(Boolean), bit = Number(chosen.value);
    found = [];
    words.forEach((text, i) => { if ((!bit || data.state[i] & bit) && wanted.every((w) => text.includes(w))) found.push(i); });
    page = 0;
    show();
  }
  search.addEventListener("input", look);
  chosen.addEventListener("change", look);
  document.getElementById("device-before").addEventListener("click", () => { --page; show(); });
  document.getElementById("device-next").addEventListener("click", () => { ++page; show(); });
  document.querySelectorAll(".controls[hidden]").forEach((box) => { box.hidden = false; });
  look();
})();
