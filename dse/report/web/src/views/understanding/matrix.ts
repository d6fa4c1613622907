// All planes of two design variables as small pictures, with cross-hairs at the selected run; a click opens one.

import { el } from "../../dom";
import { count, group } from "../../format";
import { fixedThrough, liesIn, startingPoint } from "../../plane/plane";
import { spaced } from "../../plot/frame";
import { paintedBy, type Sheet } from "../../plot/sheet";
import { everyCondition, type Points, pointsOf } from "../../points";
import type { State, Store } from "../../store";
import type { Study } from "../../study";
import { palette } from "../../theme";
import { FAIL, FAILED, NOT_EXERCISED, PASS } from "../../verdicts";
import { chooseMatrixVariables, MOST_VARIABLES, matrixVariables } from "./selection";

const MOST_POINTS = 4000;
const RIM = 6;

interface Cell {
  x: number;
  y: number;
  runs: number[];
  button: HTMLElement;
  told: HTMLElement;
  repaint: () => void;
}

export function createMatrix(store: Store): HTMLElement {
  const { study } = store;
  let shown = matrixVariables(store);
  const grid = el("div", { class: "pairs-grid", id: "pairs" });
  let cells: Cell[] = [];
  const paintAll = (): void => {
    for (const cell of cells) {
      tell(store, cell);
      cell.repaint();
    }
  };
  const build = (): void => {
    cells = [];
    grid.style.setProperty("--columns", String(shown.length - 1));
    grid.replaceChildren(
      ...shown.slice(1).flatMap((y, row) =>
        shown.slice(0, -1).map((x, column) => {
          if (column > row) return el("span", {});
          const cell = createCell(store, x, y);
          cells.push(cell);
          return cell.button;
        }),
      ),
    );
    requestAnimationFrame(paintAll);
  };
  build();
  new ResizeObserver(paintAll).observe(grid);
  store.subscribe((_, changed) => {
    const now = changed.has("settings") ? matrixVariables(store) : shown;
    if (now.join() !== shown.join()) {
      shown = now;
      build();
    } else if (
      grid.isConnected &&
      ["thresholds", "selected", "configuration", "theme", "brushes", "fixed"].some((key) =>
        changed.has(key as keyof State),
      )
    )
      paintAll();
  });
  const many = study.variables.length > MOST_VARIABLES;
  return el("div", {}, el("p", { class: "hint" }, note(study)), many && chooser(store), grid);
}

function note(study: Study): string {
  if (study.sampler === "scattered")
    return "Runs of the configuration shown. The other variables differ between them: each picture is a projection, not a plane.";
  return study.sampler === "sliced"
    ? "Only runs in the plane, all other variables at the values held; runs of other planes are not mixed in."
    : "Only runs in the plane through the selected run; runs elsewhere are not mixed in.";
}

function chooser(store: Store): HTMLElement {
  const boxes = store.study.variables.map((variable, index) => {
    const box = el("input", {
      type: "checkbox",
      change: () => {
        const others = matrixVariables(store).filter((each) => each !== index);
        chooseMatrixVariables(
          store,
          (box.checked ? [...others, index] : others).sort((a, b) => a - b),
        );
      },
    });
    return el("label", { class: "check" }, box, variable.title);
  });
  const refresh = (): void => {
    const shown = matrixVariables(store);
    boxes.forEach((label, index) => {
      const box = label.firstChild as HTMLInputElement;
      box.checked = shown.includes(index);
      box.disabled = box.checked ? shown.length <= 2 : shown.length >= MOST_VARIABLES;
    });
  };
  refresh();
  store.subscribe((_, changed) => {
    if (changed.has("settings")) refresh();
  });
  return el("fieldset", { class: "checks" }, el("legend", {}, `Variables (${MOST_VARIABLES} at most)`), ...boxes);
}

function createCell(store: Store, x: number, y: number): Cell {
  const canvas = el("canvas", { "aria-hidden": "true" });
  const told = el("span", { class: "pair-told" });
  const { variables } = store.study;
  const button = el(
    "button",
    {
      type: "button",
      class: "pair",
      click: () => store.set({ x, y, view: "plot" }),
      title: `Open ${variables[x]!.title} \u00d7 ${variables[y]!.title} in the plot`,
    },
    el("span", { class: "pair-y" }, `\u2191 ${variables[y]!.title}`),
    canvas,
    el("span", { class: "pair-x" }, `\u2192 ${variables[x]!.title}`),
    told,
  );
  const cell: Cell = {
    x,
    y,
    runs: [],
    button,
    told,
    repaint: paintedBy(canvas, (sheet) => paint(sheet, store, cell), {
      title: () => `${variables[y]!.title} over ${variables[x]!.title}`,
    }),
  };
  return cell;
}

