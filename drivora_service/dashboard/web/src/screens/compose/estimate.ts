/** How fast a finished campaign was. */
export interface KnownRate {
  readonly agent: string;
  readonly town: string;
  /** Simulations a second of work. */
  readonly rate: number;
}

/** Simulations that are to be made with an ADS on a network. */
export interface Work {
  readonly agent: string;
  readonly town: string;
  readonly simulations: number;
}

export interface Estimate {
  readonly seconds: number;
  /** Number of campaigns by whose rates it was made. */
  readonly campaigns: number;
}

/** Returns how long work takes by the rates of earlier campaigns; `undefined` if some is not known.
 *
 * The rate of an ADS on a network is the median of the campaigns that searched it there, and if
 * there are none, of those that searched it elsewhere.
 */
export function estimated(
  work: readonly Work[],
  known: readonly KnownRate[],
): Estimate | undefined {
  let seconds = 0;
  const used = new Set<KnownRate>();
  for (const { agent, town, simulations } of work) {
    const ofAgent = known.filter((one) => one.agent === agent && one.rate > 0);
    const there = ofAgent.filter((one) => one.town === town);
    const rates = there.length > 0 ? there : ofAgent;
    if (rates.length === 0) return undefined;
    for (const one of rates) used.add(one);
    seconds += simulations / median(rates.map(({ rate }) => rate));
  }
  return work.length === 0 ? undefined : { seconds, campaigns: used.size };
}

function median(values: readonly number[]): number {
  const sorted = values.toSorted((a, b) => a - b);
  const middle = sorted.length >> 1;
  const [low = 0, high = 0] = [sorted[Math.ceil(sorted.length / 2) - 1], sorted[middle]];
  return (low + high) / 2;
}
