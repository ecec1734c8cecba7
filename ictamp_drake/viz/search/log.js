// The page of a search. What can be chosen is a step, by its place in the log, or null for the root.
const {tree, layout, attempts, failures, scene, reasons} = record;
const log = tree.log;
const verdicts = new Map(tree.candidates.map(({node, verified}) => [node, verified]));
const step_to = [null];  // for each node the step that led to it
log.forEach((entry, number) => {
  if (entry.event === "step" && entry.child !== null) {
    step_to.push(number);
  }
});

let moment = 0;  // entries of the log that have happened
let chosen = null;

const past = () => log.slice(0, moment);

// The failed steps so far, by their places in the log.
function failed(node, action) {
  return [...past().keys()].filter(n => log[n].failure && log[n].node === node && log[n].action === action);
}

// How often each of some things occurs, the most frequent first.
function tally(things) {
  const counts = new Map();
  things.forEach(thing => counts.set(thing, (counts.get(thing) ?? 0) + 1));
  return [...counts].sort((one, other) => other[1] - one[1]);
}

const plural = (count, noun) => `${count} ${noun}${count === 1 ? "" : "s"}`;
const digits = value => value.toLocaleString("en");

// The parameter of a step, where there was one, and its computing time.
function about(step) {
  const {k} = log[step];
  const metres = k?.slice(0, 3).map(value => value.toFixed(3)).join(", ");
  const parameter = k ? [`k = (${metres}) m, ${(k[3] * 180 / Math.PI).toFixed(0)}°`] : [];
  return [...parameter, `${attempts[step].seconds.toFixed(2)} s of computing`];
}

// One line about an entry of the log, and the class that says whether it was a success.
function sentence(index) {
  const entry = log[index];
  if (entry.event === "opening") {
    const expansions = `${digits(layout.expanded[index] ?? entry.expanded)} expansions`;
    return entry.plan === null ? [`No plan found in ${expansions}`, "failed"]
      : [`Plan ${entry.plan} opened after ${expansions}: ${tree.plans[entry.plan].join(", ")}`, ""];
  }
  const plan = entry.node === 0 ? [`plan ${entry.plan}`] : [];
  const tail = `(${[...plan, ...about(index)].join("; ")})`;
  if (entry.failure) {
    return [`Node ${entry.node}: ${entry.action} failed, ${failures[entry.failure].sentence} ${tail}`, "failed"];
  }
  const verdict = {
    true: "; the plan is finished and verified",
    false: "; the plan is finished, but was refused",
    null: "; the plan is finished, but no better than one before",
  };
  const end = verdict[verdicts.get(entry.child)] ?? "";
  return [`Node ${entry.node}: ${entry.action} led to node ${entry.child}${end} ${tail}`, "found"];
}

const by_id = id => document.getElementById(id);

// An element with attributes and children, which are elements or texts.
function html(name, attributes = {}, ...children) {
  return fill(document.createElement(name), attributes, children);
}

function svg(name, attributes = {}, ...children) {
  return fill(document.createElementNS("http://www.w3.org/2000/svg", name), attributes, children);
}

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}
