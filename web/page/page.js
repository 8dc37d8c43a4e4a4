// The page: files and columns in, the report out. A worker does the work; to cancel is to end the worker.

const $ = (id) => document.getElementById(id);
const lists = { fit: [], holdout: [] };
const roles = ["time", "input", "position"];
const settings = [...roles, "time_unit", "wrap"];
let worker = null;
let ticking = null;
let looks = 0;

const show = (id, on) => { $(id).hidden = !on; };

function say(text) {
  $("message").textContent = text;
  show("message", text !== "");
}

/** Gives a task to a new worker; `step` is told how it goes on. */
function ask(task, step = () => {}) {
  const own = new Worker("worker.js", { type: "module" });
  const answer = new Promise((resolve, reject) => {
    own.onmessage = ({ data }) => {
      if (data.kind === "step") return step(data.step);
      own.terminate();
      if (data.kind === "done") resolve(data.result); else reject(data.text);
    };
    own.onerror = (event) => { own.terminate(); reject(`the page cannot work here: ${event.message ?? "its files do not load"}`); };
  });
  own.postMessage(task);
  return { own, answer };
}

function choices(select, names, chosen, none) {
  const options = names.map((name) => new Option(name, name, false, name === chosen));
  select.replaceChildren(...(none === undefined ? [] : [new Option(none, "", false, !chosen)]), ...options);
}

/** The channels of the first recording, with what is guessed of them. */
async function lookAt(file) {
  const mine = ++looks;
  let seen;
  try {
    seen = (await ask({ task: "look", file }).answer).files[0];
  } catch (text) {
    if (mine === looks) { show("columns", false); say(text); }
    return;
  }
  if (mine !== looks) return;
  const names = seen.channels.map((channel) => channel.name);
  const guesses = { time: seen.time, input: seen.drive, position: seen.position };
  for (const role of roles) {
    choices($(role), names, guesses[role]?.channel, role === "time" && seen.stamped ? "the file's own stamps" : undefined);
    $(`${role}-why`).textContent = guesses[role]?.reason ?? (role === "time" && seen.stamped ? "" : "nothing is like it; choose");
    if (!guesses[role] && !(role === "time" && seen.stamped)) $(role).selectedIndex = -1;
  }
  // What a guess needs to be read, the command that `look` proposes has.
  const flag = (name) => seen.command?.match(new RegExp(`${name} (\\S+)`))?.[1] ?? "";
  $("time_unit").value = flag("--time-unit");
  $("wrap").value = flag("--wrap");
  $("faults").replaceChildren(...seen.faults.map((fault) => Object.assign(document.createElement("li"), { textContent: fault.text, className: fault.kind })));
  show("columns", true);
}

function list(name) {
  const items = lists[name].map((file, k) => {
    const item = document.createElement("li");
    const drop = Object.assign(document.createElement("button"), { type: "button", textContent: "×", ariaLabel: `leave out ${file.name}` });
    drop.onclick = () => { lists[name].splice(k, 1); changed(name); };
    item.append(drop, `${file.name}, ${(file.size / 1e6).toFixed(2)} MB`);
    return item;
  });
  $(`${name}-list`).replaceChildren(...items);
}

function changed(name) {
  list(name);
  say("");
  show("result", false);
  if (lists.fit.length === 0) show("columns", false);
  else if (name === "fit") lookAt(lists.fit[0]);
}

function add(name, files) {
  lists[name].push(...files);
  changed(name);
}

for (const name of ["fit", "holdout"]) {
  const input = $(`${name}-files`);
  input.onchange = () => { add(name, [...input.files]); input.value = ""; };
}
const over = (on) => (event) => { event.preventDefault(); document.body.classList.toggle("over", on); };
document.body.ondragover = over(true);
document.body.ondragleave = over(false);
document.body.ondrop = (event) => { over(false)(event); add("fit", [...event.dataTransfer.files]); };

function progress(began) {
  let of = 0;
  return (step) => {
    if (step.step) { $("step").textContent = step.step; $("bar").removeAttribute("value"); }
    if (step.round) { $("step").textContent = `looking for effect ${step.round} among ${step.candidates}`; of = step.candidates; $("bar").max = of; $("bar").value = 0; }
    if (step.compared && of > 0) $("bar").value += 1;
    $("seconds").textContent = `${((performance.now() - began) / 1e3).toFixed(0)} s`;
  };
}

function working(on) {
  show("work", on);
  for (const element of document.querySelectorAll("#drop input, #drop button, #columns select, #columns input, #run")) element.disabled = on;
  clearInterval(ticking);
}

$("run").onclick = async () => {
  say("");
  show("result", false);
  working(true);
  $("work").scrollIntoView({ block: "nearest" });
  const began = performance.now();
  const step = progress(began);
  step({ step: "loading" });
  ticking = setInterval(() => step({}), 500);
  const columns = Object.fromEntries(settings.map((name) => [name, $(name).value.trim()]));
  const { own, answer } = ask({ task: "run", columns, ...lists }, step);
  worker = own;
  try {
    present(await answer);
  } catch (text) {
    say(text);
  }
  worker = null;
  working(false);
};

$("cancel").onclick = () => {
  worker?.terminate();
  worker = null;
  working(false);
  say("Cancelled. Nothing was kept.");
};

function present(result) {
  const save = (id, text, type) => {
    URL.revokeObjectURL($(id).href);
    $(id).href = URL.createObjectURL(new Blob([text], { type }));
  };
  save("save-report", result.report, "text/html");
  save("save-model", result.model, "application/toml");
  save("save-json", JSON.stringify({ identify: result.identify, discover: result.discover }, null, 2), "application/json");
  $("words").textContent = `${result.identify_text}\n${result.discover_text}`;
  const frame = $("report");
  // As high as the report, so that the page has one scroll bar.
  frame.onload = () => { frame.style.height = `${frame.contentDocument.documentElement.scrollHeight + 4}px`; };
  frame.srcdoc = result.report;
  show("result", true);
  $("result").scrollIntoView();
  // For whoever drives the page by a program.
  window.breakaway = result;
}
