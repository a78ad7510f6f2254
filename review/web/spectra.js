// Spectra of controls and rates: plots with logarithmic axes.
"use strict";

const spectrumPlots = [];

function spectrumData(panel) {
  const tables = panel.curves.map((curve) => [unpack(curve.frequency), unpack(curve.values)]);
  const same = tables.every(([frequency]) => frequency.length === tables[0][0].length && frequency[0] === tables[0][0][0]);
  return same ? [tables[0][0], ...tables.map(([, values]) => values)] : uPlot.join(tables);
}

function inHertz(value) {
  return value === null || value === undefined ? "" : `${+value.toPrecision(3)}`;
}

function buildSpectrum(slot) {
  const { panel, frame } = slot;
  const title = element("strong", {}, `${panel.title} `, element("span", { className: "unit" }, panel.unit));
  const head = element("div", { className: "head" }, title);
  const at = element("output");
  for (const curve of panel.curves) {
    head.append(element("span", { className: "key" }, swatch(styleOf(curve)), comparing ? flights[curve.flight].label : curve.label));
  }
  head.append(element("span", { className: "key" }, at));
  const holder = element("div", { className: "plot" });
  frame.replaceChildren(head, holder);
  const axis = {
    stroke: css("--soft"), font: FONT,
    grid: { stroke: css("--grid"), width: 1 }, ticks: { stroke: css("--line"), width: 1, size: 4 },
  };
  const options = {
    width: frame.clientWidth, height: 190, padding: [6, RIGHT, 0, 0], legend: { show: false },
    cursor: { drag: { x: false, y: false }, y: false, points: { size: 6 } },
    scales: { x: { time: false, distr: 3, range: (u, least, greatest) => [least, greatest] }, y: { distr: 3 } },
    axes: [
      { ...axis, size: 24, gap: 2, values: (u, ticks) => ticks.map((tick) => (tick === null ? null : `${inHertz(tick)} Hz`)) },
      { ...axis, size: AXIS, gap: 4, values: (u, ticks) => ticks.map((tick) => (tick === null ? null : `${+tick.toPrecision(1)}`)) },
    ],
    series: [{}, ...panel.curves.map((curve) => ({ ...styleOf({ ...curve, role: comparing ? "actual" : curve.role }), points: { show: false }, spanGaps: true }))],
    hooks: { setCursor: [(u) => { at.textContent = u.cursor.idx === null ? "" : `${inHertz(u.data[0][u.cursor.idx])} Hz`; }] },
  };
  slot.plot = new uPlot(options, slot.data, holder);
}

function setUpSpectra() {
  const section = document.getElementById("spectra");
  section.hidden = page.spectra.length === 0;
  const root = section.querySelector(".panels");
  for (const panel of page.spectra) {
    const frame = element("div", { className: "panel" });
    root.append(frame);
    spectrumPlots.push({ panel, frame, data: spectrumData(panel), plot: null });
  }
  const soon = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      const slot = spectrumPlots.find((one) => one.frame === entry.target);
      if (entry.isIntersecting && !slot.plot) buildSpectrum(slot);
    }
  }, { rootMargin: "600px" });
  for (const slot of spectrumPlots) soon.observe(slot.frame);
  when("theme", () => {
    for (const slot of spectrumPlots) {
      if (!slot.plot) continue;
      slot.plot.destroy();
      buildSpectrum(slot);
    }
  });
  let width = root.clientWidth;
  new ResizeObserver(() => {
    if (root.clientWidth === width) return;
    width = root.clientWidth;
    for (const slot of spectrumPlots) slot.plot && slot.plot.setSize({ width: slot.frame.clientWidth, height: 190 });
  }).observe(root);
}
