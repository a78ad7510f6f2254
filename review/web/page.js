// Head, tiles, scorecard, events, facts and theme of the page.
"use strict";

function writeHead() {
  document.getElementById("eyebrow").textContent = page.eyebrow;
  document.getElementById("title").textContent = page.title;
  document.getElementById("subtitle").textContent = page.subtitle;
  document.getElementById("footer").textContent = page.footer;
}

function goTo(time) {
  const span = Math.min(duration, Math.max(6, 0.08 * duration));
  showRange(time - span / 2, time + span / 2);
  document.getElementById("lane-frame").scrollIntoView({ behavior: "smooth", block: "start" });
}

function writeTiles() {
  if (comparing) return;
  for (const tile of flights[0].tiles) {
    const made = element(tile.time === null ? "div" : "button", { className: `tile ${tile.tone}` });
    for (const name of ["label", "value", "note"]) made.append(element("span", { className: name }, tile[name]));
    if (tile.time !== null) {
      made.type = "button";
      made.addEventListener("click", () => goTo(tile.time));
    }
    document.getElementById("tiles").append(made);
  }
}

function writeScorecard() {
  if (!page.scorecard.length) return;
  const section = document.getElementById("scorecard");
  const head = element("tr", {}, element("th", {}, element("button", { type: "button" }, "")));
  for (const flight of flights) head.append(element("th", { className: "number" }, element("button", { type: "button" }, flight.label)));
  const rows = page.scorecard.map(([name, ...values]) =>
    element("tr", {}, element("td", {}, name), ...values.map((value) => element("td", { className: "number" }, value))));
  const table = element("table", {}, element("thead", {}, head), element("tbody", {}, ...rows));
  section.append(element("h2", {}, "Comparison"), element("div", { className: "scroll" }, table));
  section.hidden = false;
}

function writeEvents() {
  const events = flights.flatMap((flight) => flight.events.map((event) => ({ ...event, flight: flight.label })));
  events.sort((a, b) => a.time - b.time);
  const body = document.querySelector("#events tbody");
  document.getElementById("events-section").hidden = events.length === 0;
  for (const event of events) {
    const source = comparing ? `${event.flight}: ${event.source}` : event.source;
    const row = element("tr", { className: event.level, tabIndex: 0 });
    row.append(element("td", {}, `${event.time.toFixed(2)} s`), element("td", {}, source), element("td", {}, event.text));
    row.addEventListener("click", () => goTo(event.time));
    row.addEventListener("keydown", (key) => { if (key.key === "Enter") goTo(event.time); });
    body.append(row);
  }
}

function writeFacts() {
  const root = document.getElementById("facts");
  for (const flight of flights) {
    if (comparing) root.append(element("h3", {}, flight.label));
    const list = element("dl", { className: "facts" });
    for (const [name, value] of flight.facts) list.append(element("dt", {}, name), element("dd", {}, value));
    root.append(list);
  }
}

function setTheme(dark) {
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  document.getElementById("theme").textContent = dark ? "light" : "dark";
  notify("theme");
}

const prefersDark = matchMedia("(prefers-color-scheme: dark)");
document.documentElement.dataset.theme = prefersDark.matches ? "dark" : "light";
writeHead();
writeTiles();
writeScorecard();
writeEvents();
writeFacts();
setUpTable();
setUpView();
setUpPlots();
setUpSpectra();
setUpLane();
setTheme(prefersDark.matches);
prefersDark.addEventListener("change", () => setTheme(prefersDark.matches));
document.getElementById("theme").addEventListener("click", () => setTheme(!isDark()));
