// Camera of the view: parallel projection of north, east and height onto the screen.
"use strict";

const ABOVE = { turn: 0, tilt: Math.PI / 2 };
const SPACE = { turn: -0.55, tilt: 0.5 };

const camera = { ...ABOVE, scale: 1, middle: { east: 0, north: 0, height: 0 }, zoom: 1, shift: { x: 0, y: 0 } };

// Returns the position on the screen, in metres right and up, before scale and shift.
function projected(north, east, height) {
  const { middle, turn, tilt } = camera;
  const [e, n, h] = [east - middle.east, north - middle.north, height - middle.height];
  const right = e * Math.cos(turn) - n * Math.sin(turn);
  const away = e * Math.sin(turn) + n * Math.cos(turn);
  return [right, away * Math.sin(tilt) + h * Math.cos(tilt)];
}

function onScreen(size, north, east, height) {
  const [right, up] = projected(north, east, height);
  const metre = camera.scale * camera.zoom;
  return [size.width / 2 + camera.shift.x + right * metre, size.height / 2 + camera.shift.y - up * metre];
}

// Returns the ground position of a point of the plan view; the inverse of `onScreen` from above.
function groundAt(size, x, y) {
  const metre = camera.scale * camera.zoom;
  return {
    east: camera.middle.east + (x - size.width / 2 - camera.shift.x) / metre,
    north: camera.middle.north - (y - size.height / 2 - camera.shift.y) / metre,
  };
}

// Sets scale and shift so that all points are visible.
function fit(size, points, floor) {
  const range = (values) => [Math.min(...values), Math.max(...values)];
  const [south, north] = range(points.map((point) => point[0]));
  const [west, east] = range(points.map((point) => point[1]));
  const [low, high] = range(points.map((point) => point[2]));
  camera.middle = { north: (south + north) / 2, east: (west + east) / 2, height: camera.tilt > 1.5 ? 0 : (Math.min(low, floor) + high) / 2 };
  const corners = [];
  for (const n of [south, north]) for (const e of [west, east]) for (const h of [floor, high]) corners.push(projected(n, e, h));
  const [left, right] = range(corners.map((corner) => corner[0]));
  const [bottom, top] = range(corners.map((corner) => corner[1]));
  camera.scale = Math.min((size.width - 90) / Math.max(right - left, 4), (size.height - 80) / Math.max(top - bottom, 4));
  camera.zoom = 1;
  camera.shift = { x: (-(left + right) / 2) * camera.scale, y: ((bottom + top) / 2) * camera.scale };
}
