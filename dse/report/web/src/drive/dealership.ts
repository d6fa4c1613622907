// Which car, and where: only what can be built can be chosen.
import { el } from "../dom";
import { drawPoint, type Pick, whyNot } from "./choices";
import { ask, type Offer, offerAddress, written } from "./messages";

export interface Order {
  bench: string;
  chosen: Record<string, string>;
  driver: string;
}

export interface Bench {
  name: string;
  title: string;
}

/** Shows itself in *page*; `go` may fail in words. */
export function showDealership(
  page: HTMLElement,
  benches: Bench[],
  order: Order,
  go: (order: Order) => Promise<void>,
  boards: Node,
): void {
  const points = el("div", { class: "points" });
  const left = el("p", { class: "count", "aria-live": "polite" });
  const totals = el("dl", { class: "totals" });
  const problem = el("p", { class: "problem", role: "alert" });
  const why = el("p", { id: "why-not", class: "why" });
  const about = el("p", { class: "muted" });
  const link = el("a", { class: "share" }, "Link to this car on this road");
  const driver = el("input", {
    id: "driver",
    value: order.driver,
    maxlength: 40,
    autocomplete: "nickname",
    placeholder: "anonymous",
    input: () => (order.driver = driver.value.trim()),
  });
  const start = el(
    "button",
    {
      type: "button",
      class: "go",
      "aria-describedby": "why-not",
      click: () =>
        void run(async () => {
          start.disabled = true;
          start.textContent = "Starting \u2026";
          await go(order);
        }),
    },
    "Drive",
  );
  const rest = el("button", { type: "button", click: () => void run(fill) }, "Choose the rest for me");
  const none = el("button", { type: "button", click: () => void choose({}) }, "Start over");
  let offer: Offer | null = null;
  let asked = 0;

  const bench = el("select", {
    id: "bench",
    change: () => {
      order.bench = bench.value;
      void choose(order.chosen);
    },
  });
  for (const { name, title } of benches) bench.append(el("option", { value: name }, title));
  bench.value = order.bench;

  const run = async (what: () => Promise<void>): Promise<void> => {
    problem.textContent = "";
    try {
      await what();
    } catch (error) {
      problem.textContent = `The request failed: ${(error as Error).message}.`;
    }
    draw();
  };
  const choose = (chosen: Record<string, string>): Promise<void> =>
    run(async () => {
      const mine = ++asked;
      const found = await ask<Offer>(offerAddress(order.bench, chosen));
      if (mine !== asked) return; // somebody has clicked on meanwhile
      offer = found;
      order.chosen = found.chosen;
      history.replaceState(null, "", address(order));
    });
  const fill = async (): Promise<void> => {
    while (offer && !offer.configuration) {
      const open = offer.points.find((point) => !point.chosen && !point.implied);
      const first = open?.alternatives.find((each) => each.is_possible);
      if (!open || !first) return;
      await choose({ ...order.chosen, [open.path]: first.name });
    }
  };
  const draw = (): void => {
    start.textContent = "Drive";
    start.disabled = !offer?.configuration;
    rest.hidden = !offer || Boolean(offer.configuration) || offer.left === "0";
    why.textContent = offer ? whyNot(offer) : "";
    if (!offer) return;
    const focused = (document.activeElement as HTMLElement | null)?.dataset.choice;
    about.textContent = offer.title;
    left.replaceChildren(
      el("b", {}, grouped(offer.left)),
      offer.left === "1" ? " possible car of " : " possible cars of ",
      grouped(offer.total),
    );
    totals.replaceChildren(
      ...offer.totals.map(({ title, unit, low, high }) =>
        el("div", {}, el("dt", {}, title), el("dd", {}, range(low, high, unit))),
      ),
    );
    points.replaceChildren(...offer.points.map((point) => drawPoint(offer!, point, pick)));
    if (focused) points.querySelector<HTMLElement>(`[data-choice="${CSS.escape(focused)}"]`)?.focus();
    link.href = address(order);
  };
  const pick: Pick = (point, { name }, change) => {
    const chosen = { ...order.chosen };
    if (change) delete chosen[change];
    if (chosen[point.path] === name) delete chosen[point.path];
    else chosen[point.path] = name;
    void choose(chosen);
  };
  const side = el(
    "aside",
    { class: "card order", "aria-label": "Your car" },
    el("h2", {}, "Your car"),
    left,
    totals,
    el("label", { class: "field", for: "driver" }, el("span", {}, "Driver"), driver),
    el("div", { class: "start" }, start, why),
    rest,
    problem,
    el("p", { class: "links" }, link, none),
  );
  page.replaceChildren(
    el(
      "header",
      { class: "top" },
      el("h1", {}, "Test drive"),
      about,
      el("span", { class: "spring" }),
      el("a", { href: "/" }, "All studies"),
    ),
    el(
      "main",
      { class: "dealership" },
      el(
        "div",
        {},
        el("label", { class: "field road", for: "bench" }, el("span", {}, "Road and traffic"), bench),
        points,
      ),
      side,
      boards,
    ),
  );
  draw();
  void choose(order.chosen);
}

export function address({ bench, chosen }: Order): string {
  return `#${new URLSearchParams({ bench, chosen: written(chosen) })}`;
}

function grouped(count: string): string {
  return count.replace(/\B(?=(\d{3})+$)/g, ",");
}

function range(low: number, high: number, unit: string): string {
  const text = (value: number): string =>
    value.toLocaleString("en", Math.abs(value) < 100 ? { maximumSignificantDigits: 3 } : { maximumFractionDigits: 0 });
  return `${text(low)}${high - low > 1e-9 * Math.abs(high) ? ` \u2026 ${text(high)}` : ""} ${unit}`.trim();
}
