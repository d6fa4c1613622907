// The places of a car as rows of chips: what can be chosen, what it costs more, and why something cannot be had.
import { el } from "../dom";
import type { Alternative, Offer, Point } from "./messages";

const MOST_NAMES = 3;

/** What is done at a place: `change` is the place whose choice is given up for it. */
export type Pick = (point: Point, alternative: Alternative, change?: string) => void;

/** A place: its name, a chip for each alternative, and below a line about the one that is pointed at. */
export function drawPoint(offer: Offer, point: Point, pick: Pick): HTMLElement {
  const has = point.chosen ?? point.implied;
  const state = point.chosen ? "" : point.implied ? "follows" : "open";
  const line = el("p", { class: "about" });
  const explain = (each: Alternative): void => {
    const change = each.change.find((path) => offer.chosen[path] !== undefined);
    const button = el(
      "button",
      { type: "button", class: "change", click: () => pick(point, each, change) },
      `Change ${change && placeOf(offer, change)} to get this`,
    );
    line.replaceChildren(noteOf(offer, each, has === each.name), !each.is_possible && change ? button : "");
  };
  const chips = point.alternatives.map((each) => drawChip(offer, point, each, has, explain, () => pick(point, each)));
  return el(
    "section",
    { class: "point", "aria-label": point.title },
    el("h2", {}, capital(point.title), state ? el("span", { class: `state ${state}` }, state) : null),
    el("div", { class: "alternatives", role: "group", "aria-label": point.title }, ...chips),
    line,
  );
}

function drawChip(
  offer: Offer,
  point: Point,
  each: Alternative,
  has: string | null,
  explain: (each: Alternative) => void,
  pick: () => void,
): HTMLElement {
  const note = noteOf(offer, each, has === each.name);
  const show = (): void => explain(each);
  return el(
    "button",
    {
      type: "button",
      class: `alternative${each.is_possible ? "" : " out"}`,
      "data-choice": `${point.path}:${each.name}`,
      "aria-pressed": String(has === each.name),
      "aria-disabled": each.is_possible ? undefined : "true",
      mouseenter: show,
      focus: show,
      click: () => (each.is_possible ? pick() : show()),
    },
    el("span", { class: "name" }, each.title || each.name),
    el("span", { class: "more" }, differences(point, each, has)),
    note ? el("span", { class: "unseen" }, ` ${note}`) : null,
  );
}

/** What `each` costs and weighs more than what is taken at its place, else than the least of what is possible there. */
export function differences(point: Point, each: Alternative, has: string | null): string {
  const taken = point.alternatives.find(({ name }) => name === has);
  return each.adds
    .map(({ name, unit, value }) => {
      const of = (other: Alternative): number => other.adds.find((add) => add.name === name)?.value ?? 0;
      const open = point.alternatives.filter(({ is_possible }) => is_possible).map(of);
      const base = taken ? of(taken) : open.length ? Math.min(...open) : value;
      const more = Number((value - base).toPrecision(6));
      return more ? `${more > 0 ? "+" : "\u2212"}${Math.abs(more).toLocaleString("en")} ${unit}` : "";
    })
    .filter(Boolean)
    .join(" \u00b7 ");
}

/** In sentences: what it would exclude, or why it cannot be had. */
export function noteOf(offer: Offer, each: Alternative, isTaken: boolean): string {
  if (!each.is_possible) {
    const because = each.because.map(sentence).join(" ");
    return because ? `Not possible: ${because}` : "Not possible with the other choices.";
  }
  const names = isTaken ? [] : each.rules_out.map(({ path, name }) => titleOf(offer, path, name));
  const more = names.length > MOST_NAMES ? ` and ${names.length - MOST_NAMES} more` : "";
  return names.length ? `This excludes ${names.slice(0, MOST_NAMES).join(", ")}${more}.` : "";
}

/** Why nothing can be driven yet; "" if it can. */
export function whyNot(offer: Offer): string {
  if (offer.configuration) return "";
  if (offer.left === "0") return `These choices exclude each other: ${offer.conflict.map(sentence).join(" ")}`;
  const open = offer.points.filter((point) => !point.chosen && !point.implied).map(({ title }) => title);
  const more = open.length > 4 ? ` and ${open.length - 4} more places` : "";
  return `A drive needs one car. Choose ${open.slice(0, 4).join(", ")}${more}, or have the rest chosen for you.`;
}

export function sentence(text: string): string {
  const whole = text.trim();
  return whole && `${capital(whole)}${/[.!?]$/.test(whole) ? "" : "."}`;
}

function capital(text: string): string {
  return `${text[0]?.toUpperCase() ?? ""}${text.slice(1)}`;
}

function titleOf(offer: Offer, path: string, name: string): string {
  const point = offer.points.find((each) => each.path === path);
  return point?.alternatives.find((each) => each.name === name)?.title || name;
}

function placeOf(offer: Offer, path: string): string {
  return offer.points.find((point) => point.path === path)?.title ?? path;
}
