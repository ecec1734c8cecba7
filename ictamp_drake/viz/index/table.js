// The page of a run: one row a problem. Texts are never taken for HTML, whatever they contain.
const {title, waiting, entries} = run;
const by_id = id => document.getElementById(id);
const distinct = key => [...new Set(entries.map(entry => entry[key]))];
const collator = new Intl.Collator("en", {numeric: true});

function html(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  Object.entries(attributes).forEach(([key, value]) => element.setAttribute(key, value));
  element.append(...children);
  return element;
}

// What a column is called, what its cells show, and what it is sorted by, if it is.
const columns = [
  {name: "", show: picture, used: entries.some(entry => entry.picture), style: "picture"},
  {name: "Problem", show: entry => entry.problem, by: entry => entry.problem, style: "name"},
  {name: "Level", show: entry => entry.level, by: entry => entry.level, used: distinct("level").length > 1},
  {name: "Strategy", show: entry => entry.strategy, by: entry => entry.strategy, used: distinct("strategy").some(Boolean)},
  {name: "Seed", show: entry => entry.seed, by: entry => entry.seed, used: distinct("seed").length > 1, style: "number"},
  {name: "Result", show: result, by: entry => `${entry.solved ? 0 : 1}${entry.reason}`, style: "result"},
  {name: "Time", show: entry => `${entry.seconds.toFixed(1)} s`, by: entry => entry.seconds, style: "number"},
  {name: "Skills", show: entry => entry.skills ?? "–", by: entry => entry.skills, style: "number"},
  {name: "Steps", show: entry => entry.steps, by: entry => entry.steps, style: "number"},
  {name: "", show: links, used: entries.some(entry => Object.keys(entry.links).length), style: "links"},
].filter(({used}) => used !== false);

function picture({picture, links, problem}) {
  if (!picture) {
    return "";
  }
  const image = html("img", {loading: "lazy", alt: `scene of ${problem}`, src: picture});
  const page = links.replay ?? links.search;
  return page ? html("a", {href: page}, image) : html("span", {}, image);
}

function result({solved, reason, details, error}) {
  const cell = html("div", {}, html("span", {class: solved ? "solved" : "unsolved"}, solved ? "solved" : "unsolved"));
  if (reason) {
    cell.append(`: ${reason}`);
  }
  cell.append(...details.map(detail => html("div", {class: "detail"}, detail)));
  if (error) {
    const last = error.trimEnd().split("\n").at(-1);
    cell.append(html("details", {class: "detail"}, html("summary", {}, last), html("pre", {}, error)));
  }
  return cell;
}

function links(entry) {
  return html("div", {}, ...Object.entries(entry.links).map(([name, href]) => html("a", {href}, name)));
}

const places = ["problem", "strategy", "seed"];
const by_place = (one, other) => places.reduce((so_far, key) => so_far || compare(one[key], other[key]), 0);

const rows = entries.toSorted(by_place).map(entry => ({
  entry,
  words: [entry.problem, entry.level, entry.strategy, entry.reason, ...entry.details, entry.error].join("\n").toLowerCase(),
  row: html("tr", {}, ...columns.map(({show, style = ""}) => html("td", {class: style}, show(entry)))),
}));

// The choices are in the address, so that a page that is read again, or sent to somebody, shows the same.
const choices = new URLSearchParams(location.hash.slice(1));
const filters = ["text", "result", "level", "strategy", "seed"];

function remember(key, value) {
  choices.set(key, value);
  if (value === "") {
    choices.delete(key);
  }
  location.replace(`#${choices}`);
}

function filter() {
  const {text, result, ...chosen} = Object.fromEntries(filters.map(key => [key, by_id(key).value]));
  const words = text.toLowerCase().split(/\s+/);
  const fits = ({entry, words: said}) => words.every(word => said.includes(word))
    && (!result || entry.solved === (result === "solved"))
    && Object.entries(chosen).every(([key, value]) => !value || String(entry[key]) === value);
  const shown = rows.filter(each => !(each.row.hidden = !fits(each)));
  const solved = shown.filter(({entry}) => entry.solved).length;
  by_id("shown").textContent = shown.length < rows.length ? `${shown.length} of ${rows.length} shown, ${solved} solved` : "";
  by_id("none").hidden = shown.length > 0;
  by_id("none").textContent = entries.length ? "No problem matches." : "No problem is finished yet.";
}

function compare(one, other) {
  return typeof one === "string" ? collator.compare(one, other) : one - other;
}

// Sort by a column; what has no value there comes last.
function sort(name, descending) {
  const {by} = columns.find(column => column.by && column.name === name) ?? {by: null};
  document.querySelectorAll("th").forEach(th => {
    th.removeAttribute("aria-sort");
    if (by && th.textContent === name) {
      th.setAttribute("aria-sort", descending ? "descending" : "ascending");
    }
  });
  const value = ({entry}) => by(entry);
  const order = (one, other) => (value(one) === null) - (value(other) === null)
    || (descending ? -1 : 1) * compare(value(one), value(other));
  document.querySelector("tbody").replaceChildren(...(by ? rows.toSorted(order) : rows).map(({row}) => row));
}

function sort_on_click(name) {
  const before = document.querySelector("th[aria-sort]");
  const descending = before?.textContent === name && before.getAttribute("aria-sort") === "ascending";
  remember("sort", name);
  remember("down", descending ? "1" : "");
  sort(name, descending);
}

function heading({name, by, style = ""}) {
  const button = html("button", {type: "button"}, name);
  button.addEventListener("click", () => sort_on_click(name));
  return html("th", {class: style, scope: "col"}, ...(by ? [button] : []));
}

function median(numbers) {
  const sorted = numbers.toSorted((one, other) => one - other);
  const middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

function summary() {
  const solved = entries.filter(entry => entry.solved);
  return [
    `${solved.length} of ${entries.length} solved`,
    ...(solved.length ? [`median ${median(solved.map(entry => entry.seconds)).toFixed(1)} s`] : []),
    ...(waiting ? [`${waiting} to do`] : []),
  ].join(" · ");
}

document.title = `${title} – run`;
document.querySelector("h1").textContent = title;
by_id("summary").textContent = summary();
document.querySelector("thead tr").append(...columns.map(heading));
for (const key of ["level", "strategy", "seed"]) {
  const values = distinct(key).sort(compare);
  by_id(key).hidden = values.length < 2;
  by_id(key).append(...values.map(value => html("option", {value}, value || "none")));
}
for (const key of filters) {
  by_id(key).value = choices.get(key) ?? "";
  by_id(key).addEventListener("input", () => {
    remember(key, by_id(key).value);
    filter();
  });
}
document.querySelector("form").addEventListener("submit", event => event.preventDefault());
sort(choices.get("sort"), choices.has("down"));
filter();