/** Designs at the worst of their conditions; where a condition is an axis, as the plot would have it. */
function judgedOn(store: Store, x: number, y: number): Points {
  const isAxis = [x, y].some((index) => store.study.variables[index]!.role === "condition");
  return isAxis ? pointsOf(store, { ...everyCondition(store.study), x, y }) : store.designs();
}

function runsOf(store: Store, x: number, y: number): number[] {
  const { study, state } = store;
  const { configuration, selected } = state;
  const own = study.sampler === "full_factorial" && selected >= 0 && study.configuration[selected] === configuration;
  const fixed = own
    ? fixedThrough(study, startingPoint(study), selected)
    : study.sampler === "sliced"
      ? startingPoint(study)
      : state.fixed;
  const found: number[] = [];
  for (const run of judgedOn(store, x, y).runs) {
    const there =
      study.sampler === "scattered"
        ? study.configuration[run] === configuration
        : liesIn(study, run, { configuration, x, y, fixed });
    if (there) found.push(run);
  }
  return found;
}

function tell(store: Store, cell: Cell): void {
  const { x, y, told } = cell;
  const { study } = store;
  const {
    judgement: { overall },
    noun,
  } = judgedOn(store, x, y);
  const runs = runsOf(store, x, y);
  cell.runs = runs;
  const passing = runs.filter((run) => overall[run] === PASS).length;
  const together = study.sampler !== "sliced" || study.slices.some((names) => names.includes(x) && names.includes(y));
  told.textContent = together ? `${group(passing)} of ${count(runs.length, noun)} pass` : "not varied together";
}

function paint({ pen, width, height }: Sheet, store: Store, { x, y, runs }: Cell): void {
  const { study, state } = store;
  const {
    judgement: { overall },
    within: mask,
  } = judgedOn(store, x, y);
  const colours = palette();
  const place = (variable: number, run: number, from: number, to: number): number => {
    const { values, low, high, apart, log } = study.variables[variable]!;
    return spaced([low, high], { apart, log }, from, to)(values[run]!);
  };
  const across = (run: number): number => place(x, run, RIM, width - RIM);
  const up = (run: number): number => place(y, run, height - RIM, RIM);
  pen.fillStyle = colours.plot;
  pen.fillRect(0, 0, width, height);
  const stride = Math.ceil(runs.length / MOST_POINTS);
  const size = runs.length > 600 ? 2 : 3;
  const inks = {
    [FAIL]: colours.line,
    [NOT_EXERCISED]: colours.muted,
    [PASS]: colours.pass,
    [FAILED]: colours.broken,
  } as Record<number, string>;
  for (const mark of [FAIL, NOT_EXERCISED, FAILED, PASS]) {
    pen.fillStyle = pen.strokeStyle = mark === FAIL ? colours.ink : inks[mark]!;
    pen.lineWidth = 1;
    for (let index = 0; index < runs.length; index += stride) {
      const run = runs[index]!;
      if (overall[run] !== mark) continue;
      pen.globalAlpha = mask && !mask[run] ? 0.12 : mark === FAIL ? 0.45 : 1;
      const [a, b] = [across(run), up(run)];
      // Told apart by form as well: filled, dot, hollow.
      if (mark === NOT_EXERCISED) pen.strokeRect(a - size / 2, b - size / 2, size, size);
      else if (mark === PASS) pen.fillRect(a - size / 2 - 0.5, b - size / 2 - 0.5, size + 1, size + 1);
      else pen.fillRect(a - 0.75, b - 0.75, 1.5, 1.5);
    }
  }
  pen.globalAlpha = 1;
  const { selected } = state;
  if (selected < 0 || study.configuration[selected] !== state.configuration) return;
  pen.strokeStyle = colours.current;
  pen.lineWidth = 1;
  // A run outside of the plane has its cross-hairs broken.
  pen.setLineDash(runs.includes(judgedOn(store, x, y).first(selected)) ? [] : [3, 3]);
  pen.beginPath();
  pen.moveTo(across(selected), 0);
  pen.lineTo(across(selected), height);
  pen.moveTo(0, up(selected));
  pen.lineTo(width, up(selected));
  pen.stroke();
  pen.setLineDash([]);
}
