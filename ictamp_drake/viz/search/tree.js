// The drawing. Everything has its final place from the start, and is hidden until it has happened.

const ROW = 40, RADIUS = 10, SHELF = 205, MARGIN = 26;  // sizes in the drawing [pixels]
const LETTER = 6.4;  // width of a letter of a label [pixels]
const MIN_SCALE = 0.72, MAX_SCALE = 1.25;  // of the drawing

const labels = Object.fromEntries(Object.entries(layout.labels).map(([action, label]) => {
  const [verb, ...objects] = label.split(" ");
  return [action, [verb, objects.join(" ")]];
}));
const COLUMN = 56 + LETTER * Math.max(8, ...Object.values(labels).flat().map(text => text.length));

function place(item, depth) {
  return [SHELF + MARGIN + depth * COLUMN, MARGIN + layout.levels[item] * ROW];
}

const place_of = node => place(node, tree.nodes[node].depth);

// Right from the parent, down to the item's row and on to the item.
function path_to(parent, x, y) {
  const [start, above] = place_of(parent);
  return `M${start} ${above}H${start + 24}V${y}H${x}`;
}

function draw_node(node) {
  const {index, parent, action} = node;
  const [x, y] = place_of(index);
  const group = svg("g", {class: "node"});
  if (parent !== null) {
    const d = path_to(parent, x, y);
    const middle = (x - COLUMN + 24 + x - RADIUS) / 2;
    group.append(
      svg("path", {class: "halo", d}), svg("path", {class: "edge", d}),
      svg("text", {class: "above", x: middle, y: y - 6}, labels[action][0]),
      svg("text", {class: "below", x: middle, y: y + 14}, labels[action][1]));
  }
  group.append(
    svg("circle", {class: "ring", cx: x, cy: y, r: RADIUS + 3.5}),
    svg("circle", {class: "disc", cx: x, cy: y, r: RADIUS, fill: layout.colors[index]}),
    svg("text", {class: "number", x, y}, `${index}`),
    svg("title", {}, action ? `node ${index}: ${action}` : "the start"));
  group.addEventListener("click", () => visit(step_to[index]));
  return group;
}

function draw_stub({node, action}, number) {
  const [start, y] = place(tree.nodes.length + number, tree.nodes[node].depth);
  const x = start + 46;
  const d = path_to(node, x, y);
  const group = svg("g", {class: "stub"},
    svg("path", {class: "halo", d}), svg("path", {class: "edge", d}),
    svg("path", {class: "cross", d: `M${x - 4} ${y - 4}l8 8m0 -8l-8 8`}),
    svg("text", {class: "tries", x: x + 9, y: y - 3}),
    svg("text", {x: x + 9, y: y + 10}, labels[action][1]), svg("title"));
  group.addEventListener("click", () => visit(failed(node, action).at(-1)));
  return group;
}

function draw_plan({plan, color}, row) {
  const y = MARGIN + row * 20;
  return svg("g", {class: "plan"},
    svg("rect", {x: SHELF - 20, y: y - 5, width: 10, height: 10, fill: color}),
    svg("text", {x: SHELF - 27, y: y + 4, "text-anchor": "end"}),
    svg("title", {}, tree.plans[plan].join("\n")));
}

const tried_plans = new Set(log.filter(entry => entry.node === 0).map(entry => entry.plan));
const shelf = layout.plans.filter(({plan}) => tried_plans.has(plan));
const plans = shelf.map(draw_plan);
const nodes = tree.nodes.map(draw_node);
const stubs = layout.stubs.map(draw_stub);
const others = svg("text", {x: SHELF - 10, y: MARGIN + shelf.length * 20 + 4, "text-anchor": "end"});
const drawing = svg("svg", {}, ...plans, others, ...stubs, ...nodes.toReversed());
by_id("tree").append(drawing);

// Show the whole, or what is legible of it, as wide as the pane.
function fit() {
  const width = SHELF + 2 * MARGIN + layout.depth * COLUMN;
  const height = 2 * MARGIN + Math.max(ROW * Math.max(...layout.levels), 20 * shelf.length);
  const pane = by_id("tree");
  const across = (pane.clientWidth - 1) / width, down = parseFloat(getComputedStyle(pane).maxHeight) / height;
  const whole = Math.min(across, down, MAX_SCALE);
  const scale = whole >= MIN_SCALE ? whole : Math.max(MIN_SCALE, Math.min(1, across));
  fill(drawing, {viewBox: `0 0 ${width} ${height}`, width: width * scale, height: height * scale}, []);
}

function show_tree() {
  const entries = past();
  const latest = log[moment - 1] ?? {};
  const over = moment === log.length;
  const way = new Set();
  for (let node = node_of(chosen); node !== null; node = tree.nodes[node].parent) {
    way.add(node);
  }
  const mark = (group, classes) => Object.entries(classes).forEach(([name, on]) => group.classList.toggle(name, on));
  nodes.forEach((group, index) => mark(group, {
    future: index > 0 && step_to[index] >= moment,
    now: latest.child === index,
    way: way.has(index),
    chosen: chosen === step_to[index],
    solution: over && layout.solution.includes(index),
    verified: verdicts.get(index) === true,
    refused: verdicts.get(index) === false,
  }));
  stubs.forEach((group, index) => {
    const {node, action} = layout.stubs[index];
    const tries = failed(node, action);
    const causes = tally(tries.map(step => log[step].failure));
    const reasons = causes.map(([name, count]) => `${count}× ${failures[name].sentence}`);
    mark(group, {
      future: !tries.length,
      now: Boolean(latest.failure) && latest.node === node && latest.action === action,
      way: tries.includes(chosen),
    });
    group.querySelector(".tries").textContent = `${tries.length}× ${labels[action][0]}`;
    group.querySelector(".cross").style.stroke = causes.length ? failures[causes[0][0]].color : "";
    group.querySelector("title").textContent = reasons.join("\n");
  });
  const opened = new Set(entries.filter(entry => entry.event === "opening").map(entry => entry.plan));
  plans.forEach((group, row) => {
    const {plan} = shelf[row];
    const tries = entries.filter(entry => entry.node === 0 && entry.plan === plan).length;
    mark(group, {future: !opened.has(plan), now: latest.event === "opening" && latest.plan === plan});
    group.querySelector("text").textContent = `plan ${plan}, ${tree.plans[plan].length} skills, tried ${tries}×`;
  });
  const rest = [...opened].filter(plan => plan !== null && !tried_plans.has(plan)).length;
  others.textContent = rest ? `and ${plural(rest, "plan")} never tried` : "";
}
