import { useQuery } from "@tanstack/react-query";
import type { Schemas } from "../../api/client";
import { addressOf } from "../../service";
import { type ArrowTable, readArrow } from "./arrowTable";

/** Values of an ego by step, as oracles and metrics compute them. */
export class Series {
  readonly first: number;
  readonly time: Float64Array;

  constructor(private readonly table: ArrowTable<Omit<Schemas["Series"], "values">>) {
    this.time = this.column("time");
    this.first = this.column("step")[0] ?? 0;
  }

  column(name: string): Float64Array {
    return this.table.columns.get(name) ?? new Float64Array(this.table.rows).fill(Number.NaN);
  }

  /** Returns a value at a step of the run, NaN outside the ego's part. */
  at(name: string, step: number): number {
    return this.column(name)[step - this.first] ?? Number.NaN;
  }

  /** Whether the ego is there at a step of the run. */
  holds(step: number): boolean {
    return step >= this.first && step < this.first + this.time.length;
  }

  actor(row: number): string {
    return this.table.head.actors[row] ?? "";
  }

  lane(index: number): string {
    return this.table.head.lanes[String(index)] ?? "";
  }

  description(name: string): string {
    return this.table.head.columns.find((column) => column.name === name)?.description ?? "";
  }
}

export function useSeries(run: string, ego: number) {
  return useQuery({
    queryKey: ["run", run, "series", ego],
    queryFn: async ({ signal }) =>
      new Series(
        await readArrow(
          addressOf(`/api/v1/runs/${run}/series?ego=${ego}`),
          "drivora_series",
          signal,
        ),
      ),
    enabled: run !== "",
    structuralSharing: false,
  });
}
