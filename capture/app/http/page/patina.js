// SPDX-License-Identifier: GPL-3.0-or-later
// The live state of the daemon. Text goes in by textContent alone.

const at = (id) => document.getElementById(id);
const events = ["run", "status", "step", "shot", "frame", "light", "event", "alert", "device", "reset"];
const refreshMs = 1000, clockMs = 1000, logLines = 200;
let now = { offsetMs: 0 }, runs = [], refreshing = false, again = false, refreshedMs = 0;

function element(name, text, className) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (className) made.className = className;
  return made;
}

function fact(list, name, value) {
  const box = element("div");
  box.append(element("dt", name), element("dd", value));
  list.append(box);
  return box.lastChild;
}

function bytes(count) {
  const units = ["B", "kB", "MB", "GB", "TB"];
  let at = 0;
  for (; count >= 1000 && at < units.length - 1; ++at) count /= 1000;
  return `${count.toFixed(count < 10 && at > 0 ? 1 : 0)} ${units[at]}`;
}

function span(ms) {
  const s = Math.round(Math.abs(ms) / 1000);
  if (s < 120) return `${s} s`;
  if (s < 7200) return `${Math.round(s / 60)} min`;
  return s < 172800 ? `${Math.round(s / 3600)} h` : `${Math.round(s / 86400)} d`;
}

const msOf = (utcNs) => utcNs / 1e6;
const nowMs = () => Date.now() + now.offsetMs;
const ago = (utcNs) => (utcNs ? `${span(nowMs() - msOf(utcNs))} ago` : "none yet");
const until = (utcNs) => (!utcNs ? "none" : msOf(utcNs) < nowMs() ? "now" : `in ${span(msOf(utcNs) - nowMs())}`);

async function items(path) {
  const answer = await fetch(path, { headers: { Accept: "application/json" } });
  if (answer.status === 401) throw new Error("Not signed in: `patina open` makes a link that opens this page.");
  if (!answer.ok) throw new Error(`${path}: ${answer.status}`);
  return (await answer.json()).items ?? [];
}

function say(text) {
  at("notice").textContent = text;
  at("notice").hidden = text === "";
}

function chip(text, good) {
  return element("span", text, `chip ${good ? "good" : "bad"}`);
}

function showRun(run) {
  const box = element("article"), head = element("h3", `${run.specimen} · ${run.id}`), list = element("dl");
  head.append(chip(run.paused ? "paused" : run.state, run.active && !run.trouble && !run.paused));
  fact(list, "step", `${run.step ?? 0} of ${run.steps ?? 0}`);
  fact(list, "next", until(run.next_due_utc_ns)).dataset.until = run.next_due_utc_ns || "";
  fact(list, "light", run.light || "not checked");
  for (const key of ["captured", "held", "skipped", "missed", "failed", "partial"])
    if (run[key] || key === "captured") fact(list, key, String(run[key] ?? 0));
  if (run.disk_free_bytes) fact(list, "disk free", bytes(run.disk_free_bytes));
  const bar = element("progress");
  bar.max = run.steps || 1;
  bar.value = run.step || 0;
  box.append(head, list, bar);
  for (const text of [run.trouble, run.note]) if (text) box.append(element("p", text));
  return box;
}

function showCamera(camera, run) {
  const box = element("article"), facts = element("div", undefined, "facts"), list = element("dl");
  box.dataset.camera = `${run.id}/${camera.device_id}`;
  const old = document.querySelector(`#cameras article[data-camera="${CSS.escape(box.dataset.camera)}"] img`);
  if (/^[0-9a-f]{64}$/.test(camera.newest_sha256 ?? "")) {
    const source = `/api/v1/objects/${camera.newest_sha256}/preview`;
    const image = old && old.getAttribute("src") === source ? old : element("img");
    if (image !== old) image.src = source;
    image.alt = `last frame of ${camera.device_id}`;
    box.append(image);
  } else {
    box.append(element("div", undefined, "blank"));
  }
  const head = element("h3", camera.device_id);
  head.append(chip(camera.up ? "up" : "down", camera.up));
  for (const [name, value] of [["frames", camera.captured], ["failed", camera.failed], ["light", run.light || "not checked"]])
    list.append(element("dt", name), element("dd", String(value ?? 0)));
  const last = element("dd", ago(camera.newest_utc_ns)), next = element("dd", until(run.next_due_utc_ns));
  last.dataset.ago = camera.newest_utc_ns || "";
  next.dataset.until = run.next_due_utc_ns || "";
  list.append(element("dt", "last"), last, element("dt", "next"), next);
  facts.append(head, list);
  if (camera.trouble) facts.append(element("p", camera.trouble));
  box.append(facts);
  return box;
}

function showAlert(alert) {
  return element("p", `${alert.what}: ${alert.detail} (${ago(alert.since_utc_ns)})`);
}

async function refresh() {
  if (refreshing) return void (again = true);
  refreshing = true;
  again = false;
  refreshedMs = performance.now();
  try {
    const [status, newRuns, alerts] = await Promise.all(["status", "runs", "alerts"].map((name) => items(`/api/v1/${name}`)));
    if (status[0]?.now_utc_ns) now.offsetMs = msOf(status[0].now_utc_ns) - Date.now();
    runs = newRuns.filter((run) => run.cameras);
    at("alerts").replaceChildren(...alerts.filter((alert) => !alert.over).map(showAlert));
    at("runs").replaceChildren(...runs.map(showRun));
    at("cameras").replaceChildren(...runs.flatMap((run) => run.cameras.map((camera) => showCamera(camera, run))));
    say(runs.length === 0 ? "Nothing runs. `patina run start PLAN` begins." : "");
  } catch (error) {
    say(error.message);
  }
  refreshing = false;
  if (again) schedule();
}

function schedule() {
  again = true;
  const wait = Math.max(0, refreshMs - (performance.now() - refreshedMs));
  setTimeout(() => { if (again) refresh(); }, wait);
}

function tick() {
  for (const one of document.querySelectorAll("[data-until]")) one.textContent = until(Number(one.dataset.until));
  for (const one of document.querySelectorAll("[data-ago]")) one.textContent = ago(Number(one.dataset.ago));
}

function log(event) {
  let text = event.data;
  try {
    const data = JSON.parse(text);
    text = data.detail ?? data.note ?? data.what ?? data.kind ?? data.id ?? text;
  } catch { /* shown as it came */ }
  if (event.type !== "status") at("log").prepend(element("li", `${new Date(nowMs()).toISOString().slice(11, 19)}  ${event.type}  ${text}`));
  while (at("log").childElementCount > logLines) at("log").lastChild.remove();
}

function listen() {
  const source = new EventSource("/events");
  source.onopen = () => { at("connection").textContent = "live"; schedule(); };
  source.onerror = () => {
    at("connection").textContent = source.readyState === EventSource.CLOSED ? "offline" : "reconnecting";
    if (source.readyState === EventSource.CLOSED) setTimeout(listen, 5 * refreshMs);
  };
  for (const name of events) source.addEventListener(name, (event) => { log(event); schedule(); });
}

// The one-time token leaves the address bar before anything else happens.
async function signIn() {
  const token = new URLSearchParams(location.hash.slice(1)).get("t");
  if (!token) return;
  history.replaceState(null, "", location.pathname);
  const answer = await fetch("/api/v1/session", {
    method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ token }),
  });
  if (!answer.ok) say((await answer.json()).error.message);
}

await signIn();
await refresh();
listen();
setInterval(tick, clockMs);
