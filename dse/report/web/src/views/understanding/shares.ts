// Shares of a metric's variance as bars with their intervals: by each factor itself, and with all it does with others.
import { el } from "../../dom";
import { percent } from "../../format";
import type { Estimate, Part, Response } from "../../insight";

const HARDLY = 0.02;

/** The bars with what there is to say of them, and the factors in their *order*, those that matter most first. */
export function createShares(
  part: Part,
  { bars, together }: Response,
): { order: number[]; elements: (HTMLElement | false)[] } {
  const alone = new Map(bars.map(({ factor, share }) => [factor, share]));
  const totals = new Map((together?.totals ?? []).map(({ factor, share }) => [factor, share]));
  const worth = (factor: number): number => Math.max(alone.get(factor)?.[0] ?? 0, totals.get(factor)?.[0] ?? 0);
  const order = [...new Set([...alone.keys(), ...totals.keys()])].sort((a, b) => worth(b) - worth(a));
  if (!order.length) return { order, elements: [] };
  const row = (factor: number): HTMLElement => {
    const [own, total] = [alone.get(factor), totals.get(factor)];
    return el(
      "div",
      { class: "bar-row" },
      el("span", { class: "bar-name" }, part.factors[factor]!.label),
      el(
        "span",
        { class: "bar-tracks", "aria-hidden": "true" },
        own && track(own, "alone"),
        total && track(total, "total"),
      ),
      el("span", { class: "bar-value" }, own && told(own, "first-order"), total && told(total, "total")),
    );
  };
  const elements = [
    el(
      "h3",
      { class: "minor" },
      `Share of the variance that each factor explains alone (first-order)${totals.size ? ", and with its interactions (total)" : ""}, with 95 % intervals`,
    ),
    el("div", { class: "bars", id: "bars" }, ...order.map(row)),
    el(
      "p",
      { class: "hint", id: "together" },
      together ? aboutTogether(part, together) : "The rest to 100 % is interactions or noise.",
    ),
  ];
  return { order, elements };
}

function aboutTogether({ factors }: Part, { source, pairs }: NonNullable<Response["together"]>): string {
  const named = pairs
    .filter(({ share }) => (share[1] ?? 0) > HARDLY)
    .map(
      ({ one, other, share }) =>
        `${interval(share)} depends on both ${factors[one]!.label} and ${factors[other]!.label}`,
    );
  const depends = named.length ? `Of the variance ${named.join("; ")}. ` : "";
  return `${depends}Totals: by ${source}; its error is part of the intervals.`;
}

function track([value, low, high]: Estimate, kind: string): HTMLElement {
  const fill = el("span", { class: "fill" });
  const whisker = el("span", { class: "whisker" });
  fill.style.width = `${100 * (value ?? 0)}%`;
  whisker.style.left = `${100 * (low ?? 0)}%`;
  whisker.style.width = `${100 * ((high ?? 0) - (low ?? 0))}%`;
  return el("span", { class: `bar-track ${kind}` }, fill, whisker);
}

function told(share: Estimate, what: string): HTMLElement {
  return el(
    "span",
    {},
    el("b", {}, percent(share[0] ?? 0, 1)),
    ` ${what} `,
    el("span", { class: "muted" }, `(${interval(share, false)})`),
  );
}

function interval([value, low, high]: Estimate, whole = true): string {
  const ends = `${Math.round(100 * (low ?? 0))} \u2026 ${Math.round(100 * (high ?? 0))}\u202f%`;
  return whole ? `${Math.round(100 * (value ?? 0))}\u202f% (${ends})` : ends;
}
