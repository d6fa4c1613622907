// What is taken out of the view: pictures, the table of designs, and the commands that make the same.

import { el } from "../../dom";
import { quoted, savingMenu } from "../../panels/export";
import type { Part } from "../../plot/sheet";
import { cell, download } from "../../save";
import { axisLabel } from "../../study";
import { WORDS, wordFor } from "../../verdicts";
import { choiceAt, configurationOf, hasVariable, type Model, nameOf } from "./model";
import { designColumns, place } from "./values";

export function scatterMenu(model: Model, picture: () => Part[]): HTMLElement {
  return savingMenu(model.store, {
    name: "designs",
    picture,
    purpose: "The designs ranked in the terminal, at the bounds of the study, with DIR the study\u2019s folder:",
    command: () => rankingCommand(model),
  });
}

export function boardButton(model: Model): HTMLElement {
  const save = (): void => download("designs.csv", new Blob([designsCsv(model)], { type: "text/csv" }));
  return el(
    "button",
    { type: "button", id: "save-board", title: "Every design within the brushes, with all digits", click: save },
    "Designs (CSV)",
  );
}

function rankingCommand({ store, choices }: Model): string {
  const { study } = store;
  const names = choices.criteria.map(({ column, maximize }) => {
    const index = place(column);
    const name = column.startsWith("property.")
      ? `sum(${study.properties[index]!.name})`
      : column.startsWith("composite.")
        ? study.composites[index]!.name
        : column.startsWith("metric.")
          ? study.metrics[index]!.name
          : "";
    return name ? ` ${maximize ? "--maximize" : "--minimize"} ${quoted(name)}` : "";
  });
  const aims = names.filter(Boolean);
  return `dse ${aims.length > 1 ? "pareto" : "best"} DIR${aims.join("")}`;
}

function designsCsv(model: Model): string {
  const { store, grouping } = model;
  const { study } = store;
  const { mark, slack, each, margins, deciding } = model.standing();
  const scores = model.scores();
  const front = model.front();
  const within = model.within();
  const places = [...new Set(study.configurations.flatMap(({ choices }) => choices.map(([name]) => name)))];
  const columns = designColumns(study).map(({ key }) => model.column(key));
  const titles = study.requirements.flatMap(({ title, metric }) => [
    title,
    `margin of ${title} [${study.metrics[metric]!.unit || "\u2013"}]`,
  ]);
  const head = [
    "design",
    "configuration",
    "runs",
    "deciding run",
    ...places,
    ...columns.map(axisLabel),
    ...titles,
    "least margin [%]",
    "score",
    "front",
    "verdict",
  ];
  const rows = [head.map(cell).join()];
  const exact = (value: number): string => (Number.isNaN(value) ? "" : String(value));
  for (let design = 0; design < grouping.size; design++) {
    if (within && !within[design]) continue;
    const configuration = configurationOf(model, design);
    rows.push(
      [
        cell(nameOf(model, design)),
        cell(study.configurations[configuration]!.id),
        grouping.start[design + 1]! - grouping.start[design]!,
        study.number[deciding[design]!],
        ...places.map((name) => cell(choiceAt(store, configuration, name))),
        ...columns.map(({ key, values }) => (hasVariable(model, key, design) ? exact(values[design]!) : "")),
        ...each.flatMap((marks, index) => [WORDS[marks[design]!], exact(margins[index]![design]!)]),
        exact(100 * slack[design]!),
        exact(scores[design]!),
        front[design],
        wordFor(mark[design]!, "design"),
      ].join(),
    );
  }
  return `${rows.join("\r\n")}\r\n`;
}
