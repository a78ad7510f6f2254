// Table of a campaign, sortable by any column, outliers first.
"use strict";

const page = JSON.parse(document.getElementById("data").textContent);
const DEGREES = 180 / Math.PI;
const tallest = Math.max(0.1, ...page.rows.flatMap((row) => row.spark));
const WIDE = 170;
const HIGH = 30;

function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

function figure(name, digits, scale = 1) {
  return {
    number: true,
    key: (row) => row.figures[name] ?? -1,
    cell: (row) => (row.figures[name] === undefined ? "" : (scale * row.figures[name]).toFixed(digits)),
  };
}

const COLUMNS = [
  { title: "score", number: true, falls: true, key: (row) => row.score ?? Infinity, cell: scoreCell },
  { title: "flight", key: (row) => row.file, cell: flightCell },
  { title: "outcome", key: (row) => row.outcome, cell: outcomeCell },
  { title: "s", number: true, key: (row) => row.duration, cell: (row) => row.duration.toFixed(1) },
  { title: "velocity error over time", wide: true, key: (row) => Math.max(0, ...row.spark), falls: true, cell: spark },
  { title: "left bounds", number: true, falls: true, key: (row) => row.left ?? -1, cell: (row) => (row.left === null ? "" : `${row.left} of ${row.primitives}`) },
  { title: "time-outs", number: true, falls: true, wide: true, key: (row) => row.timeouts, cell: (row) => String(row.timeouts) },
  { title: "forward, m/s", falls: true, wide: true, ...figure("forward", 3) },
  { title: "side, m/s", falls: true, wide: true, ...figure("side", 3) },
  { title: "yaw, deg/s", falls: true, wide: true, ...figure("yaw_rate", 2, DEGREES) },
  { title: "navigation, m", falls: true, wide: true, ...figure("navigation", 3) },
];
const sorting = { column: 0, falls: true };

function scoreCell(row) {
  const score = row.score === null ? "" : `${row.score.toFixed(1)} `;
  const strong = row.score === null || row.score > 3;
  return element("span", { className: strong ? "left" : "", title: "standard deviations above the median" }, score, element("span", { className: "hint" }, row.reason));
}

function flightCell(row) {
  return row.page ? element("a", { href: row.page }, row.file) : row.file;
}

function outcomeCell(row) {
  if (row.problem) return element("span", { className: "problem" }, row.problem);
  return element("span", { className: row.good ? "" : "left" }, row.outcome);
}

function spark(row) {
  if (!row.spark.length) return "";
  const step = WIDE / (row.spark.length - 1 || 1);
  const points = row.spark.map((value, i) => `${(i * step).toFixed(1)},${(HIGH - 1 - (value / tallest) * (HIGH - 3)).toFixed(1)}`).join(" ");
  const holder = element("span");
  holder.innerHTML = `<svg width="${WIDE}" height="${HIGH}" role="img" aria-label="at most ${Math.max(...row.spark).toFixed(2)} m/s">` +
    `<path d="M0 ${HIGH - 0.5}H${WIDE}" stroke="var(--line)"/><polyline points="${points}" fill="none" stroke="var(--actual)" stroke-width="1.2"/></svg>`;
  return holder;
}

function classOf(column) {
  return [column.number ? "number" : "", column.wide ? "wide" : ""].join(" ").trim();
}

function write() {
  const column = COLUMNS[sorting.column];
  const order = (a, b) => (column.key(a) < column.key(b) ? -1 : column.key(a) > column.key(b) ? 1 : 0);
  const rows = [...page.rows].sort((a, b) => (sorting.falls ? order(b, a) : order(a, b)));
  document.querySelector("#flights tbody").replaceChildren(...rows.map((row) =>
    element("tr", {}, ...COLUMNS.map((one) => element("td", { className: classOf(one) }, one.cell(row))))));
  const heads = COLUMNS.map((one, place) => {
    const chosen = place === sorting.column;
    const button = element("button", { type: "button" }, one.title + (chosen ? (sorting.falls ? " \u2193" : " \u2191") : ""));
    button.addEventListener("click", () => {
      sorting.falls = chosen ? !sorting.falls : Boolean(one.falls);
      sorting.column = place;
      write();
    });
    const head = element("th", { className: classOf(one) }, button);
    if (chosen) head.setAttribute("aria-sort", sorting.falls ? "descending" : "ascending");
    return head;
  });
  document.querySelector("#flights thead").replaceChildren(element("tr", {}, ...heads));
}

function setTheme(dark) {
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  document.getElementById("theme").textContent = dark ? "light" : "dark";
}

document.getElementById("title").textContent = page.title;
document.getElementById("subtitle").textContent = page.subtitle;
for (const tile of page.tiles) {
  const made = element("div", { className: `tile ${tile.tone}` });
  for (const name of ["label", "value", "note"]) made.append(element("span", { className: name }, tile[name]));
  document.getElementById("tiles").append(made);
}
const prefersDark = matchMedia("(prefers-color-scheme: dark)");
setTheme(prefersDark.matches);
prefersDark.addEventListener("change", () => setTheme(prefersDark.matches));
document.getElementById("theme").addEventListener("click", () => setTheme(document.documentElement.dataset.theme !== "dark"));
write();
