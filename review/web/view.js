// Track from above and in three dimensions, over the plan and its tube.
"use strict";

const viewCanvas = document.getElementById("view");
const tracks = flights.map((flight) => unpackTrack(flight.track));
const estimated = flights.map((flight) => flight.estimated && unpackTrack(flight.estimated));
const plansDrawn = flights[0].plans.map((plan) => ({ ...plan, line: unpack(plan.line), tube: unpack(plan.tube) }));
const placed = tracks.filter((track) => track !== null);
const floor = placed.length ? Math.floor(Math.min(...placed.map((track) => track.height.filter(Number.isFinite).reduce((a, b) => Math.min(a, b), Infinity))) - 0.5) : 0;
let size = { width: 1, height: 1 };
let inSpace = false;

// A log without positions has no track; without heights it is drawn flat, without headings without darts.
function unpackTrack(track) {
  if (track === null) return null;
  const columns = Object.fromEntries(Object.entries(track).map(([name, text]) => [name, text && unpack(text)]));
  return { ...columns, height: columns.height || new Float32Array(columns.north.length) };
}

function placeAt(track, time) {
  const low = before(track.time, time);
  const high = Math.min(low + 1, track.time.length - 1);
  const gap = track.time[high] - track.time[low];
  const share = gap > 0 ? Math.min(Math.max((time - track.time[low]) / gap, 0), 1) : 0;
  const between = (name) => track[name][low] + share * (track[name][high] - track[name][low]);
  return { north: between("north"), east: between("east"), height: between("height"), heading: track.heading && between("heading") };
}

function fitAll() {
  const points = placed.flatMap((track) => Array.from(track.north, (north, i) => [north, track.east[i], track.height[i]]));
  const middle = placed[0].height.find(Number.isFinite) ?? 0;
  for (const { goal } of flights) {
    if (goal) for (const way of [-1, 1]) points.push([goal.north + way * goal.tolerance, goal.east + way * goal.tolerance, middle]);
  }
  const plan = plansDrawn[state.plan];
  if (plan) for (let i = 0; i < plan.line.length; i += 2) points.push([plan.line[i], plan.line[i + 1], middle]);
  fit(size, points.filter((point) => point.every(Number.isFinite)), inSpace ? floor : middle);
}

function path(context, count, point) {
  context.beginPath();
  let drawing = false;
  for (let i = 0; i < count; i += 1) {
    const [x, y] = point(i);
    const known = Number.isFinite(x) && Number.isFinite(y);
    if (known) context[drawing ? "lineTo" : "moveTo"](x, y);
    drawing = known;
  }
}

function trackPath(context, track, from, to, height) {
  const begin = before(track.time, from);
  const end = Math.min(before(track.time, to) + 1, track.time.length - 1);
  path(context, end - begin + 1, (i) => {
    const time = Math.min(Math.max(track.time[begin + i], from), to);
    const at = placeAt(track, time);
    return onScreen(size, at.north, at.east, height === undefined ? at.height : height);
  });
}

function drawGrid(context) {
  const level = inSpace ? floor : 0;
  const metre = camera.scale * camera.zoom;
  const step = niceStep(size.width / metre, inSpace ? 8 : 7);
  const reach = inSpace ? 1.0 : 2.0;
  const half = (reach * Math.max(size.width, size.height)) / metre / 2;
  const centre = inSpace ? camera.middle : groundAt(size, size.width / 2, size.height / 2);
  context.font = FONT;
  context.lineWidth = 1;
  context.strokeStyle = css("--line");
  context.fillStyle = css("--faint");
  for (const [axis, other] of [["east", "north"], ["north", "east"]]) {
    const first = Math.ceil((centre[axis] - half) / step) * step;
    for (let value = first; value <= centre[axis] + half; value += step) {
      const end = (way) => ({ [axis]: value, [other]: centre[other] + way * half });
      const [a, b] = [end(-1), end(1)].map((at) => onScreen(size, at.north, at.east, level));
      context.beginPath();
      context.moveTo(...a);
      context.lineTo(...b);
      context.stroke();
      if (inSpace) continue;
      const text = `${+value.toFixed(3)}`;
      if (axis === "east") context.fillText(text, a[0] + 4, size.height - 8);
      else if (a[1] < size.height - 26) context.fillText(text, 6, a[1] - 4);
    }
  }
  const note = inSpace ? `drag to rotate; plane at ${floor} m above ground` : "east, m \u2192";
  context.textAlign = "right";
  context.fillText(note, size.width - 10, size.height - (inSpace ? 10 : 24));
  context.textAlign = "left";
  if (!inSpace) context.fillText("north, m \u2191", 8, 16);
}

