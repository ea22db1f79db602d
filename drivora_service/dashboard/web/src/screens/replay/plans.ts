/** A path that an agent planned: x and y in turn, metres. */
export interface Plan {
  readonly step: number;
  readonly points: Float32Array;
}

/** Plans older than this are not shown, seconds. */
const LONGEST_S = 1;

/** The plans of the agents by ego, and the numbers that they wrote into their logs. */
export class AgentTold {
  private readonly plans = new Map<number, Plan[]>();
  private readonly values = new Map<string, Map<number, Float64Array>>();

  constructor(
    readonly stepLength: number,
    private readonly steps: number,
  ) {}

  get hasPlans(): boolean {
    return this.plans.size > 0;
  }

  addPlan(ego: number, plan: Plan): void {
    const found = this.plans.get(ego);
    if (found) found.push(plan);
    else this.plans.set(ego, [plan]);
  }

  addValue(name: string, ego: number, step: number, value: number): void {
    if (Number.isNaN(value)) return;
    const byEgo = this.values.get(name) ?? new Map<number, Float64Array>();
    this.values.set(name, byEgo);
    const values = byEgo.get(ego) ?? new Float64Array(this.steps).fill(Number.NaN);
    byEgo.set(ego, values);
    values[step] = value;
  }

  /** Returns the plan that an ego had at a step: its newest, if it is not too old. */
  planAt(ego: number, step: number): Plan | undefined {
    const plans = this.plans.get(ego) ?? [];
    let low = 0;
    let high = plans.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if ((plans[middle]?.step ?? 0) <= step) low = middle + 1;
      else high = middle;
    }
    const plan = plans[low - 1];
    return plan && (step - plan.step) * this.stepLength <= LONGEST_S ? plan : undefined;
  }

  /** Returns the numbers in an ego's log at a step, by name. */
  valuesAt(ego: number, step: number): readonly (readonly [string, number])[] {
    const found: [string, number][] = [];
    for (const [name, byEgo] of this.values) {
      const value = byEgo.get(ego)?.[step];
      if (value !== undefined && !Number.isNaN(value)) found.push([name, value]);
    }
    return found;
  }
}
