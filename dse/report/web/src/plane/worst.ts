// Fields at several conditions as those of their worst.
import { type Fields, remember, type Way } from "./fields";

/** Fields of designs at the worst of the conditions that *each* is of; all on one grid. */
export function worstOf(each: Fields[]): Fields {
  const [first] = each;
  if (each.length === 1) return first!;
  const size = first!.xs.length * first!.ys.length;
  const over = (fields: Float64Array[], pick: (...values: number[]) => number): Float64Array =>
    Float64Array.from({ length: size }, (_, node) => pick(...fields.map((field) => field[node]!)));
  const exercised = remember((requirement: number) => {
    const fields = each.map((one) => one.exercised(requirement));
    return fields.every((field) => field !== null) ? over(fields, Math.max) : null;
  });
  const metric = remember((key: string) => {
    const [index, way, requirement] = key.split(" ") as [string, Way, string];
    const fields = each.map((one) => one.metric(Number(index)));
    if (way === "mean")
      return over(fields, (...values) => values.reduce((sum, value) => sum + value, 0) / values.length);
    // A condition at which the requirement is not exercised says nothing, unless none says more.
    const counts = Number(requirement) < 0 ? [] : each.map((one) => one.exercised(Number(requirement)));
    return Float64Array.from({ length: size }, (_, node) => {
      const said = fields.filter((_, at) => (counts[at]?.[node] ?? 1) >= 0.5);
      return Math[way](...(said.length ? said : fields).map((field) => field[node]!));
    });
  });
  return {
    xs: first!.xs,
    ys: first!.ys,
    how: `${first!.how} Each design is at the worst of ${each.length} conditions.`,
    metric: (index, way = "mean", requirement = -1) => metric(`${index} ${way} ${requirement}`),
    exercised,
    known: (requirements) => {
      const fields = each.flatMap((one) => one.known(requirements) ?? []);
      return fields.length ? over(fields, Math.min) : null;
    },
  };
}
