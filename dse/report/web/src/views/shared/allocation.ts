// Which function a design allocates to which host, with the load of each host against its capacity.
import { el } from "../../dom";
import { number, withUnit } from "../../format";
import type { Allocation, Configuration } from "../../study";

const MARK = "\u25cf";

/** A table for each allocation: functions by hosts. */
export function allocationTables({ allocations }: Configuration): HTMLElement[] {
  return allocations.map((allocation) => {
    const { place, hosts, functions, on, loads } = allocation;
    const cells = hosts.map((host) => el("th", { scope: "col" }, host));
    const amounts = loads.map(({ load }) => el("th", { scope: "col", class: "numeric" }, load));
    const rows = functions.map((name) =>
      el(
        "tr",
        {},
        el("th", { scope: "row" }, name),
        ...hosts.map((host) =>
          el(
            "td",
            {},
            on[name]!.includes(host) && el("span", { role: "img", "aria-label": `${name} on ${host}` }, MARK),
          ),
        ),
        ...loads.map(({ loads: of, unit }) => el("td", { class: "numeric" }, withUnit(number(of[name]!, 3), unit))),
      ),
    );
    const sums = loadsOf(allocation).map(([title, texts]) =>
      el(
        "tr",
        {},
        el("th", { scope: "row" }, title),
        ...texts.map((text) => el("td", {}, text)),
        ...loads.map(() => el("td", {})),
      ),
    );
    return el(
      "div",
      { class: "scroll", tabindex: 0, role: "region", "aria-label": `Allocation ${place}` },
      el(
        "table",
        { class: "plain allocation" },
        el("caption", {}, `Allocation ${place}`),
        el("thead", {}, el("tr", {}, el("th", { scope: "col" }, "Function"), ...cells, ...amounts)),
        el("tbody", {}, ...rows, ...sums),
      ),
    );
  });
}

/** For each load a title, and by host its sum, of the capacity, with the share of it that is used. */
export function loadsOf({ hosts, functions, on, loads }: Allocation): [string, string[]][] {
  return loads.map(({ load, capacity, unit, loads: of, capacities }) => [
    load === capacity ? `sum of ${load}` : `sum of ${load}, of ${capacity}`,
    hosts.map((host) => {
      const most = capacities[host]!;
      const sum = functions.reduce((all, name) => all + (on[name]!.includes(host) ? of[name]! : 0), 0);
      const share = most > 0 ? ` (${number((100 * sum) / most, 3)} %)` : "";
      return `${number(sum, 3)} of ${withUnit(number(most, 3), unit)}${share}`;
    }),
  ]);
}
