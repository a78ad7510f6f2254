// State of the page and listeners to its changes.
"use strict";

const page = JSON.parse(document.getElementById("data").textContent);
const flights = page.flights;
// A flight lost at once has a single sample; it is shown with a short duration.
const duration = Math.max(0.1, ...flights.map((flight) => flight.duration));
const comparing = flights.length > 1;

const state = { from: 0, to: duration, cursor: null, chosen: null, plan: 0 };
const listeners = { range: [], cursor: [], chosen: [], plan: [], theme: [] };

function when(what, listener) {
  listeners[what].push(listener);
}

function notify(what) {
  for (const listener of listeners[what]) listener();
}

function showRange(from, to) {
  const least = Math.min(0.2, duration);
  const middle = (from + to) / 2;
  if (to - from < least) [from, to] = [middle - least / 2, middle + least / 2];
  const span = Math.min(to - from, duration);
  from = Math.min(Math.max(from, 0), duration - span);
  if (Math.abs(from - state.from) < 1e-6 && Math.abs(from + span - state.to) < 1e-6) return;
  state.from = from;
  state.to = from + span;
  notify("range");
}

function showCursor(time) {
  if (time === state.cursor) return;
  state.cursor = time;
  notify("cursor");
}

// Selects a primitive by its flight and its index.
function choose(flight, place) {
  const part = flights[flight].primitives[place];
  state.chosen = { flight, place };
  notify("chosen");
  const margin = Math.max(0.35 * (part.end - part.start), 0.5);
  showRange(part.start - margin, part.end + margin);
}

function chooseNone() {
  state.chosen = null;
  notify("chosen");
  showRange(0, duration);
}

function isChosen(flight, place) {
  return state.chosen !== null && state.chosen.flight === flight && state.chosen.place === place;
}

// Little-endian floats of 32 bits, as base64.
function unpack(text) {
  const bytes = atob(text);
  const buffer = new Uint8Array(bytes.length);
  for (let i = 0; i < bytes.length; i += 1) buffer[i] = bytes.charCodeAt(i);
  return new Float32Array(buffer.buffer);
}

function before(times, time) {
  let low = 0;
  let high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle - 1;
  }
  return low;
}

function element(name, properties = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key in made) made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

function css(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function isDark() {
  return document.documentElement.dataset.theme === "dark";
}

function parts(color) {
  return [1, 3, 5].map((place) => parseInt(color.slice(place, place + 2), 16));
}

function lightness(color) {
  const [r, g, b] = parts(color);
  return (0.299 * r + 0.587 * g + 0.114 * b) / 255;
}

// Trim colours are made for a light page; on a dark page the dark ones are lightened.
function shade(color) {
  const lift = isDark() && lightness(color) < 0.5 ? 0.42 : 0;
  const [r, g, b] = parts(color).map((value) => Math.round(value + lift * (255 - value)));
  return `rgb(${r}, ${g}, ${b})`;
}

function tinted(color, opacity) {
  return shade(color).replace("rgb(", "rgba(").replace(")", `, ${opacity})`);
}

function inkOn(color) {
  const lift = isDark() && lightness(color) < 0.5 ? 0.42 : 0;
  return lightness(color) * (1 - lift) + lift > 0.58 ? "#14171c" : "#ffffff";
}

function flightColor(number) {
  return css(["--actual", "--second", "--goal", "--estimated"][number % 4]);
}

// Sets the drawing area to the screen's resolution; returns its context in CSS pixels.
function prepare(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const { width, height } = canvas.getBoundingClientRect();
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

const FONT = '12px system-ui, -apple-system, "Segoe UI", Roboto, "Liberation Sans", sans-serif';

function niceStep(span, most) {
  const raw = span / most;
  const power = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= raw);
}
