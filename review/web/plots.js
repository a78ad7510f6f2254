// Linked plots: one canvas per panel, one time axis for all.
"use strict";

const AXIS = 56;
const RIGHT = 14;
const unpackedBases = new Map();
const plots = [];

function base(number) {
  if (!unpackedBases.has(number)) {
    const packed = page.bases[number];
    unpackedBases.set(number, { time: unpack(packed.time), columns: packed.columns.map(unpack) });
  }
  return unpackedBases.get(number);
}

function styleOf(curve) {
  const compared = comparing ? flightColor(curve.flight) : null;
  const styles = {
    commanded: { stroke: compared || css("--commanded"), width: 1.3, dash: [6, 4] },
    estimated: { stroke: css("--estimated"), width: 1.3 },
    actual: { stroke: compared || css("--actual"), width: 1.6 },
    error: { stroke: compared || css("--actual"), width: 1.4 },
    component0: { stroke: css("--actual"), width: 1.3 },
    component1: { stroke: css("--second"), width: 1.3 },
    component2: { stroke: css("--third"), width: 1.3 },
    component3: { stroke: css("--goal"), width: 1.3 },
    sigma_high: { stroke: css("--faint"), width: 0.8 },
    sigma_low: { stroke: css("--faint"), width: 0.8 },
  };
  return styles[curve.role];
}

// Not-a-numbers are holes of an imported log; a line ends at null and goes on over undefined.
function withGaps(column) {
  return column.some(Number.isNaN) ? Array.from(column, (value) => (Number.isNaN(value) ? null : value)) : column;
}

// Flights sampled at different times keep their own times; the plot bridges the gaps.
function tableOf(panel) {
  const tables = new Map();
  for (const curve of panel.curves) {
    if (!tables.has(curve.base)) tables.set(curve.base, [base(curve.base).time]);
    tables.get(curve.base).push(withGaps(base(curve.base).columns[curve.column]));
  }
  const ordered = [...tables.keys()];
  const order = ordered.flatMap((number) => panel.curves.filter((curve) => curve.base === number));
  const joined = tables.size === 1 ? tables.get(ordered[0]) : uPlot.join([...tables.values()]);
  return { data: joined, curves: order };
}

function visibleBands(panel) {
  if (panel.band === null) return [];
  return flights[0].bands
    .filter((band) => band.end >= state.from && band.start <= state.to)
    .map((band) => ({ ...band, edges: band[panel.band].map((edge) => edge * panel.bandScale) }));
}

function heightRange(panel, low, high) {
  if (low === null || !Number.isFinite(low)) return [0, 1];
  for (const band of visibleBands(panel)) {
    low = Math.min(low, ...band.edges);
    high = Math.max(high, ...band.edges);
  }
  const lack = Math.max(0, panel.leastSpan - (high - low));
  const margin = 0.07 * (high - low + lack);
  return [low - lack / 2 - margin, high + lack / 2 + margin];
}

function drawBehind(u, panel) {
  const context = u.ctx;
  const { left, top, width, height } = u.bbox;
  const x = (time) => Math.min(Math.max(u.valToPos(time, "x", true), left), left + width);
  const y = (value) => Math.min(Math.max(u.valToPos(value, "y", true), top), top + height);
  context.save();
  if (!comparing) {
    for (const part of flights[0].primitives) {
      if (part.kind !== "coast" || part.end < state.from || part.start > state.to) continue;
      context.fillStyle = tinted(part.color, css("--tint"));
      context.fillRect(x(part.start), top, x(part.end) - x(part.start), height);
    }
    context.fillStyle = css("--band");
    for (const band of visibleBands(panel)) {
      const [low, high] = band.edges;
      context.fillRect(x(band.start), y(high), x(band.end) - x(band.start), y(low) - y(high));
    }
  }
  context.fillStyle = css("--alarm");
  for (const fault of flights.flatMap((flight) => flight.faults)) {
    if (fault.end < state.from || fault.start > state.to) continue;
    context.fillRect(x(fault.start), top, Math.max(x(fault.end) - x(fault.start), 2), 3 * devicePixelRatio);
  }
  if (state.chosen !== null) {
    const part = flights[state.chosen.flight].primitives[state.chosen.place];
    context.strokeStyle = css("--faint");
    context.setLineDash([]);
    context.lineWidth = devicePixelRatio;
    for (const time of [part.start, part.end]) {
      if (time < state.from || time > state.to) continue;
      context.beginPath();
      context.moveTo(x(time), top);
      context.lineTo(x(time), top + height);
      context.stroke();
    }
  }
  context.restore();
}

function drawLimits(u, panel) {
  const context = u.ctx;
  const { left, top, width, height } = u.bbox;
  context.save();
  context.strokeStyle = css("--alarm");
  context.setLineDash([]);
  context.lineWidth = 1.5 * devicePixelRatio;
  for (const limit of panel.limits) {
    const y = u.valToPos(limit, "y", true);
    if (y < top || y > top + height) continue;
    context.beginPath();
    context.moveTo(left, y);
    context.lineTo(left + width, y);
    context.stroke();
  }
  context.restore();
}

function swatch(style) {
  const dash = style.dash ? ` stroke-dasharray="4 3"` : "";
  const span = element("span");
  span.innerHTML = `<svg width="20" height="8" aria-hidden="true"><path d="M0 4H20" stroke="${style.stroke}" stroke-width="2"${dash}/></svg>`;
  return span.firstChild;
}

