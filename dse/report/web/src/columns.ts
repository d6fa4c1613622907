// Everything a run has a number for, by keys that stand in addresses, brushes and choices of axes.
import type { Column, Study } from "./study";

export interface Keyed extends Column {
  /** `variable.N`, `metric.N`, `property.N`, `composite.N`. */
  key: string;
  /** What its values 0, 1, … are called, if they are no quantities. */
  names?: string[];
}

const known = new WeakMap<Study, Keyed[]>();

export function columnsOf(study: Study): Keyed[] {
  let columns = known.get(study);
  if (!columns) {
    columns = [
      ...study.variables.map((column, index) => ({ ...column, key: `variable.${index}` })),
      ...study.metrics.map((column, index) => ({ ...column, key: `metric.${index}` })),
      ...study.composites.map((column, index) => ({ ...column, key: `composite.${index}` })),
      ...study.properties.map((column, index) => ({
        ...column,
        values: perRun(study, column.values),
        key: `property.${index}`,
      })),
    ];
    known.set(study, columns);
  }
  return columns;
}

export function columnOf(study: Study, key: string): Keyed | undefined {
  return columnsOf(study).find((column) => column.key === key);
}

// A property is that of the run's configuration.
function perRun(study: Study, values: Float64Array): Float64Array {
  return Float64Array.from(study.configuration, (configuration) => values[configuration]!);
}