// The tube is filled on a separate canvas, so that the opacity of overlaps does not add up.
function drawTube(context, plan, height) {
  const sheet = document.createElement("canvas");
  sheet.width = viewCanvas.width;
  sheet.height = viewCanvas.height;
  const pen = sheet.getContext("2d");
  const ratio = viewCanvas.width / size.width;
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  const [fill, opacity] = css("--tube").match(/^rgba\((.*), ([\d.]+)\)$/).slice(1);
  pen.fillStyle = pen.strokeStyle = `rgb(${fill})`;
  const lines = plan.tube.length / 2 / plan.points;
  const corner = (line, i) => {
    const at = 2 * (line * plan.points + i);
    return onScreen(size, plan.tube[at], plan.tube[at + 1], height);
  };
  for (let line = 0; line + 1 < lines; line += 1) {
    for (let i = 0; i + 1 < plan.points; i += 1) {
      pen.beginPath();
      pen.moveTo(...corner(line, i));
      pen.lineTo(...corner(line, i + 1));
      pen.lineTo(...corner(line + 1, i + 1));
      pen.lineTo(...corner(line + 1, i));
      pen.fill();
      pen.stroke();
    }
  }
  context.globalAlpha = Number(opacity);
  context.drawImage(sheet, 0, 0, size.width, size.height);
  context.globalAlpha = 1;
}

function drawPlan(context) {
  const plan = plansDrawn[state.plan];
  if (!plan) return;
  const height = placeAt(placed[0], plan.time).height;
  drawTube(context, plan, height);
  context.setLineDash([6, 4]);
  context.strokeStyle = css("--commanded");
  context.lineWidth = 1.3;
  path(context, plan.points, (i) => onScreen(size, plan.line[2 * i], plan.line[2 * i + 1], height));
  context.stroke();
  context.setLineDash([]);
}

function drawGoal(context, goal, height) {
  path(context, 65, (i) => {
    const angle = (i / 64) * 2 * Math.PI;
    return onScreen(size, goal.north + goal.tolerance * Math.cos(angle), goal.east + goal.tolerance * Math.sin(angle), height);
  });
  context.fillStyle = context.strokeStyle = css("--goal");
  context.globalAlpha = 0.22;
  context.fill();
  context.globalAlpha = 1;
  context.lineWidth = 1.5;
  context.stroke();
  const [x, y] = onScreen(size, goal.north, goal.east, height);
  context.beginPath();
  for (const [a, b] of [[5, 0], [0, 5]]) { context.moveTo(x - a, y - b); context.lineTo(x + a, y + b); }
  context.stroke();
}

function drawTrack(context, number) {
  const [flight, track] = [flights[number], tracks[number]];
  const parts = flight.primitives.length ? flight.primitives : [{ kind: "coast", start: 0, end: flight.duration, color: "#0072b2" }];
  context.lineJoin = "round";
  context.lineCap = "butt";
  if (inSpace) {
    context.strokeStyle = css("--tube");
    context.lineWidth = 3;
    trackPath(context, track, 0, flight.duration, floor);
    context.stroke();
    context.lineWidth = 1;
    const step = niceStep(Math.max(flight.duration, 0.1), 24);
    for (let time = 0; time <= flight.duration; time += step) {
      const at = placeAt(track, time);
      context.beginPath();
      context.moveTo(...onScreen(size, at.north, at.east, at.height));
      context.lineTo(...onScreen(size, at.north, at.east, floor));
      context.stroke();
    }
  }
  parts.forEach((part, place) => {
    const held = part.kind === "coast";
    context.strokeStyle = comparing ? flightColor(number) : held ? shade(part.color) : css("--ink");
    context.lineWidth = (held ? 3.4 : 1.6) + (isChosen(number, place) ? 3 : 0);
    trackPath(context, track, part.start, part.end);
    context.stroke();
  });
}

