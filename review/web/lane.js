// Lane of primitives above the plots, and the overview with the time range shown.
"use strict";

const laneCanvas = document.getElementById("lane");
const overviewCanvas = document.getElementById("overview");
const ROW = 24;

function fillPart(context, part, x, width, top, height) {
  context.fillStyle = part.kind === "coast" ? shade(part.color) : css("--line");
  context.fillRect(x, top, Math.max(width, 0.5), height);
}

function laneText(part, room, context) {
  const words = part.kind === "coast" ? [part.name, String(part.id)] : [`${part.from} \u2192 ${part.to}`, "\u2192"];
  return words.find((text) => context.measureText(text).width + 8 < room) || "";
}

function drawLane() {
  laneCanvas.style.height = `${flights.length * (ROW + 4) + 24}px`;
  const { context, width, height } = prepare(laneCanvas);
  const [left, right] = [AXIS, width - RIGHT];
  const x = (time) => left + ((time - state.from) / (state.to - state.from)) * (right - left);
  context.save();
  context.beginPath();
  context.rect(left, 0, right - left, height);
  context.clip();
  flights.forEach((flight, number) => drawRow(context, flight, number, x));
  context.restore();
  context.font = FONT;
  context.fillStyle = css("--soft");
  context.textBaseline = "middle";
  if (comparing) flights.forEach((flight, number) => context.fillText(flight.label, 4, number * (ROW + 4) + ROW / 2, AXIS - 8));
  drawTimes(context, x, height);
  if (state.cursor !== null) {
    context.fillStyle = css("--ink");
    context.fillRect(x(state.cursor) - 0.5, 0, 1, height - 20);
  }
}

function drawRow(context, flight, number, x) {
  const top = number * (ROW + 4);
  context.font = `600 ${FONT}`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  flight.primitives.forEach((part, place) => {
    if (part.end < state.from || part.start > state.to) return;
    const [begin, end] = [Math.max(x(part.start), x(state.from)), Math.min(x(part.end), x(state.to))];
    fillPart(context, part, begin, end - begin, top, ROW);
    context.fillStyle = part.kind === "coast" ? inkOn(part.color) : css("--ink");
    context.fillText(laneText(part, end - begin, context), (begin + end) / 2, top + ROW / 2 + 1);
    context.fillStyle = css("--paper");
    context.fillRect(x(part.start) - 0.5, top, 1, ROW);
    if (part.timedOut || (part.judged && part.judged.left)) {
      context.fillStyle = css("--alarm");
      context.fillRect(begin, top + ROW - 5, end - begin, 5);
    }
    if (isChosen(number, place)) {
      context.strokeStyle = css("--ink");
      context.lineWidth = 2;
      context.strokeRect(begin + 1, top + 1, end - begin - 2, ROW - 2);
    }
  });
  for (const fault of flight.faults) {
    context.fillStyle = css("--alarm");
    context.fillRect(x(fault.start), top, Math.max(x(fault.end) - x(fault.start), 2), 4);
  }
  for (const event of flight.events.filter((one) => one.source === "plan" || one.level !== "INFO")) {
    context.fillStyle = event.level === "INFO" ? css("--soft") : css("--alarm");
    const at = x(event.time);
    context.beginPath();
    context.moveTo(at, top + ROW - 1);
    context.lineTo(at - 4, top + ROW + 5);
    context.lineTo(at + 4, top + ROW + 5);
    context.fill();
  }
  context.textAlign = "left";
}

function drawTimes(context, x, height) {
  const step = niceStep(state.to - state.from, Math.max(3, (x(state.to) - x(state.from)) / 90));
  context.fillStyle = css("--soft");
  context.textAlign = "center";
  for (let time = Math.ceil(state.from / step) * step; time <= state.to + 1e-9; time += step) {
    context.fillRect(Math.round(x(time)), height - 20, 1, 4);
    context.fillText(`${+time.toFixed(3)} s`, Math.min(x(time), x(state.to) - 10), height - 7);
  }
  context.textAlign = "left";
}

function drawOverview() {
  const { context, width, height } = prepare(overviewCanvas);
  const x = (time) => AXIS + (time / duration) * (width - AXIS - RIGHT);
  const row = height / flights.length;
  flights.forEach((flight, number) => {
    for (const part of flight.primitives) fillPart(context, part, x(part.start), x(part.end) - x(part.start), number * row, row - 1);
  });
  context.fillStyle = isDark() ? "rgba(20, 23, 28, 0.66)" : "rgba(255, 255, 255, 0.7)";
  context.fillRect(AXIS, 0, x(state.from) - AXIS, height);
  context.fillRect(x(state.to), 0, width - RIGHT - x(state.to), height);
  context.strokeStyle = css("--ink");
  context.lineWidth = 1.5;
  context.strokeRect(x(state.from) + 0.75, 0.75, Math.max(x(state.to) - x(state.from) - 1.5, 2), height - 1.5);
  const whole = state.to - state.from > duration - 1e-6;
  document.getElementById("range").textContent = whole
    ? `whole flight, ${duration.toFixed(1)} s`
    : `${state.from.toFixed(1)} to ${state.to.toFixed(1)} s of ${duration.toFixed(1)} s`;
  document.getElementById("whole").disabled = whole && state.chosen === null;
}

function timeAt(canvas, event, from, to) {
  const box = canvas.getBoundingClientRect();
  return from + ((event.clientX - box.left - AXIS) / (box.width - AXIS - RIGHT)) * (to - from);
}

function setUpLane() {
  const draw = () => { drawLane(); drawOverview(); };
  for (const what of ["range", "chosen", "theme"]) when(what, draw);
  when("cursor", drawLane);
  laneCanvas.addEventListener("click", (event) => {
    const row = Math.floor((event.clientY - laneCanvas.getBoundingClientRect().top) / (ROW + 4));
    const time = timeAt(laneCanvas, event, state.from, state.to);
    const place = flights[row] ? flights[row].primitives.findIndex((part) => part.start <= time && time < part.end) : -1;
    if (place >= 0) choose(row, place);
  });
  let grip = null;
  overviewCanvas.addEventListener("pointerdown", (event) => {
    const time = timeAt(overviewCanvas, event, 0, duration);
    const inside = time >= state.from && time <= state.to;
    grip = inside && state.to - state.from < duration - 1e-6 ? time - state.from : (state.to - state.from) / 2;
    overviewCanvas.setPointerCapture(event.pointerId);
    if (!inside) showRange(time - grip, time - grip + (state.to - state.from));
  });
  overviewCanvas.addEventListener("pointermove", (event) => {
    if (grip === null) return;
    const from = timeAt(overviewCanvas, event, 0, duration) - grip;
    showRange(from, from + (state.to - state.from));
  });
  overviewCanvas.addEventListener("pointerup", () => { grip = null; });
  document.getElementById("whole").addEventListener("click", chooseNone);
  new ResizeObserver(draw).observe(document.getElementById("lane-frame"));
}
