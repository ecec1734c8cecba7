// What is known of the chosen step.

// The node that a step led to or, when it failed, began at.
const node_of = step => step === null ? 0 : log[step].child ?? log[step].node;

const list = (title, lines) => lines.length
  ? [html("h3", {}, title), html("ul", {}, ...lines.map(line => html("li", {}, ...[line].flat())))] : [];

function show_facts() {
  const index = node_of(chosen);
  const head = chosen !== null && log[chosen].failure ? failure_facts(log[chosen]) : node_facts(index);
  by_id("facts").replaceChildren(
    ...head,
    ...list(`Plans of node ${index}`, plan_lines(tree.nodes[index])),
    ...list(`Failures at node ${index}`, failure_lines(index)),
    ...list("State", [tree.nodes[index].state.join(", ")]));
}

function node_facts(index) {
  if (index === 0) {
    return [html("h2", {}, "Node 0, the start")];
  }
  const {action, node} = log[chosen];
  return [
    html("h2", {}, `Node ${index}`),
    html("p", {}, `${action} from node ${node}, event ${chosen + 1}, depth ${tree.nodes[index].depth}`),
    attempt_line(chosen), ...verdict(index), ...changes(tree.nodes[index])];
}

function verdict(index) {
  const said = {
    true: html("p", {class: "found"}, "The goal holds where physics ended: the plan has been executed."),
    false: html("p", {class: "failed"}, "The goal holds, but the whole plan failed when it was executed once more."),
    null: html("p", {class: "faint"}, "The goal holds, but the plan is no better than one found before."),
  };
  return [said[verdicts.get(index)] ?? []].flat();
}

function failure_facts({node, action, failure}) {
  const {detail, segments} = attempts[chosen];
  const unseen = segments.length ? "Its motion was not recorded." : "Refused before anything was executed.";
  return [
    html("h2", {}, `Failed step from node ${node}`),
    html("p", {}, `${action}, event ${chosen + 1}`),
    html("p", {class: "failed"}, failures[failure].sentence + (detail ? `: ${detail}` : "")),
    attempt_line(chosen),
    html("p", {class: "faint"}, scene.motions[chosen] ? "" : unseen)];
}

function attempt_line(step) {
  const rejected = log[step].rejections.length;
  const before = rejected ? [`${rejected} k rejected before`] : [];
  return html("p", {class: "faint"}, [...about(step), ...before].join(" · "));
}

function changes(node) {
  const before = tree.nodes[node.parent].state;
  const gained = node.state.filter(atom => !before.includes(atom));
  const lost = before.filter(atom => !node.state.includes(atom));
  return list("What changed", [
    ...gained.map(atom => html("span", {class: "found"}, `+ ${atom}`)),
    ...lost.map(atom => html("span", {class: "faint"}, `− ${atom}`))]);
}

function plan_lines({index, plans: numbers}) {
  const entries = past();
  const opened = new Set(entries.map(entry => entry.event === "opening" ? entry.plan : null));
  return numbers.filter(plan => index > 0 || opened.has(plan)).map(plan => {
    const tries = entries.filter(entry => entry.node === index && entry.plan === plan).length;
    const actions = tree.plans[plan];
    const name = index === 0 ? `plan ${plan}, ` : "";  // only opened plans have a number that is seen elsewhere
    return actions.length ? [`${name}tried ${tries}×: `, html("span", {class: "faint"}, actions.join(", "))]
      : "nothing left to do";
  });
}

function failure_lines(index) {
  const steps = past().filter(entry => entry.failure && entry.node === index);
  const reasons = steps.map(step => `${step.action}: ${failures[step.failure].sentence}`);
  return tally(reasons).map(([reason, count]) => `${count}× ${reason}`);
}
