// A world that several people share: who is in it, and seats to watch.
import { el } from "../dom";
import { ask, type Drive } from "./messages";

export interface Seat {
  number: number;
  driver: string;
  simulated: boolean;
  time: number | null;
  speed: number | null;
  /** Its simulation does not answer: the others see it stopped. */
  stopped: boolean;
}

export interface World {
  most: number;
  seats: Seat[];
  problem?: string;
  /** What of the bench the world lacks. */
  note?: string;
}

const AGAIN = 1000; // ms between two looks for who is there

/** Who is in the world of *drive*, beside the scene. */
export function buildRoster(drive: Drive): HTMLElement {
  const list = el("ul", { class: "seats" });
  const count = el("summary", {}, "In this world");
  drive.news = ({ seats, most, problem }) => {
    count.textContent = `In this world: ${seats.length} of ${most}`;
    list.replaceChildren(
      ...seats.map((each) =>
        el(
          "li",
          { class: each.number === drive.seat ? "me" : "" },
          el("span", { class: "who" }, nameOf(each, drive)),
          el("span", { class: "speed" }, each.stopped ? "not answering" : speedOf(each)),
        ),
      ),
      ...(problem ? [el("li", { class: "problem" }, problem)] : []),
    );
  };
  const leave =
    drive.watched !== undefined && el("button", { type: "button", click: () => drive.leave() }, "Stop watching");
  return el("details", { class: "panel roster", open: window.innerWidth > 700 }, count, list, leave);
}

/** Who drives now, for somebody who has not chosen a car yet. */
export function buildSeats(watch: (seat: number) => Promise<void>): HTMLElement {
  const list = el("ul", { class: "seats" });
  const count = el("p", { class: "muted", role: "status" });
  const heading = el("h2", {}, "Shared world");
  const box = el("section", { class: "card world", "aria-label": "Shared world" }, heading, count, list);
  const row = (each: Seat): HTMLElement => {
    const click = (): void => {
      watch(each.number).catch((error: Error) => {
        count.textContent = `It cannot be watched: ${error.message}.`;
      });
    };
    return el(
      "li",
      {},
      el("span", { class: "who" }, nameOf(each)),
      el("span", { class: "speed" }, speedOf(each)),
      el("button", { type: "button", "data-seat": each.number, disabled: each.time === null, click }, "Watch"),
    );
  };
  const show = async (): Promise<void> => {
    try {
      const { seats, most, problem, note } = await ask<World>("/drive/world");
      const driven = seats.length ? `${seats.length} of ${most} seats are taken` : "Nobody drives yet";
      const remark = note && `Shared ${note}`;
      count.textContent = `${[driven, problem, remark].filter(Boolean).join(". ")}.`;
      const focused = (document.activeElement as HTMLElement | null)?.dataset.seat;
      list.replaceChildren(...seats.map(row));
      if (focused) list.querySelector<HTMLElement>(`[data-seat="${CSS.escape(focused)}"]`)?.focus();
    } catch (error) {
      count.textContent = `The world cannot be shown: ${(error as Error).message}.`;
    }
    setTimeout(() => {
      if (box.isConnected) void show();
    }, AGAIN);
  };
  void show();
  return box;
}

function nameOf({ number, driver }: Seat, drive?: Drive): string {
  const mine = number === drive?.seat ? (drive.watched === undefined ? " (you)" : " (watched)") : "";
  return `${number} ${driver}${mine}`;
}

function speedOf({ speed, time }: Seat): string {
  return speed === null || time === null ? "starting" : `${Math.round(3.6 * speed)} km/h`;
}
