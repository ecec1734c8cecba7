// Why there is no plan: the actions that never succeeded. What the one at hand is about is marked in the scene.

const GLOW = 0.55;  // of what is marked
const GHOST = 0.25, VEIL = 0.6;  // opacity of the rest of the scene, and of what is in the way of something
const LAYERS = 8;  // faces of a box that are seen through each other: its edges and three pairs of sides, front and back

let refusal = null;  // number of the chosen one
let marked = {};  // color of each thing that is marked
let moved = null;  // what was to be moved

const capital = text => text.charAt(0).toUpperCase() + text.slice(1);

function show_reasons() {
  by_id("why").hidden = !reasons.ended;
  by_id("why").replaceChildren(
    html("h2", {}, "Why there is no plan"),
    html("p", {}, `${capital(reasons.ended)}.`),
    ...reasons.remarks.map(remark => html("p", {}, `${capital(remark)}.`)),
    ...reasons.refusals.map(refusal_button));
}

function refusal_button({action, args, refused, obstacles, advice, colors}, number) {
  const thing = (name, text) => html("span", {class: "thing", style: `color: ${colors[name] ?? "inherit"}`}, text);
  const way = Object.entries(obstacles).flatMap(([name, count]) => [", ", thing(name, `${name} (${count})`)]);
  const names = args.flatMap(name => [", ", colors[name] ? thing(name, name) : name]);
  const button = html("button", {class: "refusal", "aria-pressed": "false"},
    html("b", {}, `${action.split("(")[0]} `, ...names.slice(1)),
    html("span", {}, refused),
    html("span", {}, ...(way.length ? ["in the way: ", ...way.slice(1)] : [])),
    html("span", {class: "faint"}, advice));
  button.addEventListener("click", () => number === refusal ? choose_refusal(null) : choose_refusal(number));
  button.addEventListener("pointerenter", () => mark_things(number));
  button.addEventListener("pointerleave", () => mark_things(refusal));
  return button;
}

// Mark what a refused action is about, and show where it was refused last; null marks nothing.
function choose_refusal(number) {
  refusal = number;
  document.querySelectorAll(".refusal").forEach((button, index) => fill(button, {"aria-pressed": index === number}, []));
  mark_things(number);
  if (number !== null) {
    const {action} = reasons.refusals[number];
    const last = log.findLastIndex(entry => entry.failure && entry.action === action);
    if (last >= 0) {  // actions that a sweep refused were not tried
      leap(log.length);
      choose(last, false);
    }
  }
}

function mark_things(number) {
  marked = number === null ? {} : reasons.refusals[number].colors;
  moved = number === null ? null : reasons.refusals[number].args[0];
  paint();
}

// The looks of a material as it came.
const looks = new WeakMap();

// Paint boxes and supports. Some shapes come late, and Meshcat may give them new materials, so this is done repeatedly.
function paint() {
  for (const [name, node] of Object.entries(viewer.scene_tree.find(["scene"]).children)) {
    const opacity = !Object.keys(marked).length ? 1 : !marked[name] ? GHOST : name === moved ? 1 : VEIL;
    const layer = scene.boxes.includes(name) ? 1 - (1 - opacity) ** (1 / LAYERS) : opacity;
    node.object.traverse(({material}) => material && paint_material(material, marked[name], layer));
  }
}

function paint_material(material, color, opacity) {
  const before = looks.get(material) ?? {
    color: material.color.clone(), emissive: material.emissive?.clone(), opacity: material.opacity,
    transparent: material.transparent, painted: "",
  };
  looks.set(material, before);
  if (before.painted === `${color} ${opacity}`) {
    return;
  }
  before.painted = `${color} ${opacity}`;
  material.color.copy(before.color);
  material.emissive?.copy(before.emissive);
  if (color) {
    material.color.lerp(new MeshCat.THREE.Color(color), GLOW);
    material.emissive?.set(color).multiplyScalar(GLOW);
  }
  material.opacity = opacity * before.opacity;
  material.transparent = opacity < 1 || before.transparent;
  material.depthWrite = opacity === 1;
  material.needsUpdate = true;
  viewer.set_dirty();
}

setInterval(paint, 250);