function headOf(panel, curves) {
  const title = element("strong", {}, `${panel.title} `, element("span", { className: "unit" }, panel.unit));
  const head = element("div", { className: "head" }, title);
  const outputs = curves.map((curve, place) => {
    const output = element("output");
    if (curve.role === "sigma_low") return output;
    const name = comparing ? `${flights[curve.flight].label}${curve.role === "commanded" ? ", commanded" : ""}` : curve.label;
    const label = curve.role === "sigma_high" ? `\u00b1 ${curve.label}` : name;
    head.append(element("span", { className: "key" }, swatch(styleOf(curve)), label, output));
    return output;
  });
  if (panel.band !== null && flights[0].bands.length) {
    const key = element("span", { className: "key" }, "bound of the trim");
    key.prepend(element("span", { className: "chip", style: `background: ${css("--band")}; margin: 0` }));
    head.append(key);
  }
  if (panel.limits.length) {
    const [low, high] = panel.limits;
    head.append(element("span", { className: "key" }, swatch({ stroke: css("--alarm") }), `limits ${low.toFixed(1)} and ${high.toFixed(1)}`));
  }
  return { head, outputs };
}

function digits(panel) {
  return panel.leastSpan < 0.2 ? 3 : 2;
}

function buildPlot(slot) {
  const { panel, frame } = slot;
  const { data, curves } = tableOf(panel);
  const { head, outputs } = headOf(panel, curves);
  const holder = element("div", { className: "plot" });
  frame.replaceChildren(head, holder);
  const axis = {
    stroke: css("--soft"), font: FONT,
    grid: { stroke: css("--grid"), width: 1 }, ticks: { stroke: css("--line"), width: 1, size: 4 },
  };
  const high = curves.findIndex((curve) => curve.role === "sigma_high") + 1;
  const low = curves.findIndex((curve) => curve.role === "sigma_low") + 1;
  const options = {
    width: frame.clientWidth, height: panel.short ? 124 : 162,
    padding: [6, RIGHT, 0, 0], legend: { show: false },
    cursor: { sync: { key: "flight" }, drag: { x: true, y: false, dist: 4 }, y: false, points: { size: 6 } },
    scales: {
      x: { time: false, min: state.from, max: state.to },
      y: { range: (u, least, greatest) => heightRange(panel, least, greatest) },
    },
    axes: [
      { ...axis, size: 24, gap: 2, values: (u, ticks) => ticks.map((tick) => `${+tick.toFixed(3)} s`) },
      { ...axis, size: AXIS, gap: 4, space: panel.short ? 20 : 26 },
    ],
    series: [{}, ...curves.map((curve) => ({ ...styleOf(curve), points: { show: false }, spanGaps: false }))],
    bands: high && low ? [{ series: [high, low], fill: css("--sigma") }] : [],
    hooks: {
      drawClear: [(u) => drawBehind(u, panel)],
      draw: [(u) => drawLimits(u, panel)],
      setScale: [(u, key) => key === "x" && !slot.moving && showRange(u.scales.x.min, u.scales.x.max)],
      setCursor: [(u) => noteCursor(u, slot)],
    },
  };
  slot.outputs = outputs;
  slot.plot = new uPlot(options, data, holder);
  slot.moving = true;
  slot.plot.setScale("x", { min: state.from, max: state.to });
  slot.moving = false;
  holder.addEventListener("touchmove", (event) => followTouch(event, slot.plot), { passive: true });
  holder.addEventListener("dblclick", chooseNone);
}

function followTouch(event, plot) {
  const box = plot.over.getBoundingClientRect();
  const left = event.touches[0].clientX - box.left;
  plot.setCursor({ left, top: box.height / 2 });
}

function noteCursor(u, slot) {
  const { idx, left } = u.cursor;
  slot.outputs.forEach((output, place) => {
    const value = idx === null || left < 0 ? null : nearest(u.data[place + 1], idx);
    output.textContent = value === null ? "" : value.toFixed(digits(slot.panel));
  });
  showCursor(left < 0 || idx === null ? null : u.posToVal(left, "x"));
}

function nearest(column, place) {
  for (let away = 0; away < 8; away += 1) {
    for (const at of [place - away, place + away]) {
      if (column[at] !== undefined && column[at] !== null) return column[at];
    }
  }
  return null;
}

function movePlots() {
  for (const slot of plots) {
    if (!slot.plot) continue;
    slot.moving = true;
    slot.plot.setScale("x", { min: state.from, max: state.to });
    slot.moving = false;
  }
}

function rebuildPlots() {
  for (const slot of plots) {
    if (!slot.plot) continue;
    slot.plot.destroy();
    buildPlot(slot);
  }
}

function setUpPlots() {
  const root = document.getElementById("plots");
  const slots = new Map();
  const soon = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      const slot = slots.get(entry.target);
      if (entry.isIntersecting && !slot.plot) buildPlot(slot);
    }
  }, { rootMargin: "600px" });
  for (const section of new Set(page.panels.map((panel) => panel.section))) {
    const panels = element("div", { className: "panels" });
    root.append(element("section", { className: "group", id: section.toLowerCase() }, element("h2", {}, section), panels));
    for (const panel of page.panels.filter((one) => one.section === section)) {
      const frame = element("div", { className: panel.short ? "panel short" : "panel" }, element("div", { className: "plot" }));
      const slot = { panel, frame, plot: null, moving: false };
      plots.push(slot);
      slots.set(frame, slot);
      panels.append(frame);
      soon.observe(frame);
    }
  }
  when("range", movePlots);
  when("theme", rebuildPlots);
  when("chosen", () => plots.forEach((slot) => slot.plot && slot.plot.redraw(false)));
  let width = root.clientWidth;
  new ResizeObserver(() => {
    if (root.clientWidth === width) return;
    width = root.clientWidth;
    for (const slot of plots) slot.plot && slot.plot.setSize({ width: slot.frame.clientWidth, height: slot.panel.short ? 124 : 162 });
  }).observe(root);
}