function drawSpot(context, at, fill) {
  context.beginPath();
  context.arc(...onScreen(size, at.north, at.east, at.height), 5, 0, 2 * Math.PI);
  context.fillStyle = fill;
  context.strokeStyle = css("--ink");
  context.lineWidth = 1.4;
  context.fill();
  context.stroke();
}

function drawDart(context, at, fill, scale = 1) {
  if (at.heading === null) return drawSpot(context, at, fill);
  const nose = onScreen(size, at.north + 0.001 * Math.cos(at.heading), at.east + 0.001 * Math.sin(at.heading), at.height);
  const [x, y] = onScreen(size, at.north, at.east, at.height);
  const angle = Math.atan2(nose[1] - y, nose[0] - x);
  context.save();
  context.translate(x, y);
  context.rotate(angle);
  context.scale(scale, scale);
  context.beginPath();
  for (const [i, point] of [[10, 0], [-8, 6], [-4, 0], [-8, -6]].entries()) context[i ? "lineTo" : "moveTo"](...point);
  context.closePath();
  context.fillStyle = fill;
  context.strokeStyle = css("--ink");
  context.lineWidth = 1.4;
  context.fill();
  context.stroke();
  context.restore();
}

function drawWind(context, wind) {
  const speed = Math.hypot(wind.north, wind.east);
  if (speed < 0.05) return;
  const [x, y] = [size.width - 34, 34];
  const turn = inSpace ? camera.turn : 0;
  const right = (wind.east * Math.cos(turn) - wind.north * Math.sin(turn)) / speed;
  const up = (wind.east * Math.sin(turn) + wind.north * Math.cos(turn)) / speed;
  context.save();
  context.translate(x, y);
  context.rotate(Math.atan2(-up, right));
  context.strokeStyle = context.fillStyle = css("--soft");
  context.lineWidth = 1.8;
  context.beginPath();
  context.moveTo(-15, 0);
  context.lineTo(9, 0);
  context.stroke();
  context.beginPath();
  context.moveTo(16, 0);
  context.lineTo(6, -5);
  context.lineTo(6, 5);
  context.fill();
  context.restore();
  context.fillStyle = css("--soft");
  context.font = FONT;
  context.textAlign = "right";
  context.fillText(`mean wind ${speed.toFixed(1)} m/s`, size.width - 60, y + 4);
  context.textAlign = "left";
}

function drawView() {
  const prepared = prepare(viewCanvas);
  const context = prepared.context;
  size = prepared;
  drawGrid(context);
  drawPlan(context);
  if (flights[0].goal) drawGoal(context, flights[0].goal, placeAt(placed[0], flights[0].duration).height);
  flights.forEach((_, number) => { if (tracks[number]) drawTrack(context, number); });
  flights.forEach((flight, number) => {
    if (!tracks[number]) return;
    drawDart(context, placeAt(tracks[number], 0), css("--ink"));
    drawDart(context, placeAt(tracks[number], flight.duration), css("--paper"));
    if (state.cursor === null || state.cursor > flight.duration) return;
    if (estimated[number]) drawDart(context, placeAt(estimated[number], state.cursor), css("--estimated"), 1.0);
    drawDart(context, placeAt(tracks[number], state.cursor), comparing ? flightColor(number) : css("--actual"), 1.25);
  });
  if (flights[0].wind) drawWind(context, flights[0].wind);
}
