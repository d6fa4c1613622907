// What the reader takes along: a run's parameters, and the next study's design variables.
import type { Store } from "./store";
import type { Study, Variable } from "./study";

/** A run's configuration and its exact parameters. */
export function yamlOf(study: Study, run: number): string {
  const lines = [
    `# run ${study.number[run]} of ${study.title.replace(/\s+/g, " ")}`,
    `configuration: ${scalar(study.configurations[study.configuration[run]!]!.id)}`,
  ];
  if (study.variables.length) lines.push("parameters:");
  for (const { name, unit, values } of variablesOf(study, run))
    lines.push(`  ${scalar(name)}: ${quantity(values[run]!, unit)}`);
  return `${lines.join("\n")}\n`;
}

/** The variables that the run's configuration has. */
export function variablesOf(study: Study, run: number): Variable[] {
  return study.variables.filter(({ lack }) => !lack.includes(study.configuration[run]!));
}

/**
 * The `design_variables` of a study of what is brushed: the range of each variable is its own brush; else, if anything
 * else is brushed, that of the runs within; else what it was.
 */
export function nextStudy(store: Store): string {
  const { study, state } = store;
  const within = store.within();
  const lines = [`# where ${study.title.replace(/\s+/g, " ")} was brushed`, "design_variables:"];
  study.variables.forEach((variable, index) => {
    // What is no choice stays as it stands in the study.
    if (variable.role !== "design") return;
    const own = state.brushes.find(({ column }) => column === `variable.${index}`);
    const others = state.brushes.some(({ column }) => column !== `variable.${index}`);
    const [low, high] = own
      ? [own.low, own.high]
      : others && within
        ? reachOf(variable.values, within)
        : [variable.low, variable.high];
    const clip = (value: number): number => Math.min(variable.high, Math.max(variable.low, value));
    // A range of a run or none is no range.
    const [from, to] = low < high ? [rounded(clip(low)), rounded(clip(high))] : [variable.low, variable.high];
    const nominal = Math.min(to, Math.max(from, variable.nominal));
    lines.push(
      `  ${scalar(variable.name)}:`,
      `    range: [${quantity(from, variable.unit)}, ${quantity(to, variable.unit)}]`,
      `    nominal: ${quantity(nominal, variable.unit)}`,
      `    title: ${scalar(variable.title)}`,
    );
  });
  return `${lines.join("\n")}\n`;
}

interface Told {
  name: string;
  unit: string;
  low: number;
  high: number;
  value: number;
  isMoved: boolean;
  isAxis: boolean;
}

/** The study of a plane that was simulated in the page of another: two axes, and what was moved besides them. */
export function simulatedStudy(of: string, bench: string, configuration: string, told: Told[]): string {
  const moved = told.filter(({ isAxis, isMoved }) => isMoved && !isAxis);
  const lines = [
    `# simulated in the page of ${of}`,
    ...(moved.length ? [`# the parameters of ${bench} were then, besides those below:`] : []),
    ...moved.map(({ name, unit, value }) => `#   ${scalar(name)}: ${quantity(rounded(value), unit)}`),
    `study: ${scalar(`${of}_next`)}`,
    `testbench: ${scalar(bench)}`,
    `configurations: [${scalar(configuration)}]`,
    "design_variables:",
  ];
  for (const { name, unit, low, high, value } of told.filter(({ isAxis }) => isAxis)) {
    const nominal = quantity(rounded(Math.min(high, Math.max(low, value))), unit);
    lines.push(
      `  ${scalar(name)}: {range: [${quantity(rounded(low), unit)}, ${quantity(rounded(high), unit)}], levels: 25, nominal: ${nominal}}`,
    );
  }
  return `${lines.join("\n")}\nsampler: full_factorial\n`;
}

function reachOf(values: Float64Array, within: Uint8Array): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (let run = 0; run < within.length; run++) {
    if (!within[run]) continue;
    low = Math.min(low, values[run]!);
    high = Math.max(high, values[run]!);
  }
  return [low, high];
}

// A range comes from a hand that dragged; six digits are more than it aimed at.
function rounded(value: number): number {
  return Number(value.toPrecision(6));
}

function quantity(value: number, unit: string): string {
  return unit ? scalar(`${value} ${unit}`) : String(value);
}

// Anything beyond plain words and quantities is quoted: to YAML, the identifier 12e345 is a number, `no` may be false.
// A JSON string is a YAML string.
function scalar(text: string): string {
  const isWord =
    /^[A-Za-z_][A-Za-z0-9_.+\-/%\u00b0 ]*$/.test(text) && !/ $|^(true|false|null|yes|no|on|off)$/i.test(text);
  return isWord || /^-?[\d.]+(e[-+]?\d+)? [A-Za-z%/.0-9\u00b0]+$/.test(text) ? text : JSON.stringify(text);
}
