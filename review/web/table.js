// Table of primitives: deviation and bound, sortable by any column.
"use strict";

const COLUMNS = [
  { title: "start, s", number: true, key: (row) => row.part.start },
  { title: "primitive", key: (row) => `${row.part.kind} ${String(row.part.id).padStart(5)}` },
  { title: "duration, s", number: true, key: (row) => row.part.end - row.part.start },
  { title: "worst", wide: true, key: (row) => (row.part.judged ? row.part.judged.number : "") },
  { title: "deviation", number: true, wide: true, key: (row) => (row.part.judged ? Math.abs(row.part.judged.deviation) : -1) },
  { title: "bound", number: true, wide: true, key: (row) => (row.part.judged ? row.part.judged.bound : -1) },
  { title: "% of bound", number: true, descends: true, key: (row) => (row.part.judged ? row.part.judged.share : -1) },
];

const sorting = { column: 0, falls: false };

function rowsOfFlights() {
  return flights.flatMap((flight, number) => flight.primitives.map((part, place) => ({ part, place, number })));
}

function classOf(column) {
  return [column.number ? "number" : "", column.wide ? "wide" : ""].join(" ").trim();
}

function signed(value) {
  return `${value < 0 ? "\u2212" : "+"}${Math.abs(value).toFixed(2)}`;
}

function shareCell(judged) {
  if (!judged) return element("span", { className: "hint" }, "not checked");
  // The bar's middle marks the bound; a full bar is twice the bound or more.
  const bar = element("span", { className: judged.left ? "share over" : "share", title: "the middle mark is the bound" });
  bar.append(element("i", { style: `width: ${Math.min(50 * judged.share, 100)}%` }), element("b"));
  const text = element("span", { className: judged.left ? "left" : "" }, ` ${Math.round(100 * judged.share)} %`);
  return element("span", { style: "white-space: nowrap" }, bar, text);
}

function cells(row) {
  const { part, number } = row;
  const judged = part.judged;
  const chip = part.kind === "coast"
    ? element("i", { className: "chip", style: `background: ${shade(part.color)}` })
    : element("i", { className: "chip thin" });
  const name = part.kind === "coast" ? part.name : `${part.id}: ${part.from} \u2192 ${part.to}`;
  const title = part.kind === "coast" ? `trim ${part.name}` : `maneuver ${part.id}: ${part.name}`;
  const words = element("span", { title }, chip, comparing ? `${flights[number].label}: ${name}` : name);
  if (part.timedOut) words.append(element("span", { className: "left" }, " time-out"));
  const deviation = judged ? `${signed(judged.deviation)} ${judged.unit}` : "";
  return [
    part.start.toFixed(2), words, (part.end - part.start).toFixed(2), judged ? judged.number : "",
    element("span", { className: judged && judged.left ? "left" : "" }, deviation), judged ? judged.bound.toFixed(2) : "", shareCell(judged),
  ];
}

function writeRows() {
  const column = COLUMNS[sorting.column];
  const order = (a, b) => (column.key(a) < column.key(b) ? -1 : column.key(a) > column.key(b) ? 1 : a.part.start - b.part.start);
  const rows = rowsOfFlights().sort((a, b) => (sorting.falls ? -order(a, b) : order(a, b)));
  const body = document.querySelector("#primitives tbody");
  body.replaceChildren(...rows.map((row) => {
    const line = element("tr", { tabIndex: 0, className: isChosen(row.number, row.place) ? "chosen" : "" });
    line.dataset.place = row.place;
    line.dataset.flight = row.number;
    line.append(...cells(row).map((content, i) => element("td", { className: classOf(COLUMNS[i]) }, content)));
    return line;
  }));
}

function writeHeads() {
  const row = element("tr");
  COLUMNS.forEach((column, place) => {
    const head = element("th", { className: classOf(column) });
    const chosen = place === sorting.column;
    if (chosen) head.setAttribute("aria-sort", sorting.falls ? "descending" : "ascending");
    const button = element("button", { type: "button" }, column.title + (chosen ? (sorting.falls ? " \u2193" : " \u2191") : ""));
    button.addEventListener("click", () => {
      sorting.falls = chosen ? !sorting.falls : Boolean(column.descends);
      sorting.column = place;
      writeHeads();
      writeRows();
    });
    head.append(button);
    row.append(head);
  });
  document.querySelector("#primitives thead").replaceChildren(row);
}

function setUpTable() {
  const count = rowsOfFlights().length;
  if (!count) {
    document.getElementById("primitives-section").hidden = true;
    return;
  }
  document.getElementById("primitives-title").textContent = `${count} primitives`;
  const bounds = flights[0].library === null ? "" : `bounds of library ${flights[0].library}; `;
  document.getElementById("primitives-hint").textContent = `${bounds}click a row to zoom to it`;
  writeHeads();
  writeRows();
  const body = document.querySelector("#primitives tbody");
  const take = (event) => {
    const row = event.target.closest("tr");
    if (row) choose(Number(row.dataset.flight), Number(row.dataset.place));
  };
  body.addEventListener("click", take);
  body.addEventListener("keydown", (event) => { if (event.key === "Enter") take(event); });
  when("chosen", () => {
    for (const row of body.rows) {
      const chosen = isChosen(Number(row.dataset.flight), Number(row.dataset.place));
      row.className = chosen ? "chosen" : "";
      if (chosen) {
        const frame = body.closest(".scroll");
        const [top, bottom] = [row.offsetTop - 40, row.offsetTop + row.offsetHeight];
        if (top < frame.scrollTop) frame.scrollTop = top;
        else if (bottom > frame.scrollTop + frame.clientHeight) frame.scrollTop = bottom - frame.clientHeight;
      }
    }
  });
  when("theme", writeRows);
}
