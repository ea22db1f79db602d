import type { paths } from "../api/schema";
import { addressOf } from "../service";

type Table = paths["/api/v1/tables/{table}"]["get"]["parameters"]["path"]["table"];

/** The tables of results, with what a line of each is. */
export const RESULT_TABLES: readonly { readonly table: Table; readonly words: string }[] = [
  { table: "runs", words: "a line each run" },
  { table: "verdicts", words: "each oracle and ego" },
  { table: "metrics", words: "each ego and metric" },
  { table: "agents", words: "each ego and its ADS" },
];

/** Filters of runs, by the names of the API's parameters. */
export type Conditions = Readonly<Record<string, string | readonly string[]>>;

/** Returns the address of a table of the results of some runs, as CSV. */
export function tableAddress(table: Table, conditions: Conditions): string {
  const query = new URLSearchParams(
    Object.entries(conditions).flatMap(([name, values]) =>
      [values].flat().map((value): [string, string] => [name, value]),
    ),
  );
  return addressOf(`/api/v1/tables/${table}${query.size > 0 ? `?${query}` : ""}`);
}
