// Input of the view: rotation, pan, picking; its legend and plan selection.
"use strict";

function nearestOnTrack(event) {
  const box = viewCanvas.getBoundingClientRect();
  const [x, y] = [event.clientX - box.left, event.clientY - box.top];
  let best = { away: 22 };
  tracks.forEach((track, number) => {
    if (track === null) return;
    for (let i = 0; i < track.time.length; i += 1) {
      const [a, b] = onScreen(size, track.north[i], track.east[i], track.height[i]);
      const away = Math.hypot(a - x, b - y);
      if (away < best.away) best = { away, number, time: track.time[i] };
    }
  });
  return best.number === undefined ? null : best;
}

function setView(space) {
  inSpace = space;
  Object.assign(camera, space ? SPACE : ABOVE);
  for (const button of document.querySelectorAll("[data-view]")) {
    button.setAttribute("aria-pressed", String((button.dataset.view === "space") === space));
  }
  viewCanvas.style.touchAction = space ? "none" : "pan-y";
  fitAll();
  drawView();
}

function zoom(how) {
  const factor = { in: 1.4, out: 1 / 1.4 }[how];
  if (!factor) fitAll();
  else {
    camera.zoom *= factor;
    camera.shift.x *= factor;
    camera.shift.y *= factor;
  }
  drawView();
}

function writeLegend() {
  const legend = document.getElementById("view-legend");
  const chip = (color, className = "chip") => element("i", { className, style: color ? `background: ${color}` : "" });
  const entries = [];
  if (comparing) flights.forEach((flight, number) => entries.push([chip(flightColor(number)), flight.label]));
  else {
    const held = new Map(flights[0].primitives.filter((part) => part.kind === "coast").map((part) => [part.name, part.color]));
    for (const [name, color] of held) entries.push([chip(shade(color)), name]);
    if (flights[0].primitives.some((part) => part.kind !== "coast")) entries.push([chip(null, "chip thin"), "maneuver"]);
  }
  if (plansDrawn.length) {
    entries.push([swatch({ stroke: css("--commanded"), dash: true }), "plan"]);
    entries.push([chip(css("--tube")), "tube"]);
  }
  if (flights[0].goal) entries.push([chip(css("--goal")), `goal, within ${flights[0].goal.tolerance.toPrecision(3)} m`]);
  legend.replaceChildren(...entries.map(([mark, text]) => element("span", {}, mark, text)));
}

function writePlan() {
  const plan = plansDrawn[state.plan];
  if (!plan) return;
  const level = plan.level.toPrecision(2).replace(/\.0$/, "");
  document.getElementById("plan-text").textContent =
    `plan ${state.plan + 1} of ${plansDrawn.length}, at ${plan.time.toFixed(1)} s: predicted ${plan.cost.toFixed(1)} s, trims ` +
    `${plan.sequence.join(" ")}; tube: same coasting times at gamma \u2212${level} to ${level}`;
}

function setUpView() {
  if (!placed.length) {
    const words = "No map: the log has no positions.";
    document.getElementById("plots-hint").textContent = "Drag across a plot to zoom, double-click for the whole flight; all plots are linked.";
    document.getElementById("view-section").replaceChildren(element("h2", {}, "Track"), element("p", { className: "hint" }, words));
    return;
  }
  if (flights.every((flight) => !flight.track || !flight.track.height)) document.querySelector("[data-view=space]").hidden = true;
  const slider = document.getElementById("plan");
  document.getElementById("plans").hidden = plansDrawn.length === 0;
  slider.max = String(Math.max(plansDrawn.length - 1, 0));
  slider.hidden = plansDrawn.length < 2;
  slider.addEventListener("input", () => { state.plan = Number(slider.value); notify("plan"); });
  when("plan", () => { writePlan(); drawView(); });
  when("cursor", drawView);
  when("chosen", drawView);
  when("theme", () => { writeLegend(); drawView(); });
  for (const button of document.querySelectorAll("[data-view]")) button.addEventListener("click", () => setView(button.dataset.view === "space"));
  for (const button of document.querySelectorAll("[data-zoom]")) button.addEventListener("click", () => zoom(button.dataset.zoom));
  setUpDragging();
  let fitted = false;
  new ResizeObserver(() => {
    size = viewCanvas.getBoundingClientRect();
    if (!fitted || inSpace || camera.zoom === 1) fitAll();
    fitted = true;
    drawView();
  }).observe(viewCanvas);
  writeLegend();
  writePlan();
}

function setUpDragging() {
  let grip = null;
  viewCanvas.addEventListener("pointerdown", (event) => {
    grip = { x: event.clientX, y: event.clientY, moved: false };
    if (event.pointerType === "mouse" || inSpace) viewCanvas.setPointerCapture(event.pointerId);
  });
  viewCanvas.addEventListener("pointermove", (event) => {
    if (grip === null || (event.pointerType !== "mouse" && !inSpace)) {
      const found = nearestOnTrack(event);
      showCursor(found ? found.time : null);
      return;
    }
    const [dx, dy] = [event.clientX - grip.x, event.clientY - grip.y];
    if (!grip.moved && Math.hypot(dx, dy) < 4) return;
    Object.assign(grip, { x: event.clientX, y: event.clientY, moved: true });
    if (inSpace) {
      camera.turn += 0.008 * dx;
      camera.tilt = Math.min(Math.max(camera.tilt + 0.006 * dy, 0.05), 1.5);
    } else {
      camera.shift.x += dx;
      camera.shift.y += dy;
    }
    drawView();
  });
  viewCanvas.addEventListener("pointerup", (event) => {
    const clicked = grip !== null && !grip.moved;
    grip = null;
    const found = clicked ? nearestOnTrack(event) : null;
    if (!found) return;
    const place = flights[found.number].primitives.findIndex((part) => part.start <= found.time && found.time <= part.end);
    if (place >= 0) choose(found.number, place);
  });
  viewCanvas.addEventListener("pointercancel", () => { grip = null; });
  viewCanvas.addEventListener("pointerleave", () => showCursor(null));
}
