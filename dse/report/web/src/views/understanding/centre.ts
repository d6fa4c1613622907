// The plane through the robust centre: how probable all requirements together are, and the largest ellipse around it.
import { el } from "../../dom";
import { number, withUnit } from "../../format";
import type { Around } from "../../insight";
import type { Store } from "../../store";
import { placeText } from "../shared/places";
import { positionOf, runButton } from "../shared/runs";
import { chanceFigure } from "./chances";

/** Nothing where no robust centre can be told. */
export function createAround(store: Store): HTMLElement | false {
  const { around } = store.study.insight!;
  if (!around.length) return false;
  return el(
    "div",
    { id: "around" },
    el("h3", { class: "minor" }, "Around the robust centre, all requirements together"),
    el(
      "p",
      { class: "hint" },
      "Colour: a lower bound of the probability that all requirements are met. The ellipse is the largest one around the centre in which this bound is at least 95 %; all other variables are as in the centre\u2019s run. Requirements that no run fails count as met.",
    ),
    el("div", { class: "minis maps" }, ...around.map((each, index) => figure(store, each, index))),
  );
}

function figure(store: Store, each: Around, index: number): HTMLElement {
  const drawn = chanceFigure(
    store,
    each.map,
    `around-${index}`,
    `All requirements around run ${each.run}`,
    (pen, at, colours) => {
      pen.beginPath();
      each.outline.forEach(([across, up], corner) =>
        corner ? pen.lineTo(...at(across, up)) : pen.moveTo(...at(across, up)),
      );
      if (each.outline.length) pen.lineTo(...at(...each.outline[0]!));
      for (const [colour, width] of [
        [colours.plot, 4],
        [colours.target, 2],
      ] as const) {
        pen.strokeStyle = colour;
        pen.lineWidth = width;
        pen.stroke();
      }
    },
  );
  const at = positionOf(store.study, each.run);
  drawn.append(el("p", { class: "hint" }, textOf(store, each), " ", at >= 0 && runButton(store, at)));
  return drawn;
}

function textOf({ study }: Store, { map, outline }: Around): string {
  if (!outline.length) return "Next to the centre the bound is below 95 %, so there is no ellipse.";
  const factors = study.insight!.parts.flatMap(({ factors }) => factors);
  const reach = map.plane.map((variable, axis) => {
    const places = outline.map((corner) => corner[axis]!);
    const ends = [Math.min(...places), Math.max(...places)];
    const factor = factors.find((each) => each.variable === variable);
    const { title, unit, low, high } = study.variables[variable]!;
    const [from, to] = ends.map((place) =>
      factor ? placeText(factor, place) : withUnit(number(low + place * (high - low), 4), unit),
    );
    return `${title} from ${from} to ${to}`;
  });
  return `The ellipse covers ${reach.join(" and ")}.`;
}
