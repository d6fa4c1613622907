// A replay that is driven on: from any moment with other parameters, simulated by the page.
import { el } from "../dom";
import { number } from "../format";
import { readSimulation, type SimulationDocument } from "../simulate/document";
import type { Change, Ran } from "../simulate/engine";
import { createPool, type Pool } from "../simulate/pool";
import { type Control, controlsOf, createSliders, type Sliders } from "../simulate/sliders";
import type { LiveScene, Recording } from "./data";

const WORDS = ["pass", "fail", "not exercised", "failed to run", ""];
const CLASSES = ["pass", "fail", "open", "broken", ""];

/** The panel; *now* tells the moment that is shown, *drawAgain* that there is something else to see. */
export function createDriving(recording: Recording, now: () => number, drawAgain: () => void): HTMLElement {
  const box = el(
    "aside",
    { class: "driving", "aria-label": "Drive on" },
    el("p", { class: "muted" }, "compiling \u2026"),
  );
  readSimulation().then(
    ({ document, module, worker }) =>
      new Driving(box, recording, document, createPool(worker, document, module), now, drawAgain),
    (error) => box.replaceChildren(el("p", { class: "problem" }, `This page cannot simulate here: ${error}`)),
  );
  return box;
}

class Driving {
  readonly #controls: Control[];
  readonly #sliders: Sliders;
  readonly #start: Float64Array;
  readonly #problem = el("p", { class: "problem", role: "alert", hidden: true });
  readonly #list = el("ul", { class: "changes" });
  readonly #verdicts = el("table", { class: "verdicts" });
  #changes: Change[] = [];
  #before: Ran | null = null;

  constructor(
    private readonly box: HTMLElement,
    private readonly recording: Recording,
    private readonly document: SimulationDocument,
    private readonly pool: Pool,
    private readonly now: () => number,
    private readonly drawAgain: () => void,
  ) {
    const { settings } = document.systems[0]!;
    this.#start = Float64Array.from(settings, ([, , value]) => value);
    const all = controlsOf(document, 0);
    this.#controls = all.filter(({ setting }) => setting.tunable);
    this.#sliders = createSliders(this.#controls, this.#start, (place, si) => this.#move(place, si));
    const back = el("button", { type: "button", class: "all-back", click: () => this.#take([]) }, "As it was");
    box.replaceChildren(
      el("div", { class: "reading" }, el("h2", {}, "Drive on"), back),
      el("p", { class: "muted" }, "What you change counts from the moment shown; the page simulates what follows."),
      this.#list,
      this.#problem,
      this.#verdicts,
      this.#sliders.element,
    );
    this.#take([]);
  }

  #move(place: number, si: number): void {
    const { step, steps } = this.document.systems[0]!;
    const first = Math.min(Math.round(this.now() / step), steps - 1);
    const earlier = this.#changes.filter((each) => each.first <= first);
    const later = this.#changes.filter((each) => each.first > first);
    const changed = (values: Float64Array): Float64Array => values.map((value, at) => (at === place ? si : value));
    const last = earlier.at(-1);
    const here = { first, values: changed(last?.values ?? this.#start) };
    const kept = last?.first === first ? earlier.slice(0, -1) : earlier;
    this.#take([...kept, here, ...later.map((each) => ({ ...each, values: changed(each.values) }))]);
  }

  #take(changes: Change[]): void {
    this.#changes = changes;
    this.#sliders.show(changes.at(-1)?.values ?? this.#start);
    this.#list.replaceChildren(...changes.map((each, at) => this.#told(each, changes[at - 1]?.values ?? this.#start)));
    // What is changed at the very start has counted from the start.
    const atOnce = changes[0]?.first === 0 ? changes[0] : null;
    const values = atOnce?.values ?? this.#start;
    const asked = { system: 0, draw: 0, values, traces: false, columns: true, changes: changes.slice(atOnce ? 1 : 0) };
    this.pool.now(asked, (ran) => this.#show(ran));
  }

  #told({ first, values }: Change, before: Float64Array): HTMLElement {
    const moment = (first * this.document.systems[0]!.step).toFixed(1);
    const parts = this.#controls
      .filter(({ place }) => values[place] !== before[place])
      .map(({ title, unit, place, factor, offset }) =>
        `${title} ${number((values[place]! - offset) / factor)} ${unit}`.trim(),
      );
    return el("li", {}, `from ${moment} s: ${parts.join(", ")}`);
  }

  #show(ran: Ran): void {
    this.#problem.hidden = !ran.problem;
    this.#problem.textContent = ran.problem && `The run failed: ${ran.problem}`;
    if (ran.problem) return;
    this.#before ??= ran;
    const { titles } = this.document;
    const cell = (mark: number): HTMLElement => el("td", { class: CLASSES[mark]! }, WORDS[mark]!);
    const rows = titles.flatMap((title, at) =>
      WORDS[ran.marks[at]!]
        ? [
            el(
              "tr",
              {},
              el("th", { scope: "row" }, title),
              cell(this.#before!.marks[at]!),
              el("td", {}, "\u2192"),
              cell(ran.marks[at]!),
            ),
          ]
        : [],
    );
    this.#verdicts.replaceChildren(el("tbody", {}, ...rows));
    this.box.dataset.runs = String(Number(this.box.dataset.runs ?? 0) + 1);
    this.recording.become(sumsOf(this.recording.document.live!, ran.columns));
    this.drawAgain();
  }
}

/** The columns of a scene from those of a run. */
export function sumsOf(
  { sums, signals }: Pick<LiveScene, "sums" | "signals">,
  columns: Readonly<Record<string, Float64Array>>,
): Map<string, Float64Array> {
  const rows = Object.values(columns)[0]?.length ?? 0;
  return new Map(
    Object.entries(sums).map(([name, [constant, ...parts]]) => {
      const made = new Float64Array(rows).fill(constant);
      for (const [signal, factor] of parts) {
        const values = columns[signals[signal]!]!;
        for (let row = 0; row < rows; row++) made[row]! += factor * values[row]!;
      }
      return [name, made];
    }),
  );
}
