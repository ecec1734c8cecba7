// Moments of the log and times of the motion: what the buttons, sliders and keys do.

const STEP_TIME = 900;  // of an event when the search plays, and of a step's motion then [ms]

const ZOOM = 1.3;  // of Meshcat's camera, whose picture is flatter here than in a window of its own

let timer = null;

function show_event() {
  const entries = past();
  const steps = entries.filter(entry => entry.event === "step");
  const [text, outcome] = moment ? sentence(moment - 1) : ["The search begins: only the start is known", ""];
  fill(by_id("event"), {class: outcome, title: text}, []).textContent = text;
  by_id("counts").textContent = [
    `event ${moment} of ${log.length}`, plural(steps.length, "step"),
    `${steps.filter(step => step.failure).length} failed`,
  ].join(" · ");
  by_id("moment").value = moment;
  by_id("first").disabled = by_id("previous").disabled = moment === 0;
  by_id("next").disabled = by_id("last").disabled = moment === log.length;
  by_id("play").textContent = timer === null ? "Play" : "Pause";
}

// The motion from the start to the chosen step.

// The steps from the root on, and the chosen one, as far as there is something to see of it.
function way_to(step) {
  const steps = [];
  for (let here = step; here !== null; here = step_to[log[here].node]) {
    steps.unshift(here);
  }
  return steps.filter(number => scene.motions[number]);
}

let way = [];

function show_motion(player) {
  const [number, time] = player.at;
  const step = way[number - 1];
  by_id("caption").textContent = step === undefined ? "the start" : caption(step, number, time);
  fill(by_id("time"), {max: player.duration}, []).value = player.time;
  by_id("clock").textContent = `${player.time.toFixed(1)} / ${player.duration.toFixed(1)} s`;
  by_id("replay").textContent = player.playing ? "Pause" : "Replay";
  by_id("replay").disabled = player.duration === 0;
}

// Number, action and segment of a step, or its failure when that is due.
function caption(step, number, time) {
  const {action, failure} = log[step];
  let end = 0;
  const segment = attempts[step].segments.find(([, duration]) => time < (end += duration));
  const over = failure && time >= scene.motions[step].end - 0.05;
  const what = over ? failures[failure].sentence : segment ? segment[0] : failure ? "rest" : `node ${log[step].child}`;
  return `${number}/${way.length} ${action} – ${what}`;
}

const player = new Player(scene, show_motion);

// Choose a step; its way is loaded, and plays from the start or is shown at its end.
function choose(step, plays = true) {
  chosen = step;
  way = way_to(step);
  player.load([scene.root, ...way.map(number => scene.motions[number])]);
  if (plays && player.duration) {
    player.play(Number(by_id("speed").value));
  }
  show_tree();
  show_facts();
}

// Go to a moment of the log; a step forward shows its motion in quick time.
function go_to(goal) {
  const forward = goal === moment + 1;
  moment = Math.max(0, Math.min(log.length, goal));
  const entry = log[moment - 1];
  choose(entry?.event === "step" ? moment - 1 : null, false);
  show_event();
  const length = scene.motions[moment - 1]?.end;
  if (forward && length) {
    player.stop_at(player.duration - length);
    player.play(1000 * length / STEP_TIME);
  }
  document.querySelector("#tree .now")?.scrollIntoView({block: "nearest", inline: "nearest"});
}

function set_playing(on) {
  clearInterval(timer);
  timer = on ? setInterval(() => moment < log.length ? go_to(moment + 1) : set_playing(false), STEP_TIME + 100) : null;
  show_event();
}

function toggle_search() {
  if (timer === null && moment === log.length) {
    go_to(0);
  }
  set_playing(timer === null);
}

function leap(goal) {
  set_playing(false);
  go_to(goal);
}

// Choose a step and stay with it.
function visit(step) {
  set_playing(false);
  choose(step);
}

const toggle_motion = () => player.playing ? player.stop_at(player.time) : player.play(Number(by_id("speed").value));

const controls = {
  first: () => leap(0), previous: () => leap(moment - 1), next: () => leap(moment + 1), last: () => leap(log.length),
  play: toggle_search, replay: toggle_motion,
};
Object.entries(controls).forEach(([id, act]) => by_id(id).addEventListener("click", act));
by_id("moment").addEventListener("input", event => leap(event.target.valueAsNumber));
by_id("time").addEventListener("input", event => player.stop_at(event.target.valueAsNumber));
by_id("speed").addEventListener("change", event => { player.speed = Number(event.target.value); });
addEventListener("keydown", event => {
  const keys = {ArrowLeft: "previous", ArrowRight: "next", Home: "first", End: "last", " ": "replay"};
  const own = event.target.closest(event.key === " " ? "input, select, button" : "input, select");
  if (event.key in keys && !own) {
    event.preventDefault();
    controls[keys[event.key]]();
  }
});

document.title = `${record.title} – search`;
document.querySelector("h1").textContent = record.title;
by_id("moment").max = log.length;
viewer.gui.domElement.style.display = "none";
viewer.camera.zoom = ZOOM;
new ResizeObserver(() => viewer.set_3d_pane_size()).observe(by_id("meshcat-pane"));
addEventListener("resize", fit);
show_reasons();
fit();
go_to(log.length);
if (reasons.refusals.length) {
  choose_refusal(0);
}
